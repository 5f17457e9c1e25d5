// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualStages.hpp"

#include <Teuchos_RCP.hpp>

#include <functional>
#include <string>

namespace Harmos::feti::Details {

/// Decides, row after row of a history, that a solver is to be stopped. @param target of ‖g^P‖, of now.
using Patience = std::function<bool(const qp::IterationRecord&, double target)>;

/// Over where a solver gets on so slowly that adaptive vectors are worth their while.
Patience slowness(double tolerance);
/// Over where a solver gets on no more.
Patience standstill();

/// Monitor between a solve and the monitor of the caller, if any. Adds the tolerance set by the acceptance
/// test and the work done with earlier adaptive vectors to the state of the solver, and stops the solve when
/// its patience is exhausted.
///
/// Guarded by tests/unit/feti/test_adaptive_space.cpp, tests/regression/test_checkpoint.py.
class SolveWatch : public qp::SolverMonitor<MultiVector> {
 public:
  /// @param asked tolerance. @param tolerance that of now, to outlive this. @param ranks of this run.
  SolveWatch(const Teuchos::RCP<DualMonitor>& monitor, double asked, double& tolerance, int ranks)
      : monitor_(monitor), asked_(asked), tolerance_(tolerance), ranks_(ranks) {}

  /// A run that asks for another tolerance begins with that.
  void exchange(Archive& archive);
  /// What the solver had done before it got adaptive vectors or left them.
  void exchangeBefore(Archive& archive);
  /// Whether the state is of other vectors than those of this many ranks: boundaries of shared inverses
  /// depend on ranks.
  bool isForeign() const { return isForeign_; }
  const qp::Result& before() const { return before_; }

  /// That the solver works with vectors from now on, or no more, is part of its state, by these names.
  static constexpr const char* vectorsName = "adaptive vectors";
  static constexpr const char* leftName = "adaptive vectors left";
  void haveVectors() { vectors_ = Vectors::In; }
  void leaveVectors() { vectors_ = Vectors::Left; }
  bool hasLeftVectors() const { return vectors_ == Vectors::Left; }

  /// What else is part of the solver's state.
  void alsoKeep(Exchange further) { further_ = std::move(further); }

  /// @param target of ‖g^P‖, of now.
  void stopWhen(Patience patience, std::function<double()> target) {
    patience_ = std::move(patience);
    target_ = std::move(target);
  }
  /// Whether patience was over.
  bool isStopped() const { return isStopped_; }
  /// The solver begins anew, after what another one did.
  void goesOnAfter(const qp::Result& before);

  void recorded(const qp::IterationRecord& record) override;
  Wish ask(const qp::IterationState<MultiVector>& state) override;
  void save(const Exchange& state) override;
  bool hasState() const override { return !isForeign_ && !monitor_.is_null() && monitor_->hasState(); }
  bool holds(const std::string& name) const override { return monitor_->holds(name); }
  void restore(const Exchange& state) override { monitor_->restore(state); }

 private:
  enum class Vectors { None, In, Left };

  Teuchos::RCP<DualMonitor> monitor_;
  double asked_;
  double& tolerance_;
  int ranks_;
  Vectors vectors_ = Vectors::None;
  bool isForeign_ = false;
  qp::Result before_; // counters and history of the solvers before
  Patience patience_;
  Exchange further_;
  std::function<double()> target_;
  bool isOver_ = false, isStopped_ = false;
};

} // namespace Harmos::feti::Details
