// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerJudge.hpp"
#include "Harmos_DualPipeline.hpp"
#include "Harmos_SolutionHistory.hpp"

#include <functional>
#include <optional>

namespace Harmos::feti {

/// A solve of the dual problem whose answer is judged from the primal side (AnswerJudge). Where the judge
/// finds that single precision is what it objects to, the solver goes on from where it has come to with
/// products in double precision.
///
///     go() → recover() → conclude()
///
/// All collective.
class JudgedSolve {
 public:
  /// The stages to solve with: asked for again after a change of precision. Collective.
  using Stages = std::function<DualStages()>;

  /// Makes the stages. @param pipeline whose inverses and operators they have; to outlive this, as log,
  /// report and quality. @param options with the tolerance to solve to. @param report, quality are filled.
  /// @throws what making stages throws; InputError for the rule "balanced" without an estimate.
  JudgedSolve(DualPipeline& pipeline, Stages stages, const SolverOptions& options, AnswerCriteria criteria,
              const Log& log, SolveReport& report, AnswerQuality& quality);

  /// @param start or null, as of solveDualProblem(). @param monitor or null. @throws NumericalError,
  /// InternalError on all ranks.
  const DualSolution& go(const WarmStart* start, const Teuchos::RCP<DualMonitor>& monitor);
  /// All of it, from what the history says, which gets what converges. Reasons name the subdomains that
  /// nothing holds.
  TornSolution go(SolutionHistory& history, double tolerance,
                  const Teuchos::RCP<DualMonitor>& monitor = Teuchos::null);
  /// The solution on the primal side, audited; once.
  TornSolution recover();
  /// An answer that the audit contradicts to the end is not called converged, except where the method leaves
  /// jumps by design.
  void conclude();

  const DualSolution& solution() const { return solution_; }
  const DualStages& stages() const { return stages_; }

 private:
  void solveOnce(const WarmStart* start, const Teuchos::RCP<DualMonitor>& monitor,
                 const qp::IterationRecord& spent);
  void solveInDoublePrecision(const Teuchos::RCP<DualMonitor>& monitor);
  std::string escapingSubdomains() const;
  bool showsRounding(const Verdict& verdict) const;
  // The penalty method, which says so.
  bool leavesJumps() const { return report_.solver == "Dual Penalty"; }

  DualPipeline& pipeline_;
  Stages makeStages_;
  SolverOptions options_;
  AnswerCriteria criteria_;
  const Log& log_;
  SolveReport& report_;
  AnswerQuality& quality_;
  DualStages stages_;
  std::optional<AnswerJudge> judge_;
  DualSolution solution_;
  bool roundingIsSeen_ = false; // of products, or of single precision, in the last answer
};

} // namespace Harmos::feti
