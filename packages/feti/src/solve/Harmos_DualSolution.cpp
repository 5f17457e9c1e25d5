// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualSolution.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_ProjectedOperator.hpp"

#include "Harmos_DeflatedOperators.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_KeptAnswer.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_SolveWatch.hpp"
#include "Harmos_StoppingTest.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace Harmos::feti {
namespace {

using Details::slowness;
using Details::SolveWatch;
using Details::standstill;

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

// Of a vector of the equality rows, on this rank; empty for null.
std::vector<double> valuesOf(const Teuchos::RCP<const MultiVector>& vector) {
  std::vector<double> values;
  if (vector.is_null())
    return values;
  const auto view = vector->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t k = 0; k < view.extent(0); ++k)
    values.push_back(view(k, 0));
  return values;
}

// One solution of the dual problem: where it starts, what the quadratic programming layer gets, what became
// of it.
class DualSolve {
 public:
  // All to outlive this.
  DualSolve(const DualStages& stages, const SolverOptions& options, const Acceptance& acceptance,
            const Log& log, SolveReport& report, const Teuchos::RCP<DualMonitor>& monitor)
      : stages_(stages),
        dual_(*stages.problem),
        asked_(options),
        options_(options),
        acceptance_(acceptance),
        log_(log),
        report_(report),
        monitor_(monitor),
        tolerance_(options.tolerance),
        watch_(monitor, options.tolerance, tolerance_, stages.system->comm()->getSize()) {}

  DualSolution go(const WarmStart* start) {
    guess(start);
    if (isHeld(SolveWatch::leftName)) {
      watch_.leaveVectors();
      recallBefore();
    } else if (hasVectorsFromStart()) {
      deflate();
      if (isHeld(SolveWatch::vectorsName))
        recallBefore();
    }
    makeProblem(start);
    run();
    if (watch_.isStopped() && deflation_ == nullptr)
      goOnWithVectors();
    if (deflation_ != nullptr && isAtTheirEnd())
      goOnWithoutVectors(start);
    report_.result.goesOnAfter(watch_.before());
    conclude();
    return std::move(solution_);
  }

 private:
  void guess(const WarmStart* start);
  void startFrom(const WarmStart& start);
  void startFromHalfLoad();
  void removeJoined();
  bool hasVectorsFromStart() const;
  // By the state that the solver goes on from.
  bool isHeld(const char* name) const { return watch_.hasState() && watch_.holds(name); }
  void deflate();
  void recallBefore();
  void goOnWithVectors();
  bool isAtTheirEnd() const;
  bool hasGoneAstray() const;
  void goOnWithoutVectors(const WarmStart* start);
  void goOn(const std::vector<double>& mu);
  void leaveOutBefore();
  void run();
  void makeProblem(const WarmStart* start);
  void addEquality(const WarmStart* start);
  void makeSolver();
  Teuchos::RCP<Teuchos::ParameterList> parametersOf(const std::string& method) const;
  bool isAccepted();
  void takeKept();
  void begin();
  void announce() const;
  void conclude();
  void measureEquality();
  void measureRounding();
  bool isPenalty() const { return method_ == "Dual Penalty"; }
  void setTolerance();
  bool startsNearest() const;

  const DualStages& stages_;
  const DualProblem& dual_;
  const SolverOptions& asked_;
  SolverOptions options_; // limits: of what is left
  const Acceptance& acceptance_;
  const Log& log_;
  SolveReport& report_;
  Teuchos::RCP<DualMonitor> monitor_; // or null
  double tolerance_;                  // an acceptance may lower it
  SolveWatch watch_;
  // Where there are adaptive vectors: what is left of the dual problem without their span.
  const Deflation* deflation_ = nullptr;
  Teuchos::RCP<const Operator> deflated_, hessian_, hessianOnKernel_, deflatedPreconditioner_;
  Teuchos::RCP<MultiVector> rhs_;

  DualSolution solution_;
  Teuchos::RCP<MultiVector> multiplier_; // μ, null without a coarse problem
  Teuchos::RCP<qp::TpetraProblem> problem_;
  std::string method_;
  Teuchos::RCP<qp::TpetraSolverManager> solver_;
  Details::StoppingTest test_;
  Details::KeptAnswer kept_;
  int inner_ = 0; // iterations that were last judged
};

// Whether it takes too long to improve an answer that is kept.
class KeptIsEnough : public qp::StatusTestValue<MultiVector> {
 public:
  KeptIsEnough(const Details::KeptAnswer& kept, int& inner)
      : qp::StatusTestValue<MultiVector>("iterations left to improve a solution"),
        kept_(kept),
        inner_(inner) {}
  qp::Status checkStatus(const qp::IterationState<MultiVector>& state) override {
    inner_ = state.inner;
    return judge(kept_.isSpent(state.inner) ? 0.0 : 1.0, 0.0);
  }
  qp::Reason reason() const override { return qp::Reason::IterationLimit; }

 private:
  const Details::KeptAnswer& kept_;
  int& inner_;
};

void DualSolve::guess(const WarmStart* start) {
  solution_.lambda = Teuchos::rcp(new MultiVector(stages_.constraints->rowMap(), 1));
  if (start != nullptr)
    startFrom(*start);
  else if (options_.initialGuess == InitialGuess::HalfLoad)
    startFromHalfLoad();
}

void DualSolve::startFrom(const WarmStart& start) {
  Tpetra::deep_copy(*solution_.lambda, *start.multiplier);
  solution_.lambda->update(-1.0, *dual_.shift(), 1.0);
  stages_.coarse->project(*solution_.lambda);
  removeJoined();
  if (dual_.lowerBound().is_null())
    return;
  // Open contacts stay at their bounds to the last bit, or active sets would begin without them.
  const auto total = start.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lower = dual_.lowerBound()->getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution_.lambda->getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t k = 0; k < total.extent(0); ++k)
    if (total(k, 0) == 0.0 && std::isfinite(lower(k, 0)) &&
        stages_.constraints->rowType(static_cast<int>(k)) == RowType::Inequality)
      lambda(k, 0) = lower(k, 0);
}

// λ⁰ = ½Bf.
void DualSolve::startFromHalfLoad() {
  const Constraints& constraints = *stages_.constraints;
  std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
  for (int i = 0; i < stages_.system->size(); ++i)
    constraints.addB(i, stages_.system->rhs(i).data(), overlap.data());
  constraints.fromOverlap(overlap, *solution_.lambda);
  solution_.lambda->scale(0.5);
  removeJoined();
}

// What F of clusters does not see.
void DualSolve::removeJoined() {
  if (const ClusterInverse* joined = stages_.inverses->joined())
    joined->clusters().removeJoined(*solution_.lambda);
}

// Those of steps before are there, and a solver that had them when it was interrupted needs them.
bool DualSolve::hasVectorsFromStart() const {
  const Teuchos::RCP<AdaptiveSpace>& space = stages_.adaptive;
  if (space.is_null() || !space->isPossible() || options_.method == "Dual Penalty")
    return false;
  return space->isMade() || space->options().vectors == AdaptiveVectors::All ||
         isHeld(SolveWatch::vectorsName);
}

void DualSolve::deflate() {
  AdaptiveSpace& space = *stages_.adaptive;
  if (!space.isMade())
    space.make(log_);
  watch_.haveVectors();
  report_.adaptiveSeconds = space.seconds();
  deflation_ = space.deflation();
  if (deflation_ == nullptr)
    return;
  report_.adaptiveVectors = deflation_->dimension();
  deflated_ = Teuchos::rcp(new DeflatedOperator(space.dualOperator(), *deflation_));
  deflatedPreconditioner_ = Teuchos::rcp(new DeflatedPreconditioner(*stages_.preconditioner, *deflation_));
  deflation_->removeSpan(*solution_.lambda);
  hessian_ = deflated_;
  rhs_ = Teuchos::rcp(new MultiVector(dual_.d(), Teuchos::Copy));
  deflation_->removeFromLoad(*rhs_);
  if (stages_.coarse->dimension() == 0)
    return;
  hessian_ = Teuchos::rcp(new ProjectedOperator(*deflated_, *stages_.coarse));
  hessianOnKernel_ = Teuchos::rcp(new ProjectedOperator(*deflated_, *stages_.coarse, true));
  stages_.coarse->project(*rhs_);
}

// From where the solver has come to.
void DualSolve::goOnWithVectors() {
  log_.info("Slow convergence: adaptive coarse vectors after " +
            std::to_string(report_.result.counters.hessianApplications) + " applications of F");
  deflate();
  goOn(valuesOf(multiplier_));
}

// What vectors leave of F is known to more than its own rounding errors: the solver may come no further, or
// take for singular what is not.
bool DualSolve::isAtTheirEnd() const {
  return watch_.isStopped() || report_.result.reason == qp::Reason::Stagnation || hasGoneAstray();
}

bool DualSolve::hasGoneAstray() const {
  return report_.result.reason == qp::Reason::Unbounded || report_.result.reason == qp::Reason::Breakdown;
}

// What they were good for is done.
void DualSolve::goOnWithoutVectors(const WarmStart* start) {
  log_.info("Stagnation with adaptive coarse vectors: continue without them");
  const bool isAstray = hasGoneAstray();
  if (isAstray)
    guess(start);
  else
    deflation_->complete(dual_.d(), *solution_.lambda);
  deflation_ = nullptr;
  watch_.leaveVectors();
  report_.result.goesOnAfter(watch_.before());
  goOn(isAstray ? std::vector<double>() : valuesOf(multiplier_));
}

void DualSolve::goOn(const std::vector<double>& mu) {
  watch_.goesOnAfter(report_.result);
  leaveOutBefore();
  const WarmStart reached = {Teuchos::null, mu};
  makeProblem(&reached);
  run();
}

// An interrupted run that had got vectors on its way, or left them.
void DualSolve::recallBefore() {
  watch_.restore([this](qp::StateArchive<MultiVector>& archive) { watch_.exchangeBefore(archive); });
  if (watch_.isForeign())
    log_.info("Restart on another number of ranks: new adaptive coarse vectors, and the solver starts again");
  watch_.goesOnAfter(watch_.isForeign() ? qp::Result() : qp::Result(watch_.before()));
  leaveOutBefore();
}

// Limits are of all that is done.
void DualSolve::leaveOutBefore() {
  const qp::IterationRecord last = watch_.before().lastRecord();
  options_.maximumIterations = std::max(1, asked_.maximumIterations - last.inner);
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (asked_.maximumSeconds > 0.0)
    options_.maximumSeconds =
        std::max(leastSeconds, asked_.maximumSeconds - last.seconds - report_.adaptiveSeconds);
}

void DualSolve::run() {
  makeSolver();
  if (acceptance_.judge && !isPenalty())
    solver_->setAcceptance([this] { return isAccepted(); });
  begin();
  announce();
  report_.result = solver_->solve();
}

void DualSolve::makeProblem(const WarmStart* start) {
  problem_ =
      Teuchos::rcp(new qp::TpetraProblem(deflation_ ? hessian_ : dual_.hessian(), solution_.lambda,
                                         deflation_ ? Teuchos::RCP<const MultiVector>(rhs_) : dual_.rhs()));
  problem_->setLowerBound(dual_.lowerBound());
  problem_->setUpperBound(dual_.upperBound());
  problem_->setDiscs(dual_.discs());
  problem_->setFollowingLimits(dual_.followingLimits());
  problem_->setSoftBounds(dual_.softBounds());
  if (!dual_.equalityRows().is_null())
    addEquality(start);
  if (!stages_.preconditioner.is_null())
    problem_->setPreconditioner(deflation_ ? deflatedPreconditioner_ : stages_.preconditioner);
  if (!problem_->setProblem())
    throw NumericalError("the dual problem cannot be solved: " + problem_->whyNotSet());
}

// Gλ = 0.
void DualSolve::addEquality(const WarmStart* start) {
  const Teuchos::RCP<const Map> map = dual_.equalityRows()->getRangeMap();
  multiplier_ = Teuchos::rcp(new MultiVector(map, 1));
  if (start != nullptr && start->mu.size() == multiplier_->getLocalLength()) {
    const auto view = multiplier_->getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::copy(start->mu.begin(), start->mu.end(), view.data());
  }
  const auto zero = Teuchos::rcp(new MultiVector(map, 1));
  problem_->setEquality(dual_.equalityRows(), zero, multiplier_, qp::EqualityStructure::OrthonormalInvariant);
  problem_->setHessianOnKernel(deflation_ ? hessianOnKernel_ : dual_.hessianOnKernel());
  problem_->setUnprojectedHessian(deflation_ ? deflated_ : dual_.unprojectedHessian());
  problem_->setFaceGram(stages_.coarse->faceGram());
}

void DualSolve::makeSolver() {
  using Auto = qp::AutoSolver<Scalar, MultiVector, Operator>;
  method_ = options_.method == "Auto" ? Auto::choice(*problem_) : options_.method;
  solver_ = qp::TpetraSolverFactory().create(method_, parametersOf(method_));
  report_.solver = solver_->name();
  test_ = Details::stoppingTest(stages_, options_, tolerance_, !isPenalty(), report_);
  using Combo = qp::StatusTestCombo<MultiVector>;
  const Teuchos::RCP<qp::StatusTest<MultiVector>> spent = Teuchos::rcp(new KeptIsEnough(kept_, inner_));
  solver_->setConvergenceTest(Teuchos::rcp(new Combo(Combo::Type::Or, {test_.test, spent})));
  solver_->setLog(log_);
  solver_->setProblem(problem_);
}

// A solver takes the lists it has a use for; all of them were validated with the deck.
Teuchos::RCP<Teuchos::ParameterList> DualSolve::parametersOf(const std::string& method) const {
  const auto list = Teuchos::parameterList();
  list->set("Maximum Iterations", options_.maximumIterations);
  list->set("Maximum Seconds", options_.maximumSeconds);
  list->set("Output Frequency", options_.progressFrequency);
  Teuchos::ParameterList& expert = list->sublist("Expert");
  if (method != "PCPG")
    expert.sublist("MPRGP") = options_.methodLists.sublist("MPRGP");
  if (method == "SMALBE" || method == "PDAS")
    expert.sublist("SMALBE") = options_.methodLists.sublist("SMALBE");
  if (method == "PCPG" || method == "PDAS")
    expert.sublist("PCPG") = options_.methodLists.sublist("PCPG");
  if (method == "Dual Penalty" || method == "PDAS")
    expert.sublist(method) = options_.methodLists.sublist(method);
  if (method == "PDAS" && startsNearest())
    expert.sublist("PDAS").set("First active set", "nearest");
  return list;
}

// Friction hides that contacts are at their bounds, by which that is decided else.
bool DualSolve::startsNearest() const {
  const std::string first = options_.methodLists.sublist("PDAS").get<std::string>("First active set");
  return stages_.constraints->limited() > 0 && (first == "auto" || first == "tried") &&
         norm(*dual_.shift()) == 0.0;
}

void DualSolve::setTolerance() {
  test_.gradient->setTolerance(tolerance_);
  if (!test_.equality.is_null())
    test_.equality->setTolerance(tolerance_);
}

bool DualSolve::isAccepted() {
  // The tolerance that these residuals would just meet.
  double met = tolerance_ * test_.gradient->value() / test_.gradient->limit();
  if (!test_.equality.is_null())
    met = std::max(met, tolerance_ * test_.equality->value() / test_.equality->limit());
  if (deflation_)
    deflation_->complete(dual_.d(), *solution_.lambda);
  const Verdict verdict =
      acceptance_.judge(*solution_.lambda, valuesOf(multiplier_), std::isfinite(met) ? met : tolerance_);
  kept_.forget();
  if (!verdict.next)
    return true;
  if (verdict.isEnough)
    kept_.keep(*solution_.lambda, multiplier_, test_.gradient->value(),
               test_.equality.is_null() ? 0.0 : test_.equality->value(), inner_);
  tolerance_ = *verdict.next;
  setTolerance();
  return false;
}

void DualSolve::takeKept() {
  const std::string reason = qp::toString(report_.result.reason);
  const bool isSpent = kept_.isSpent(inner_);
  if (kept_.replace(report_.result, *solution_.lambda, multiplier_))
    log_.info("No further progress (" + (isSpent ? "iteration budget used up" : reason) +
              "): the last solution that met the tolerance is used");
}

void DualSolve::begin() {
  const Teuchos::RCP<AdaptiveSpace>& space = stages_.adaptive;
  // SMALBE gets on slowly for reasons of its own, which vectors do not cure.
  const bool mayAdapt = !space.is_null() && space->isPossible() && !space->isMade() &&
                        !watch_.hasLeftVectors() && !isPenalty() && method_ != "SMALBE";
  const bool mayLeave = deflation_ != nullptr && method_ != "SMALBE";
  const auto target = [this] { return tolerance_ * report_.gradientScale; };
  if (mayAdapt)
    watch_.stopWhen(slowness(options_.tolerance), target);
  else if (mayLeave)
    watch_.stopWhen(standstill(), target);
  if (!monitor_.is_null())
    monitor_->begins({stages_, method_, [this] {
                        // What the tests last measured against.
                        DualTargets targets{tolerance_ * report_.gradientScale, 0.0};
                        if (!test_.equality.is_null())
                          targets.equality = tolerance_ * test_.equality->scale();
                        return targets;
                      }});
  if (mayAdapt || mayLeave || !monitor_.is_null())
    solver_->setMonitor(Teuchos::rcpFromRef<qp::SolverMonitor<MultiVector>>(watch_));
  watch_.alsoKeep([this](qp::StateArchive<MultiVector>& archive) {
    kept_.exchange(archive, *solution_.lambda, multiplier_);
    if (acceptance_.exchange)
      acceptance_.exchange(archive);
  });
  if (!watch_.hasState())
    return;
  watch_.restore([this](qp::StateArchive<MultiVector>& archive) { watch_.exchange(archive); });
  if (tolerance_ == asked_.tolerance) // another one was asked for then
    kept_.forget();
  setTolerance();
}

void DualSolve::announce() const {
  std::ostringstream text;
  text << "Solver: " << report_.solver << ", tolerance " << scientific(tolerance_, 0) << " ("
       << toString(options_.stoppingRule) << " rule)";
  log_.info(text.str());
  if (options_.progressFrequency > 0)
    log_.info("  outer  inner  step              |g^P|   |G lambda|   active     F*x  seconds");
}

void DualSolve::conclude() {
  if (deflation_)
    deflation_->complete(dual_.d(), *solution_.lambda);
  takeKept();
  report_.result.counters.setupApplications += dual_.setupApplications();
  report_.solved = true;
  measureRounding();
  if (!test_.equality.is_null())
    measureEquality();
  // y with yᵀGλ > 0 for all admissible λ: forces of one sign act on the motion R L⁻ᵀy.
  if (report_.result.reason == qp::Reason::Infeasible && !solver_->certificate().is_null()) {
    MultiVector forces(stages_.constraints->rowMap(), 1);
    dual_.equalityRows()->apply(*solver_->certificate(), forces, Teuchos::TRANS);
    solution_.escape = stages_.coarse->solve(stages_.coarse->multiply(forces)); // A⁻G̃Gᵀy = L⁻ᵀy
    solution_.isEscaping = true;
  }
  report_.converged = report_.result.converged();
  report_.reason = qp::toString(report_.result.reason);
  if (!report_.converged)
    report_.reason += ": " + report_.result.explanation;
  solution_.mu = valuesOf(multiplier_);
}

// Springs that open far beside what bodies are strained by.
void DualSolve::measureRounding() {
  const double rounding = test_.gradient->rounding();
  if (!report_.result.converged() || !(rounding > tolerance_ * report_.gradientScale))
    return;
  report_.openingRounding = rounding / report_.gradientScale;
  report_.gradientScale = rounding / tolerance_;
}

// The scale that belongs to the last iterate, which the solver may not have asked for.
void DualSolve::measureEquality() {
  qp::IterationState<MultiVector> last;
  last.x = solution_.lambda.get();
  last.equalityResidual = report_.result.equalityNorm;
  const bool met = test_.equality->checkStatus(last) == qp::Status::Passed;
  report_.equalityScale = test_.equality->scale();
  if (!met && report_.result.converged())
    log_.info("Note: the penalty method leaves |G lambda| = " + scientific(report_.result.equalityNorm) +
              ", above the tolerance of the stopping rule, " + scientific(test_.equality->limit()));
}

} // namespace

DualSolution solveDualProblem(const DualStages& stages, const SolverOptions& options, const WarmStart* start,
                              const Acceptance& acceptance, const Log& log, SolveReport& report,
                              const Teuchos::RCP<DualMonitor>& monitor) {
  return DualSolve(stages, options, acceptance, log, report, monitor).go(start);
}

std::vector<long long> escapingParts(const RigidMotions& motions, const std::vector<double>& escape,
                                     const std::vector<long long>& partOf, long long parts) {
  const SubdomainSystem& system = motions.system();
  const std::vector<double> amplitudes = motions.amplitudes(escape);
  std::vector<double> squares(static_cast<std::size_t>(parts), 0.0);
  std::size_t place = 0;
  for (int i = 0; i < system.size(); ++i)
    for (int k = 0; k < motions.kernel(i).columns; ++k, ++place)
      squares[static_cast<std::size_t>(partOf[static_cast<std::size_t>(i)])] +=
          std::pow(amplitudes[place], 2);
  globalSum(*system.comm(), squares);
  const double largest = *std::max_element(squares.begin(), squares.end());
  std::vector<long long> result;
  for (std::size_t part = 0; part < squares.size(); ++part)
    if (squares[part] > 1e-4 * largest)
      result.push_back(static_cast<long long>(part));
  return result;
}

} // namespace Harmos::feti
