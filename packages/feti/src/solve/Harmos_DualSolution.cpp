// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualSolution.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"

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

// What is to be solved, and for whom.
struct Task {
  const DualStages& stages;
  const SolverOptions& options;
  const Acceptance& acceptance;
  const Log& log;
  SolveReport& report;
  Teuchos::RCP<DualMonitor> monitor; // or null
};

// One solution of the dual problem: where it starts, what the quadratic programming layer gets, what became
// of it.
class DualSolve {
 public:
  // What the task refers to has to outlive this.
  explicit DualSolve(const Task& task)
      : task_(task),
        options_(task.options),
        tolerance_(task.options.tolerance),
        watch_(task.monitor, task.options.tolerance, tolerance_, task.stages.system->comm()->getSize()) {}

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
    if (watch_.isStopped() && !deflated_)
      goOnWithVectors();
    if (deflated_ && isAtTheirEnd())
      goOnWithoutVectors(start);
    task_.report.result.goesOnAfter(watch_.before());
    conclude();
    return std::move(solution_);
  }

 private:
  void guess(const WarmStart* start);
  void startFrom(const WarmStart& start);
  void putAtLimits(const MultiVector& total);
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
  void keep();
  void takeKept();
  void begin();
  void announce() const;
  void conclude();
  void measureEquality();
  void measureRounding();
  bool isPenalty() const { return method_ == "Dual Penalty"; }
  void setTolerance();
  bool startsNearest() const;

  const DualProblem& dual() const { return *task_.stages.problem; }

  Task task_;
  SolverOptions options_; // limits: of what is left
  double tolerance_;      // an acceptance may lower it
  SolveWatch watch_;
  std::optional<DeflatedProblem> deflated_; // where there are adaptive vectors

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
  KeptIsEnough(Details::KeptAnswer& kept, int& inner)
      : qp::StatusTestValue<MultiVector>("iterations left to improve a solution"),
        kept_(kept),
        inner_(inner) {}
  qp::Status checkStatus(const qp::IterationState<MultiVector>& state) override {
    inner_ = state.inner;
    kept_.observe(state.inner, state.projectedGradient);
    return judge(kept_.isSpent(state.inner) ? 0.0 : 1.0, 0.0);
  }
  qp::Reason reason() const override { return qp::Reason::IterationLimit; }

 private:
  Details::KeptAnswer& kept_;
  int& inner_;
};

void DualSolve::guess(const WarmStart* start) {
  solution_.lambda = Teuchos::rcp(new MultiVector(task_.stages.constraints->rowMap(), 1));
  if (start != nullptr)
    startFrom(*start);
  else if (options_.initialGuess == InitialGuess::HalfLoad)
    startFromHalfLoad();
}

void DualSolve::startFrom(const WarmStart& start) {
  Tpetra::deep_copy(*solution_.lambda, *start.multiplier);
  solution_.lambda->update(-1.0, *dual().shift(), 1.0);
  task_.stages.coarse->project(*solution_.lambda);
  removeJoined();
  if (dual().lowerBound().is_null())
    return;
  // Open contacts stay at their bounds to the last bit, or active sets would begin without them.
  const auto total = start.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lower = dual().lowerBound()->getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution_.lambda->getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t k = 0; k < total.extent(0); ++k)
    if (total(k, 0) == 0.0 && std::isfinite(lower(k, 0)) &&
        task_.stages.constraints->rowType(static_cast<int>(k)) == RowType::Inequality)
      lambda(k, 0) = lower(k, 0);
  if (start.keepsLimits)
    putAtLimits(*start.multiplier);
}

// What is at a limit that follows, |λ_t| = μλ_n, goes there again, with the normal force that is left.
void DualSolve::putAtLimits(const MultiVector& total) {
  constexpr double share = 1e-9; // of limits, to which solutions are at them
  if (dual().followingLimits() == nullptr)
    return;
  const auto before = total.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto shift = dual().shift()->getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution_.lambda->getLocalViewHost(Tpetra::Access::ReadWrite);
  for (const qp::FollowingLimit& limit : *dual().followingLimits()) {
    std::array<int, 2> places = {limit.place, limit.place};
    if (limit.isDisc) {
      const qp::Disc& disc = dual().discs()->discs()[static_cast<std::size_t>(limit.place)];
      places = {disc.first, disc.second};
    }
    const auto lengthOf = [&](const auto& at) {
      return places[0] == places[1] ? std::abs(at(places[0])) : std::hypot(at(places[0]), at(places[1]));
    };
    const double was = lengthOf([&](int k) { return before(static_cast<std::size_t>(k), 0); }),
                 limitBefore = limit.factor * before(static_cast<std::size_t>(limit.source), 0);
    const auto totalNow = [&](int k) {
      return lambda(static_cast<std::size_t>(k), 0) + shift(static_cast<std::size_t>(k), 0);
    };
    const double is = lengthOf(totalNow), radius = limit.factor * std::max(0.0, totalNow(limit.source));
    if (!(was > 0.0 && was >= (1.0 - share) * limitBefore && is > 0.0))
      continue;
    constexpr double beyond = 1.0 + 1e-13; // what is outside is put on the rim
    for (std::size_t c = 0; c < (places[0] == places[1] ? 1U : 2U); ++c)
      lambda(static_cast<std::size_t>(places[c]), 0) += (beyond * radius / is - 1.0) * totalNow(places[c]);
  }
}

// λ⁰ = ½Bf.
void DualSolve::startFromHalfLoad() {
  const Constraints& constraints = *task_.stages.constraints;
  std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
  for (int i = 0; i < task_.stages.system->size(); ++i)
    constraints.addB(i, task_.stages.system->rhs(i).data(), overlap.data());
  constraints.fromOverlap(overlap, *solution_.lambda);
  solution_.lambda->scale(0.5);
  removeJoined();
}

// What F of clusters does not see.
void DualSolve::removeJoined() {
  if (const ClusterInverse* joined = task_.stages.inverses->joined())
    joined->clusters().removeJoined(*solution_.lambda);
}

// Those of steps before are there, and a solver that had them when it was interrupted needs them.
bool DualSolve::hasVectorsFromStart() const {
  const Teuchos::RCP<AdaptiveSpace>& space = task_.stages.adaptive;
  if (space.is_null() || !space->isPossible() || options_.method == "Dual Penalty")
    return false;
  return space->isMade() || space->options().vectors == AdaptiveVectors::All ||
         isHeld(SolveWatch::vectorsName);
}

void DualSolve::deflate() {
  AdaptiveSpace& space = *task_.stages.adaptive;
  if (!space.isMade())
    space.make(task_.log);
  watch_.haveVectors();
  task_.report.adaptiveSeconds = space.seconds();
  const Deflation* const deflation = space.deflation();
  if (deflation == nullptr)
    return;
  task_.report.adaptiveVectors = deflation->dimension();
  deflation->removeSpan(*solution_.lambda);
  deflated_.emplace(dual(), space.dualOperator(), *task_.stages.preconditioner, *task_.stages.coarse,
                    *deflation);
}

// From where the solver has come to.
void DualSolve::goOnWithVectors() {
  task_.log.info("Slow convergence: adaptive coarse vectors after " +
                 std::to_string(task_.report.result.counters.hessianApplications) + " applications of F");
  deflate();
  goOn(valuesOf(multiplier_));
}

// What vectors leave of F is known to more than its own rounding errors: the solver may come no further, or
// take for singular what is not.
bool DualSolve::isAtTheirEnd() const {
  return watch_.isStopped() || task_.report.result.reason == qp::Reason::Stagnation || hasGoneAstray();
}

bool DualSolve::hasGoneAstray() const {
  return task_.report.result.reason == qp::Reason::Unbounded ||
         task_.report.result.reason == qp::Reason::Breakdown;
}

// What they were good for is done.
void DualSolve::goOnWithoutVectors(const WarmStart* start) {
  task_.log.info("Stagnation with adaptive coarse vectors: continue without them");
  const bool isAstray = hasGoneAstray();
  if (isAstray)
    guess(start);
  else
    deflated_->span->complete(dual().d(), *solution_.lambda);
  deflated_.reset();
  watch_.leaveVectors();
  task_.report.result.goesOnAfter(watch_.before());
  goOn(isAstray ? std::vector<double>() : valuesOf(multiplier_));
}

void DualSolve::goOn(const std::vector<double>& mu) {
  watch_.goesOnAfter(task_.report.result);
  leaveOutBefore();
  const WarmStart reached = {Teuchos::null, mu};
  makeProblem(&reached);
  run();
}

// An interrupted run that had got vectors on its way, or left them.
void DualSolve::recallBefore() {
  watch_.restore([this](qp::StateArchive<MultiVector>& archive) { watch_.exchangeBefore(archive); });
  if (watch_.isForeign())
    task_.log.info(
        "Restart on another number of ranks: new adaptive coarse vectors, and the solver starts again");
  watch_.goesOnAfter(watch_.isForeign() ? qp::Result() : qp::Result(watch_.before()));
  leaveOutBefore();
}

// Limits are of all that is done.
void DualSolve::leaveOutBefore() {
  const qp::IterationRecord last = watch_.before().lastRecord();
  options_.maximumIterations = std::max(1, task_.options.maximumIterations - last.inner);
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (task_.options.maximumSeconds > 0.0)
    options_.maximumSeconds =
        std::max(leastSeconds, task_.options.maximumSeconds - last.seconds - task_.report.adaptiveSeconds);
}

void DualSolve::run() {
  makeSolver();
  if (task_.acceptance.judge && !isPenalty())
    solver_->setAcceptance([this] { return isAccepted(); });
  begin();
  announce();
  task_.report.result = solver_->solve();
}

void DualSolve::makeProblem(const WarmStart* start) {
  problem_ = Teuchos::rcp(new qp::TpetraProblem(deflated_ ? deflated_->hessian : dual().hessian(),
                                                solution_.lambda, deflated_ ? deflated_->rhs : dual().rhs()));
  problem_->setLowerBound(dual().lowerBound());
  problem_->setUpperBound(dual().upperBound());
  problem_->setDiscs(dual().discs());
  problem_->setFollowingLimits(dual().followingLimits());
  problem_->setSoftBounds(dual().softBounds());
  if (!dual().equalityRows().is_null())
    addEquality(start);
  if (!task_.stages.preconditioner.is_null())
    problem_->setPreconditioner(deflated_ ? deflated_->preconditioner : task_.stages.preconditioner);
  if (!problem_->setProblem())
    throw NumericalError("the dual problem cannot be solved: " + problem_->whyNotSet());
}

// Gλ = 0.
void DualSolve::addEquality(const WarmStart* start) {
  const Teuchos::RCP<const Map> map = dual().equalityRows()->getRangeMap();
  multiplier_ = Teuchos::rcp(new MultiVector(map, 1));
  if (start != nullptr && start->mu.size() == multiplier_->getLocalLength()) {
    const auto view = multiplier_->getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::copy(start->mu.begin(), start->mu.end(), view.data());
  }
  const auto zero = Teuchos::rcp(new MultiVector(map, 1));
  problem_->setEquality(dual().equalityRows(), zero, multiplier_,
                        qp::EqualityStructure::OrthonormalInvariant);
  problem_->setHessianOnKernel(deflated_ ? deflated_->hessianOnKernel : dual().hessianOnKernel());
  problem_->setUnprojectedHessian(deflated_ ? deflated_->unprojected : dual().unprojectedHessian());
  problem_->setFaceGram(task_.stages.coarse->faceGram());
}

void DualSolve::makeSolver() {
  using Auto = qp::AutoSolver<Scalar, MultiVector, Operator>;
  method_ = options_.method == "Auto" ? Auto::choice(*problem_) : options_.method;
  solver_ = qp::TpetraSolverFactory().create(method_, parametersOf(method_));
  task_.report.solver = solver_->name();
  test_ = Details::stoppingTest(task_.stages, options_, tolerance_, !isPenalty(), task_.report);
  using Combo = qp::StatusTestCombo<MultiVector>;
  const Teuchos::RCP<qp::StatusTest<MultiVector>> spent = Teuchos::rcp(new KeptIsEnough(kept_, inner_));
  solver_->setConvergenceTest(Teuchos::rcp(new Combo(Combo::Type::Or, {test_.test, spent})));
  solver_->setLog(task_.log);
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
  return task_.stages.constraints->limited() > 0 && (first == "auto" || first == "tried") &&
         norm(*dual().shift()) == 0.0;
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
  if (deflated_)
    deflated_->span->complete(dual().d(), *solution_.lambda);
  const Verdict verdict =
      task_.acceptance.judge(*solution_.lambda, valuesOf(multiplier_), std::isfinite(met) ? met : tolerance_);
  kept_.forget();
  if (!verdict.next)
    return true;
  if (verdict.isEnough)
    keep();
  tolerance_ = *verdict.next;
  setTolerance();
  return false;
}

void DualSolve::keep() {
  constexpr int few = 20;
  // Rescues of a solver whose active sets recur may lead far away.
  constexpr double rise = 30.0;
  const int before = task_.acceptance.iterationsBefore + watch_.before().lastRecord().inner;
  kept_.keep(*solution_.lambda, multiplier_, test_.gradient->value(),
             test_.equality.is_null() ? 0.0 : test_.equality->value(), inner_,
             {std::max(few, (before + inner_) / 2), rise});
}

void DualSolve::takeKept() {
  const std::string reason = qp::toString(task_.report.result.reason);
  const bool isSpent = kept_.isSpent(inner_);
  if (kept_.replace(task_.report.result, *solution_.lambda, multiplier_))
    task_.log.info("No further progress (" + (isSpent ? "iteration budget used up" : reason) +
                   "): the last solution that met the tolerance is used");
}

void DualSolve::begin() {
  const Teuchos::RCP<AdaptiveSpace>& space = task_.stages.adaptive;
  // SMALBE gets on slowly for reasons of its own, which vectors do not cure.
  const bool mayAdapt = !space.is_null() && space->isPossible() && !space->isMade() &&
                        !watch_.hasLeftVectors() && !isPenalty() && method_ != "SMALBE";
  const bool mayLeave = deflated_ && method_ != "SMALBE";
  const auto target = [this] { return tolerance_ * task_.report.gradientScale; };
  if (mayAdapt)
    watch_.stopWhen(slowness(options_.tolerance), target);
  else if (mayLeave)
    watch_.stopWhen(standstill(), target);
  if (!task_.monitor.is_null())
    task_.monitor->begins({task_.stages, method_, [this] {
                             // What the tests last measured against.
                             DualTargets targets{tolerance_ * task_.report.gradientScale, 0.0};
                             if (!test_.equality.is_null())
                               targets.equality = tolerance_ * test_.equality->scale();
                             return targets;
                           }});
  if (mayAdapt || mayLeave || !task_.monitor.is_null())
    solver_->setMonitor(Teuchos::rcpFromRef<qp::SolverMonitor<MultiVector>>(watch_));
  watch_.alsoKeep([this](qp::StateArchive<MultiVector>& archive) {
    kept_.exchange(archive, *solution_.lambda, multiplier_);
    if (task_.acceptance.exchange)
      task_.acceptance.exchange(archive);
  });
  if (!watch_.hasState())
    return;
  watch_.restore([this](qp::StateArchive<MultiVector>& archive) { watch_.exchange(archive); });
  if (tolerance_ == task_.options.tolerance) // another one was asked for then
    kept_.forget();
  setTolerance();
}

void DualSolve::announce() const {
  std::ostringstream text;
  text << "Solver: " << task_.report.solver << ", tolerance " << scientific(tolerance_, 0) << " ("
       << toString(options_.stoppingRule) << " rule)";
  task_.log.info(text.str());
  if (options_.progressFrequency > 0)
    task_.log.info("  outer  inner  step              |g^P|   |G lambda|   active     F*x  seconds");
}

void DualSolve::conclude() {
  if (deflated_)
    deflated_->span->complete(dual().d(), *solution_.lambda);
  takeKept();
  task_.report.result.counters.setupApplications += dual().setupApplications();
  task_.report.solved = true;
  measureRounding();
  if (!test_.equality.is_null())
    measureEquality();
  // y with yᵀGλ > 0 for all admissible λ: forces of one sign act on the motion R L⁻ᵀy.
  if (task_.report.result.reason == qp::Reason::Infeasible && !solver_->certificate().is_null()) {
    MultiVector forces(task_.stages.constraints->rowMap(), 1);
    dual().equalityRows()->apply(*solver_->certificate(), forces, Teuchos::TRANS);
    solution_.escape = task_.stages.coarse->solve(task_.stages.coarse->multiply(forces)); // A⁻G̃Gᵀy = L⁻ᵀy
    solution_.isEscaping = true;
  }
  task_.report.converged = task_.report.result.converged();
  task_.report.reason = qp::toString(task_.report.result.reason);
  if (!task_.report.converged)
    task_.report.reason += ": " + task_.report.result.explanation;
  solution_.mu = valuesOf(multiplier_);
}

// Springs that open far beside what bodies are strained by.
void DualSolve::measureRounding() {
  const double rounding = test_.gradient->rounding();
  if (!task_.report.result.converged() || !(rounding > tolerance_ * task_.report.gradientScale))
    return;
  task_.report.openingRounding = rounding / task_.report.gradientScale;
  task_.report.gradientScale = rounding / tolerance_;
}

// The scale that belongs to the last iterate, which the solver may not have asked for.
void DualSolve::measureEquality() {
  qp::IterationState<MultiVector> last;
  last.x = solution_.lambda.get();
  last.equalityResidual = task_.report.result.equalityNorm;
  const bool met = test_.equality->checkStatus(last) == qp::Status::Passed;
  task_.report.equalityScale = test_.equality->scale();
  if (!met && task_.report.result.converged())
    task_.log.info(
        "Note: the penalty method leaves |G lambda| = " + scientific(task_.report.result.equalityNorm) +
        ", above the tolerance of the stopping rule, " + scientific(test_.equality->limit()));
}

} // namespace

DualSolution solveDualProblem(const DualStages& stages, const SolverOptions& options, const WarmStart* start,
                              const Acceptance& acceptance, const Log& log, SolveReport& report,
                              const Teuchos::RCP<DualMonitor>& monitor) {
  return DualSolve({stages, options, acceptance, log, report, monitor}).go(start);
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
