// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectStates.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_RunStages.hpp"
#include "Harmos_SolutionHistory.hpp"
#include "Harmos_StepClock.hpp"

#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

/// A run of several steps, each from what was committed with the one before:
///
///     set-up (once) → for each step: loads, bounds → solve → judge → states of effects → commit → write
///
/// A step that does not converge, or whose states do not converge, is halved (StepClock) and restarts from
/// the committed state. If it cannot be halved further, the run ends with the reason, and the results of
/// earlier steps remain. Each accepted step writes steps.csv, the result files with their series, and the
/// checkpoint, in this order and each completely. A restart therefore finds a checkpoint with exactly its
/// results, however the run ended.
///
/// All members are collective. Guarded by tests/regression/test_steps.py.
class StepSequence {
 public:
  /// All to outlive this. @param run before its set-up.
  StepSequence(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
               const RunOptions& options, const Log& log, RunStages& run, RunReport& report);

  /// @return the solution of the last solve. @throws what run::runScene() throws.
  Solution go();

 private:
  using Archive = qp::StateArchive<MultiVector>;
  enum class Outcome { Accepted, Failed, Interrupted };

  void begin();
  void requireConsistent();
  bool restore();
  Outcome attempt();
  Outcome solve();
  void prepare(double time);
  Outcome accept();
  Outcome look(bool endsStep);
  void tell(const StepRow& row, double snapped) const;
  bool writesFields() const;
  void saveBetweenSteps();
  void exchange(Archive& archive, bool isWithinSolve);
  void sumUp();
  Solution end(Outcome outcome);
  std::string placeText() const;
  bool isOutOfTime() const;
  bool hasSteps() const { return scene_.timeline.hasSteps(); }
  std::optional<feti::WarmStart> startOfSolve() const;
  feti::WarmStart lastSolution() const;
  double residualAtStart() const;
  std::optional<double> advance() const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  const scene::Scene& scene_;
  const RunOptions& options_;
  const Log& log_;
  Log quiet_;
  RunStages& run_;
  RunReport& report_;

  std::optional<EffectStates> states_;
  std::optional<EnergyAccount> energy_;
  bool prescribesMotion_ = false; // on any rank
  StepClock clock_;
  feti::SolutionHistory history_;
  std::vector<StepRow> rows_;
  std::vector<RunDirectory::Written> written_;
  std::vector<qp::IterationRecord> iterations_; // of all solves, counted on
  qp::Counters counters_;                       // likewise
  int updates_ = 0;                             // of states in this attempt
  qp::Counters attemptCounters_;                // of all its solves
  Teuchos::RCP<RunMonitor> monitor_;            // of the last solve
  std::shared_ptr<WatchClock> watch_ = std::make_shared<WatchClock>();
  double secondsBefore_ = 0.0;               // of solves before the checkpoint
  const CheckpointReader* within_ = nullptr; // a solve to go on with
  std::string failure_;                      // of the last attempt
};

} // namespace Harmos::run
