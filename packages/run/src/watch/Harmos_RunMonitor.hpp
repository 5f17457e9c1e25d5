// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CheckpointFile.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_LiveView.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

/// Of the equality rows of a problem.
RowBasis rowBasis(const feti::DualProblem& problem);

/// @param present the dual problem as it is now. @param condition of the subdomains, see RunReport.
/// @throws InputError on all ranks if the right-hand side that a checkpoint holds is that of another problem.
/// @note Collective.
void requireSameProblem(const CheckpointReader& checkpoint, const feti::DualProblem& present,
                        double condition);

/// When a run last did what it does by the clock; in seconds since it began to solve.
struct WatchClock {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double lastSave = 0.0, lastShow = 0.0;
};

/// The place of a solve in a run of several.
struct SolvePlace {
  std::string text;             ///< before the status line: "step 3/5 t 0.6  "
  qp::IterationRecord before{}; ///< the last one of the steps before: rows are counted on from it
  std::shared_ptr<WatchClock> clock = nullptr; ///< of all of them
  bool hasEarlier = false; ///< iterations.csv has the rows of the steps before; this one's are appended
};

/// Monitor of the solver of a run: appends to iterations.csv, writes contact.csv every few seconds and
/// checkpoints when they are due or requested, and restores the solver from a checkpoint.
///
/// Clocks and signals of the ranks are compared by a reduction, about four times a second.
/// Guarded by tests/regression/test_checkpoint.py.
class RunMonitor : public feti::DualMonitor {
 public:
  /// @param checkpoint to go on from, or null. Checkpoints and their fate go to the
  /// report.
  RunMonitor(const Teuchos::Comm<int>& comm, const RunOptions& options, const CheckpointReader* checkpoint,
             const scene::ContactSetup& contact, const Log& log, RunReport& report, SolvePlace place = {});
  ~RunMonitor() override;

  /// Where to start from a checkpoint of other clusters, as on another number of ranks: the state of the
  /// solver is of no use then, and is left, but not the forces that it had come to. None: go on from its
  /// state, or there is no checkpoint. @note Collective.
  std::optional<feti::WarmStart> startOfOtherClusters(const feti::DualProblem& problem);
  /// What else belongs to a checkpoint.
  void addState(const Exchange& state) { states_.push_back(state); }

  void goesOnAfter(const qp::IterationRecord& last) override;
  void begins(const feti::DualRun& run) override;
  void recorded(const qp::IterationRecord& record) override;
  Wish ask(const qp::IterationState<MultiVector>& state) override;
  void save(const Exchange& state) override;
  bool hasState() const override { return checkpoint_ != nullptr; }
  bool holds(const std::string& name) const override { return checkpoint_->holds(name); }
  void restore(const Exchange& state) override;

  /// After the solver has finished: what is due, or what the run was told meanwhile. @note Collective.
  Wish askBetween();
  /// After the solver has finished: a checkpoint without its state. @note Collective.
  void saveBetween(const Exchange& state);

 private:
  struct Look {
    double elapsed;
    Told told;
  };
  // Counts what the solver asks, so that ranks look at the clock together, and seldom.
  struct Pace {
    long long asked = 0, nextLook = 1, lastLook = 0;
    double lastElapsed = 0.0; // seconds, at the last look
  };
  Look look();
  Wish wishAt(const qp::IterationState<MultiVector>& state);
  void write(const Exchange& all);
  std::vector<std::pair<long long, double>> contactForces(const MultiVector& lambda) const;
  void showContact(const MultiVector& lambda) const;
  void exchangeProblem(Archive& archive);

  const Teuchos::Comm<int>& comm_;
  const RunOptions& options_;
  const CheckpointReader* checkpoint_;
  const scene::ContactSetup& contact_;
  const Log& log_;
  RunReport& report_;
  SolvePlace place_;
  std::vector<Exchange> states_;
  std::optional<feti::DualRun> run_;
  std::unique_ptr<LiveView> view_;
  std::shared_ptr<WatchClock> clock_;
  Pace pace_;
  int lastOuter_ = 1;
  std::vector<qp::IterationRecord> rows_;
  Teuchos::RCP<MultiVector> reached_; // λ + λ̃ when a checkpoint is due
};

} // namespace Harmos::run
