// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_SlipStates.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <vector>

namespace Harmos::run {

/// What the effects of a scene keep from step to step, as scene::Effect describes it: committed once a step,
/// and a trial state that is thrown away where the step is.
///
/// The same on every rank; all members are local. Guarded by tests/unit/run/test_step_sequence.cpp.
class EffectStates {
 public:
  /// @param scene, contact to outlive this.
  EffectStates(const scene::Scene& scene, const scene::ContactSetup& contact);

  bool any() const { return !states_.empty(); }
  /// A step begins, for the first time or again: the trial state becomes the committed one.
  void begin();
  /// Asks every effect; whether any wants the step to be solved again.
  /// @param slips of the limited rows.
  bool update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips = {});
  void commit();
  /// The rows of the setup with bounds by the trial state.
  std::vector<ConstraintRow> rows() const;

  /// Both, for a checkpoint may be written in the middle of a step.
  void exchange(qp::StateArchive<MultiVector>& archive);

 private:
  struct State {
    const scene::Effect* effect;
    std::vector<std::size_t> points;  // of the setup, an inequality row each
    std::vector<std::size_t> limited; // rows
    std::vector<double> committed, trial;
  };

  const scene::ContactSetup& contact_;
  std::vector<State> states_;
  std::vector<std::size_t> pointOfSlip_; // of each limited row
};

} // namespace Harmos::run
