// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Explanations.hpp"
#include "Harmos_FeasibilityProbe.hpp"
#include "Harmos_NormEstimate_def.hpp"
#include "Harmos_SolverManager.hpp"
#include "Harmos_VectorOps.hpp"

#include <Teuchos_SerialDenseMatrix.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace Harmos::qp {

namespace Details {

template<class Solver>
Teuchos::RCP<Solver> cloneOf(const Solver& solver) {
  Teuchos::RCP<Solver> copy = Teuchos::rcp(new Solver);
  if (!solver.getCurrentParameters().is_null())
    copy->setParameters(Teuchos::rcp(new Teuchos::ParameterList(*solver.getCurrentParameters())));
  return copy;
}

} // namespace Details

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::addCommonParameters(ParameterSpec& spec) {
  spec.real(
      "Convergence Tolerance", 1e-8, Range::above(0.0),
      "Relative tolerance of the default convergence test: of the projected gradient against the right-hand "
      "side, of the equality residual against max(‖c‖, ‖x‖).");
  spec.integer("Maximum Iterations", 10000, 0, 1000000000, "Largest number of inner iterations.");
  spec.real("Maximum Seconds", 0.0, Range::atLeast(0.0),
            "Time limit in seconds, by the slowest rank's clock; 0: no limit.");
  spec.integer("Output Frequency", 0, 0, 1000000000,
               "Iterations between two lines of progress; 0: no lines.");
  spec.expert().integer("Orthonormalised Rows", 500, 0, 100000,
                        "Largest number of equality rows that are orthonormalised, at an application of C "
                        "and Cᵀ each, unless they are known to be orthonormal. More rows are used "
                        "unchanged.");
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::setParameters(const Teuchos::RCP<Teuchos::ParameterList>& parameters) {
  const Teuchos::ParameterList empty;
  std::vector<std::string> notes;
  parameters_ = Teuchos::rcp(new Teuchos::ParameterList(
      parameterSpec().validated(parameters.is_null() ? empty : *parameters, name() + " parameters", &notes)));
  for (const std::string& note : notes)
    log_.info("Note: " + note);
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::setProblem(const Teuchos::RCP<ProblemType>& problem) {
  if (problem.is_null())
    throw InputError(name() + ": the problem is null");
  if (!problem->isProblemSet())
    throw InputError(name() + ": the problem is not ready: " + problem->whyNotSet() +
                     ". Call Problem::setProblem() after the last setter and check its result.");
  problem_ = problem;
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::makeTest() {
  if (!tests_.given.is_null()) {
    tests_.active = tests_.given;
  } else {
    tests_.load = Teuchos::rcp(new StatusTestProjectedGradient<MV>(
        parameters_->template get<double>("Convergence Tolerance"), norm<Scalar>(*problem_->rhs())));
    tests_.active = defaultTest();
  }
  if (outer_.hasTest)
    return;
  tests_.active->reset();
  if (!problem_->hasEqualities())
    measureLoad(nullptr);
}

// Where b = 0: its size with the origin moved to the point next to it that bounds, or equalities, allow.
template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::measureLoad(const EqualityRows<Scalar, MV, OP>* rows) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (tests_.load.is_null() || tests_.load->scale() > 0.0)
    return;
  const Teuchos::RCP<MV> x = MVT::Clone(*problem_->solution(), 1);
  MVT::MvInit(*x, 0.0);
  BlockOps<Scalar, MV>::project(problem_->blocks(), *x);
  tests_.load->raiseScale(imageNorm(*x));
  double length = norm<Scalar>(*x);
  if (rows != nullptr) {
    rows->nearestToZero(*x);
    tests_.load->raiseScale(imageNorm(*x));
    length = std::max(length, norm<Scalar>(*x));
  }
  if (tests_.load->scale() == 0.0)
    tests_.load->raiseScale(imageNorm(*problem_->solution()));
  // What A makes nothing of is no load: gradients of the size of its rounding errors are zero.
  double hessianNorm = problem_->hessianNorm();
  if (hessianNorm == 0.0 && length > 0.0) {
    BoundOps<Scalar, MV>::setRandom(*x);
    hessianNorm = estimateNorm<Scalar, MV>(
        [this](const MV& in, MV& out) {
          Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_->hessian(), in, out);
        },
        *x, 12, result_.counters.setupApplications);
  }
  tests_.load->raiseScale(1e2 * std::numeric_limits<double>::epsilon() * hessianNorm * length /
                          parameters_->template get<double>("Convergence Tolerance"));
  tests_.load = Teuchos::null; // others to which this one delegates need not do so again
}

// ‖Ax‖, with the forces of soft bounds that x has left.
template<class Scalar, class MV, class OP>
double SolverManager<Scalar, MV, OP>::imageNorm(const MV& x) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Teuchos::RCP<MV> image = MVT::Clone(x, 1);
  MVT::MvInit(*image, 0.0);
  if (norm<Scalar>(x) > 0.0) {
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_->hessian(), x, *image);
    ++result_.counters.setupApplications;
  }
  BlockOps<Scalar, MV>::addForces(problem_->blocks(), x, *image);
  return norm<Scalar>(*image);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<StatusTest<MV>> SolverManager<Scalar, MV, OP>::defaultTest() const {
  if (!problem_->hasEqualities() || !meetsEqualities())
    return tests_.load;
  const double tolerance = parameters_->template get<double>("Convergence Tolerance");
  const auto equality = Teuchos::rcp(new StatusTestEqualityDistance<MV, Scalar>(tolerance, 0.0));
  return Teuchos::rcp(new StatusTestCombo<MV>(StatusTestCombo<MV>::Type::Sequence, {tests_.load, equality}));
}

template<class Scalar, class MV, class OP>
Result SolverManager<Scalar, MV, OP>::solve() {
  if (parameters_.is_null())
    setParameters(Teuchos::null);
  if (problem_.is_null())
    throw InputError(name() + ": solve() was called without a problem; call setProblem() first");
  if (!problem_->isProblemSet())
    throw InputError(name() + ": the problem was changed after setProblem(): " + problem_->whyNotSet());
  if (!problem_->kind().isSet && !takesAllBlocks())
    throw InputError(name() + " does not support soft bounds (bounds with a penalty curvature, as of a glued "
                              "interface); use PDAS or Auto");
  if (!problem_->kind().isCost && !letsLimitsFollow())
    throw InputError(name() +
                     " does not support limits that depend on the solution, as of friction; use Auto");
  reset();
  result_.method = name();
  session_ = Session();
  session_.start = std::chrono::steady_clock::now();
  if (!outer_.hasTest)
    tests_.load = Teuchos::null;
  // They refer to what doSolve() leaves behind.
  struct Forget {
    Session& session;
    ~Forget() { session.state = session.delegation = nullptr; }
  } forget{session_};
  if (isSenseless())
    return result_;
  makeTest();
  doSolve();
  return result_;
}

// Of this run alone: what a limit is about.
template<class Scalar, class MV, class OP>
double SolverManager<Scalar, MV, OP>::sessionSeconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - session_.start).count();
}

template<class Scalar, class MV, class OP>
double SolverManager<Scalar, MV, OP>::elapsedSeconds() const {
  return session_.secondsBefore + sessionSeconds();
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::save() {
  if (monitor_.is_null() || !session_.state)
    return;
  monitor_->save([&](Archive& archive) {
    if (outer_.state)
      outer_.state(archive);
    double seconds = elapsedSeconds();
    archive.number(prefix(outer_.depth) + "seconds", seconds);
    exchangeResult(archive, prefix(outer_.depth), result_);
    session_.state(archive);
  });
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::resume() {
  session_.hasResumed = true;
  monitor_->restore([&](Archive& archive) {
    archive.number(prefix(outer_.depth) + "seconds", session_.secondsBefore);
    session_.state(archive);
    exchangeResult(archive, prefix(outer_.depth), result_);
  });
}

template<class Scalar, class MV, class OP>
bool SolverManager<Scalar, MV, OP>::isInterrupted(const IterationState<MV>& state) {
  if (monitor_.is_null())
    return false;
  const auto wish = monitor_->ask(state);
  if (wish == SolverMonitor<MV>::Wish::GoOn)
    return false;
  save();
  if (wish == SolverMonitor<MV>::Wish::Save)
    return false;
  stop(Reason::Interrupted, Explanations::interrupted(), state);
  return true;
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::keepState(Reason reason) {
  if (reason == Reason::IterationLimit || reason == Reason::TimeLimit)
    save();
}

template<class Scalar, class MV, class OP>
bool SolverManager<Scalar, MV, OP>::isSenseless() {
  // Vectors may have changed in place since the problem was set.
  const std::pair<const char*, const MV*> vectors[] = {
      {"the right-hand side", problem_->rhs().get()},
      {"the initial guess", problem_->solution().get()},
      {"the right-hand side of the equalities", problem_->equalityValues().get()},
      {"the initial multiplier", problem_->multiplier().get()}};
  for (const auto& [name, vector] : vectors)
    if (vector != nullptr && !std::isfinite(norm<Scalar>(*vector))) {
      stop(Reason::Breakdown, Explanations::notFinite(name));
      return true;
    }
  const BoundFault crossed =
      BoundOps<Scalar, MV>::findBoundFault(*problem_->solution(), problem_->feasibleSet());
  if (crossed.found && !(crossed.lower > crossed.upper)) {
    stop(Reason::Breakdown, Explanations::notFinite("the bounds"));
    return true;
  }
  if (crossed.found) {
    Certificate certificate;
    certificate.gap = crossed.lower - crossed.upper;
    certificate.entry = crossed.entry;
    stopInfeasible(Teuchos::null, certificate);
    return true;
  }
  return !problem_->nullSpace().is_null() && fallsAlongNullSpace();
}

// The part d of b in the range of R: along it the cost falls at a constant rate, and without end if no bound
// and no equality row is in the way.
template<class Scalar, class MV, class OP>
bool SolverManager<Scalar, MV, OP>::fallsAlongNullSpace() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using OPT = Belos::OperatorTraits<Scalar, MV, OP>;
  using Bounds = BoundOps<Scalar, MV>;
  const double noise = std::sqrt(std::numeric_limits<double>::epsilon());
  const MV& kernel = *problem_->nullSpace();
  const int columns = static_cast<int>(MVT::GetNumberVecs(kernel));
  const auto size = static_cast<std::size_t>(columns);
  const Teuchos::RCP<MV> d = MVT::Clone(*problem_->solution(), 1), image = MVT::Clone(*d, 1);

  Counters& counters = result_.counters;
  double hessianNorm = problem_->hessianNorm();
  if (hessianNorm == 0.0) {
    Bounds::setRandom(*d);
    hessianNorm =
        estimateNorm<Scalar, MV>([&](const MV& x, MV& y) { OPT::Apply(*problem_->hessian(), x, y); }, *d, 12,
                                 counters.setupApplications);
  }
  Teuchos::SerialDenseMatrix<int, Scalar> gram(columns, columns), coefficients(columns, 1);
  for (int k = 0; k < columns; ++k) {
    coefficients.putScalar(0.0);
    coefficients(k, 0) = 1.0;
    MVT::MvTimesMatAddMv(1.0, kernel, coefficients, 0.0, *d);
    OPT::Apply(*problem_->hessian(), *d, *image);
    ++counters.setupApplications;
    const double defect = norm<Scalar>(*image), length = norm<Scalar>(*d);
    if (!(defect <= noise * hessianNorm * length))
      throw InputError(name() + ": the given null space is invalid: ‖AR‖ = " + scientific(defect) +
                       " for its column " + std::to_string(k) + " of norm " + scientific(length) +
                       ", while ‖A‖ = " + scientific(hessianNorm));
  }

  MVT::MvTransMv(1.0, kernel, kernel, gram);
  MVT::MvTransMv(1.0, kernel, *problem_->rhs(), coefficients);
  std::vector<double> matrix(size * size), load(size);
  for (int j = 0; j < columns; ++j) {
    load[static_cast<std::size_t>(j)] = coefficients(j, 0);
    for (int i = 0; i < columns; ++i)
      matrix[static_cast<std::size_t>(j) * size + static_cast<std::size_t>(i)] = gram(i, j);
  }
  const std::vector<double> amplitudes = PivotedCholesky(matrix, columns).solve(load);
  for (int i = 0; i < columns; ++i)
    coefficients(i, 0) = amplitudes[static_cast<std::size_t>(i)];
  MVT::MvTimesMatAddMv(1.0, kernel, coefficients, 0.0, *d);
  const double length = norm<Scalar>(*d);
  if (!(length > noise * norm<Scalar>(*problem_->rhs())))
    return false;
  MVT::MvScale(*d, 1.0 / length);
  if (BlockOps<Scalar, MV>::recede(problem_->blocks(), *d) > noise)
    return false;
  MVT::MvScale(*d, 1.0 / norm<Scalar>(*d));

  Certificate certificate;
  if (problem_->hasEqualities()) {
    const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = makeRows();
    if (rows.is_null())
      return true; // there is nothing to fall in
    const Teuchos::RCP<MV> w = rows->makeVector();
    rows->apply(*d, *w);
    certificate.defect = norm<Scalar>(*w) / std::sqrt(rows->norm2());
    if (certificate.defect > noise)
      return false;
    Certificate infeasibility;
    if (FeasibilityProbe<Scalar, MV, OP>(*problem_, *rows).run(1000, *w, infeasibility) ==
        FeasibilityProbe<Scalar, MV, OP>::Verdict::Infeasible) {
      stopInfeasible(w, infeasibility);
      return true;
    }
  }
  OPT::Apply(*problem_->hessian(), *d, *image);
  ++counters.setupApplications;
  if (hessianNorm > 0.0)
    certificate.defect = std::max(certificate.defect, norm<Scalar>(*image) / hessianNorm);
  certificate.gap = dot<Scalar>(*problem_->rhs(), *d);
  stopUnbounded(d, certificate);
  return true;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<EqualityRows<Scalar, MV, OP>> SolverManager<Scalar, MV, OP>::makeRows() {
  Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = Teuchos::rcp(new EqualityRows<Scalar, MV, OP>(
      *problem_, parameters_->sublist("Expert").template get<int>("Orthonormalised Rows")));
  if (!rows->isPresent())
    return rows;
  if (!rows->isFinite()) {
    stop(Reason::Breakdown, Explanations::notFinite("the equality rows"));
    return Teuchos::null;
  }
  const Teuchos::RCP<MV> y = rows->makeVector();
  Certificate certificate;
  if (rows->isConsistent(*y, certificate)) {
    measureLoad(rows.get());
    return rows;
  }
  stopInfeasible(y, certificate);
  return Teuchos::null;
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::stop(Reason reason, const std::string& explanation,
                                         const IterationState<MV>& state) {
  result_.projectedGradientNorm = state.projectedGradient;
  result_.equalityNorm = state.equalityResidual;
  stop(reason, explanation);
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::stopFor(Reason reason, const IterationState<MV>& state) {
  std::string text = Explanations::stoppedByTest(reason);
  if (reason == Reason::Converged)
    text = Explanations::converged();
  else if (reason == Reason::IterationLimit)
    text = Explanations::limit(std::to_string(maximumIterations()) + " inner iterations");
  else if (reason == Reason::TimeLimit)
    text = Explanations::limit(scientific(elapsedSeconds()) + " seconds");
  stop(reason, text, state);
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::stopInfeasible(const Teuchos::RCP<const MV>& y,
                                                   const Certificate& certificate) {
  certificate_ = y;
  result_.certificate = certificate;
  stop(Reason::Infeasible, Explanations::infeasible(certificate));
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::stopUnbounded(const Teuchos::RCP<const MV>& d,
                                                  const Certificate& certificate) {
  certificate_ = d;
  result_.certificate = certificate;
  stop(Reason::Unbounded, Explanations::unbounded(certificate));
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::delegate(SolverManager& other, const Delegation& what) {
  double seconds = elapsedSeconds();
  const auto before = [&, this](Archive& archive) {
    if (outer_.state && !archive.isReading())
      outer_.state(archive);
    archive.number(prefix(outer_.depth) + "seconds", seconds);
    exchangeResult(archive, prefix(outer_.depth), result_);
    if (session_.delegation)
      session_.delegation(archive);
  };
  other.outer_.mayResume = resumesDelegate();
  if (other.outer_.mayResume) {
    monitor_->restore(before);
    session_.hasResumed = true;
  }
  other.setParameters(Teuchos::parameterList(other.parameterSpec().commonPart(*parameters_)));
  // Ranks compare a common time with this limit; it has to be common itself.
  const double limit = parameters_->template get<double>("Maximum Seconds");
  if (limit > 0.0) {
    const double used = BoundTraits<Scalar, MV>::maximum(*problem_->solution(), sessionSeconds());
    other.parameters_->set("Maximum Seconds", std::max(1e-9, limit - used));
  }
  other.firstInner_ = result_.history.empty() ? firstInner_ : result_.history.back().inner;
  other.monitor_ = monitor_;
  other.outer_.state = before;
  other.outer_.depth = outer_.depth + 1;
  other.outer_.products = outer_.products + result_.counters.hessianApplications;
  other.outer_.seconds = outer_.seconds + seconds;
  other.setProblem(what.problem.is_null() ? problem_ : what.problem);
  using Combo = StatusTestCombo<MV>;
  Teuchos::RCP<StatusTest<MV>> test = tests_.active;
  if (!what.orTest.is_null())
    test = Teuchos::rcp(new Combo(Combo::Type::Or, {tests_.active, what.orTest}));
  other.setConvergenceTest(test);
  other.setAcceptance(what.isWhole ? tests_.acceptance : nullptr);
  other.setDebugStatusTest(tests_.debug);
  other.setLog(log_);
  other.outer_.hasTest = true;
  other.tests_.load = tests_.load;
  Result result = other.solve();
  tests_.load = other.tests_.load;
  certificate_ = other.certificate();
  const Counters first = result_.counters;
  for (IterationRecord& record : result.history) {
    record.hessianApplications += first.hessianApplications;
    record.seconds += seconds;
  }
  std::vector<IterationRecord> history = std::move(result_.history);
  history.insert(history.end(), result.history.begin(), result.history.end());
  result_ = std::move(result);
  result_.history = std::move(history);
  result_.counters += first;
}

template<class Scalar, class MV, class OP>
std::optional<Reason> SolverManager<Scalar, MV, OP>::judge(const IterationState<MV>& state) {
  if (!tests_.debug.is_null())
    tests_.debug->checkStatus(state);
  if (tests_.active->checkStatus(state) == Status::Passed)
    return tests_.active->reason();
  if (state.inner >= maximumIterations())
    return Reason::IterationLimit;
  const double limit = parameters_->template get<double>("Maximum Seconds");
  if (limit > 0.0 && BoundTraits<Scalar, MV>::maximum(*state.x, sessionSeconds()) >= limit)
    return Reason::TimeLimit;
  return std::nullopt;
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::record(const IterationState<MV>& state, StepKind step, double penalty,
                                           double precision, long long active) {
  const double seconds = elapsedSeconds();
  result_.projectedGradientNorm = state.projectedGradient;
  result_.equalityNorm = state.equalityResidual;
  result_.history.push_back({state.outer, state.inner, step, state.projectedGradient, state.equalityResidual,
                             penalty, precision, active, result_.counters.hessianApplications, seconds,
                             state.decrease});
  if (!monitor_.is_null()) {
    IterationRecord record = result_.history.back();
    record.hessianApplications += outer_.products;
    record.seconds += outer_.seconds;
    monitor_->recorded(record);
  }
  const int frequency = parameters_->template get<int>("Output Frequency");
  if (frequency == 0 || !log_.writesInfo())
    return;
  if (state.inner % frequency != 0)
    return;
  std::ostringstream line;
  line << "  " << std::setw(5) << state.outer << std::setw(7) << state.inner << "  " << std::left
       << std::setw(14) << toString(step) << std::right << std::scientific << std::setprecision(3)
       << std::setw(11) << state.projectedGradient << std::setw(11) << state.equalityResidual << std::setw(9)
       << active << std::setw(9) << result_.counters.hessianApplications << std::fixed << std::setprecision(2)
       << std::setw(9) << seconds;
  log_.info(line.str());
}

} // namespace Harmos::qp
