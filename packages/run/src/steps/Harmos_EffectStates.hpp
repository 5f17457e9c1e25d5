// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_SlipStates.hpp"
#include "Harmos_Softening.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <optional>
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
  /// @param advance of loads, see Softening::begin().
  void begin(std::optional<double> advance = std::nullopt);
  /// Whether springs have changed in the step.
  bool hasSoftened() const { return softening_ && softening_->hasChanged(); }
  /// Asks every effect; whether any wants the step to be solved again.
  /// @param answer, slips of the inequality and the limited rows, as they were by the trial state. @param
  /// tolerance of the answer.
  bool update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips = {},
              double tolerance = 0.0, const feti::WarmStart& multipliers = {}, double startedAt = 1.0);
  /// Where the next solution of the step is to start; null: from the last one.
  feti::WarmStart start() const { return softening_ ? softening_->start() : feti::WarmStart(); }
  /// To which the next solution is worth to be found, where it is not the last. @param asked of answers.
  double tolerance(double asked) const;
  void commit();
  /// The rows of the setup with bounds and softness by the trial state.
  std::vector<ConstraintRow> rows() const;

  /// Of what breaks, by the trial state: that which was dissipated since the run began; how much broke in the
  /// step, see scene::Effect::haste().
  double dissipated() const;
  double haste() const;
  /// Brings damage, openings and tractions to the points of an answer that the trial state has settled with.
  void tell(const std::vector<RowSlip>& slips, std::vector<ContactState>& answer) const;

  /// Both, for a checkpoint may be written in the middle of a step.
  void exchange(qp::StateArchive<MultiVector>& archive);
  /// The same of answers of interfaces that soften. @note Collective.
  void exchangeAnswers(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  struct State {
    const scene::Effect* effect;
    std::vector<std::size_t> points;      // of the setup, an inequality row each
    std::vector<std::size_t> limited;     // rows
    std::vector<scene::Effect::Row> rows; // of both
    std::vector<double> committed, trial;
  };
  // What the trial states say of rows, by their numbers.
  struct Rows {
    std::vector<double> shift, slip; // to be added to bounds of inequalities and limited rows
    std::vector<double> unstretched; // more, of inequalities that are springs
    std::vector<std::optional<double>> softness, slipSoftness;
  };
  std::vector<scene::Effect::RowAnswer> answersOf(const State& state, const Rows& rows,
                                                  const std::vector<ContactState>& answer,
                                                  const std::vector<RowSlip>& slips) const;
  std::vector<double> stiffnessesOfSoftening() const;
  std::vector<Softening::Part> softeningParts();
  Rows applied() const;
  std::vector<double> shiftsBy(const State& state) const;
  void add(const scene::Effect& effect, std::vector<std::size_t> points, std::vector<std::size_t> limited);

  const scene::ContactSetup& contact_;
  std::vector<State> states_;
  std::vector<std::size_t> pointOfSlip_; // of each limited row
  std::optional<Softening> softening_;
};

} // namespace Harmos::run
