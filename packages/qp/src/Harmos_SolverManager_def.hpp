// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Errors.hpp"
#include "Harmos_SolverManager.hpp"
#include "Harmos_VectorOps.hpp"

#include <iomanip>
#include <sstream>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::addCommonParameters(ParameterSpec& spec) {
  spec.real(
      "Convergence Tolerance", 1e-8, Range::above(0.0),
      "Relative tolerance of the default convergence test: of the projected gradient against the right-hand "
      "side, of the equality residual against max(‖c‖, ‖x‖).");
  spec.integer("Maximum Iterations", 10000, 0, 1000000000,
               "Inner iterations after which the solver gives up.");
  spec.integer("Output Frequency", 0, 0, 1000000000,
               "A line of progress every so many iterations; 0 prints none.");
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::setParameters(const Teuchos::RCP<Teuchos::ParameterList>& parameters) {
  const Teuchos::ParameterList empty;
  parameters_ = Teuchos::rcp(new Teuchos::ParameterList(
      parameterSpec().validated(parameters.is_null() ? empty : *parameters, name() + " parameters")));
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::setProblem(const Teuchos::RCP<ProblemType>& problem) {
  if (problem.is_null())
    throw InputError(name() + ": the problem is null");
  if (!problem->isProblemSet())
    throw InputError(name() + ": the problem is not ready: " + problem->whyNotSet() +
                     ". Call Problem::setProblem() after the last setter and look at its answer.");
  problem_ = problem;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<StatusTest<MV>> SolverManager<Scalar, MV, OP>::defaultTest() const {
  const double tolerance = parameters_->template get<double>("Convergence Tolerance");
  std::vector<Teuchos::RCP<StatusTest<MV>>> tests = {
      Teuchos::rcp(new StatusTestProjectedGradient<MV>(tolerance, norm<Scalar>(*problem_->rhs())))};
  if (problem_->hasEqualities()) {
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    Teuchos::RCP<MV> noShift = MVT::Clone(*problem_->solution(), 1);
    MVT::MvInit(*noShift, 0.0);
    tests.push_back(Teuchos::rcp(new StatusTestEqualityResidual<MV, Scalar>(
        tolerance, norm<Scalar>(*problem_->equalityValues()), noShift)));
  }
  return Teuchos::rcp(new StatusTestCombo<MV>(StatusTestCombo<MV>::Type::Sequence, tests));
}

template<class Scalar, class MV, class OP>
Result SolverManager<Scalar, MV, OP>::solve() {
  if (parameters_.is_null())
    setParameters(Teuchos::null);
  if (problem_.is_null())
    throw InputError(name() + ": solve() was called without a problem; call setProblem() first");
  if (!problem_->isProblemSet())
    throw InputError(name() + ": the problem was changed after setProblem(): " + problem_->whyNotSet());
  reset();
  activeTest_ = convergenceTest_.is_null() ? defaultTest() : convergenceTest_;
  activeTest_->reset();
  start_ = std::chrono::steady_clock::now();
  doSolve();
  return result_;
}

template<class Scalar, class MV, class OP>
bool SolverManager<Scalar, MV, OP>::converged(const IterationState<MV>& state) {
  return activeTest_->checkStatus(state) == Status::Passed;
}

template<class Scalar, class MV, class OP>
void SolverManager<Scalar, MV, OP>::record(const IterationState<MV>& state, StepKind step, double penalty,
                                           double precision, long long active) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  result_.projectedGradientNorm = state.projectedGradient;
  result_.equalityNorm = state.equalityResidual;
  result_.history.push_back({state.outer, state.inner, step, state.projectedGradient, state.equalityResidual,
                             penalty, precision, active, result_.counters.hessianApplications, seconds});
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
