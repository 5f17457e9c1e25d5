// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_IncrementSolver.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

// Gaps of the answer are known to rounding errors, and changes of them to the same share.
AnswerCriteria IncrementSolver::criteria(const Task& task, double largestDisplacement) const {
  const Teuchos::Comm<int>& comm = *pipeline_.system().comm();
  double rounding = 0.0, largest = 0.0;
  for (const ConstraintRow& row : task.rows) {
    rounding = std::max(rounding, row.rounding);
    largest = std::max(largest, std::abs(row.bound));
  }
  AnswerCriteria result;
  result.estimatesErrors = false;
  if (largestDisplacement > 0.0)
    result.roundingShare = pipeline_.accuracy().boundRounding / largestDisplacement;
  result.boundRounding = globalMax(comm, rounding) + result.roundingShare * globalMax(comm, largest);
  return result;
}

IncrementSolver::Increment IncrementSolver::solve(const Task& task, double largestDisplacement) {
  SolverOptions options = options_;
  options.tolerance = task.tolerance;
  if (!task.withDisplacement)
    return forcesAlone(task, options);
  Increment result;
  AnswerQuality quality;
  JudgedSolve solve(
      pipeline_, [&] { return pipeline_.incrementStages(task.loads, task.rows); }, options,
      criteria(task, largestDisplacement), log_, result.report, quality);
  TornSolution torn = solve.go(history_, task.tolerance);
  result.displacement = std::move(torn.displacement);
  result.rowForces = solve.stages().constraints->givenMultipliers(*torn.multiplier);
  return result;
}

IncrementSolver::Increment IncrementSolver::forcesAlone(const Task& task, const SolverOptions& options) {
  Increment result;
  const DualStages stages = pipeline_.incrementStages(task.loads, task.rows);
  const std::optional<WarmStart> start = history_.start(*stages.problem, task.tolerance);
  const DualSolution dual =
      solveDualProblem(stages, options, start ? &*start : nullptr, {}, log_, result.report);
  pipeline_.rethrowFailures();
  const Teuchos::RCP<MultiVector> total = stages.problem->total(*dual.lambda);
  if (result.report.converged)
    history_.add(*stages.problem, total, dual.mu);
  result.rowForces = stages.constraints->givenMultipliers(*total);
  return result;
}

} // namespace Harmos::feti
