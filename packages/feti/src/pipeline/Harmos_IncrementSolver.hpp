// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_JudgedSolve.hpp"
#include "Harmos_SolutionHistory.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// How an answer changes: what other loads and bounds come to with the matrices and rows of a pipeline, and
/// with prescribed values of zero. The pipeline's own problem and what is solved of it are not touched.
///
/// Guarded by tests/unit/feti/test_increments.cpp and tests/unit/run/test_capabilities.cpp.
class IncrementSolver {
 public:
  struct Increment {
    SolveReport report;
    TornVector displacement;       ///< empty where it was not asked for
    std::vector<double> rowForces; ///< of the rows that this rank gave
  };
  struct Task {
    std::vector<std::shared_ptr<const std::vector<double>>> loads; ///< of this rank's subdomains
    /// Those of the pipeline with other bounds, and with statuses: where all inequalities are decided the
    /// problem is linear.
    std::vector<ConstraintRow> rows;
    double tolerance;
    /// Without it there is no audit either, and an application of the local inverses less.
    bool withDisplacement = true;
  };

  IncrementSolver(DualPipeline& pipeline, const SolverOptions& options, const Log& log)
      : pipeline_(pipeline), options_(options), log_(log) {}

  /// Starts from what was asked before. @param largestDisplacement of the answer that changes, whose bounds
  /// are known to a share of it, and increments to the same share; 0: not known.
  /// @throws InputError, NumericalError, InternalError on all ranks. @note Collective.
  Increment solve(const Task& task, double largestDisplacement);
  /// After a change of matrices or rows.
  void clear() { history_.clear(); }
  /// For checkpoints, as SolutionHistory. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const DualProblem& problem) {
    history_.exchange(archive, problem, "increments: ");
  }

 private:
  Increment forcesAlone(const Task& task, const SolverOptions& options);
  AnswerCriteria criteria(const Task& task, double largestDisplacement) const;

  DualPipeline& pipeline_;
  SolverOptions options_;
  const Log& log_;
  SolutionHistory history_;
};

} // namespace Harmos::feti
