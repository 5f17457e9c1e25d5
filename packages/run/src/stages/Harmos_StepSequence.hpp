// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectStates.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_EquilibriumLoop.hpp"
#include "Harmos_Locks.hpp"
#include "Harmos_Motion.hpp"
#include "Harmos_MovingBounds.hpp"
#include "Harmos_RunStages.hpp"
#include "Harmos_SolutionHistory.hpp"
#include "Harmos_StepClock.hpp"
#include "Harmos_StepJudge.hpp"

#include <chrono>
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
  /// @param run of this context, before its set-up; to outlive this.
  StepSequence(const RunContext& context, RunStages& run);

  /// @return the solution of the last solve. @throws what run::runScene() throws.
  Solution go();

 private:
  using Archive = qp::StateArchive<MultiVector>;
  enum class Outcome { Accepted, Failed, Interrupted };

  void begin();
  void requireConsistent();
  bool restore();
  Outcome attempt();
  Outcome attemptOnce();
  Outcome solve();
  Outcome solveFinite();
  bool updateStates(double tolerance);
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
  bool savingTakesLong() const;
  void reachEnergy();
  bool hasSteps() const { return context_.scene.timeline.hasSteps(); }
  std::optional<feti::WarmStart> startOfSolve() const;
  feti::WarmStart lastSolution() const;
  double residualAtStart() const;
  std::optional<double> advance() const;

  // What is committed.
  struct Done {
    std::vector<StepRow> rows;
    std::vector<RunDirectory::Written> written;
  };
  // What solvers did, in steps that were given up too.
  struct Work {
    std::vector<qp::IterationRecord> iterations; // counted on
    qp::Counters counters;
    double secondsBefore = 0.0; // of solves before the checkpoint
    bool wantsVectors = false;  // of a coarse space, from here on
  };
  struct Attempt {
    int updates = 0;       // of states
    qp::Counters counters; // of all its solves
    long long factorisationsBefore = 0;
    std::string failure; // of the last attempt
  };

  RunContext context_;
  Log quiet_;
  RunStages& run_;

  std::optional<EffectStates> states_;
  // Of rows, besides what states say.
  struct Bounds {
    MovingBounds moving;
    Locks locks;
    bool any() const { return moving.any() || locks.any(); }
  };
  std::optional<Bounds> bounds_;
  std::optional<EnergyAccount> energy_;
  std::optional<EquilibriumLoop> equilibrium_; // of finite displacements
  // Of transient runs.
  struct Inertia {
    Motion motion;
    std::optional<StepJudge> judge = std::nullopt;
  };
  std::optional<Inertia> inertia_;
  bool prescribesMotion_ = false; // on any rank
  StepClock clock_;
  feti::SolutionHistory history_;
  Done done_;
  Work work_;
  Attempt attempt_;
  struct Watch {
    Teuchos::RCP<RunMonitor> monitor; // of the last solve
    std::shared_ptr<WatchClock> clock = std::make_shared<WatchClock>();
    const CheckpointReader* within = nullptr; // a solve to go on with
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
    double saving = 0.0; // seconds of checkpoints between steps
  } watch_;
};

} // namespace Harmos::run
