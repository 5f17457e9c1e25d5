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
/// The same on every rank: where an effect has state, the points of contact, some 400 bytes each, their
/// answers and the states are on all of them. Members are local unless they say otherwise. Guarded by
/// tests/unit/run/test_step_sequence.cpp.
class EffectStates {
 public:
  /// @note Collective.
  EffectStates(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const scene::ContactSetup& contact);

  bool any() const { return !states_.empty(); }
  /// A step begins, for the first time or again: the trial state becomes the committed one.
  /// @param advance of loads, see Softening::begin().
  void begin(std::optional<double> advance = std::nullopt);
  /// Whether springs have changed in the step.
  bool hasSoftened() const { return softening_ && softening_->hasChanged(); }
  /// Asks every effect; whether any wants the step to be solved again.
  /// @param answer, slips of the inequality and the limited rows of this rank, as they were by the trial
  /// state.
  /// @param tolerance of the answer. @note Collective.
  bool update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips = {},
              double tolerance = 0.0, const feti::WarmStart& multipliers = {}, double startedAt = 1.0);
  /// Where the next solution of the step is to start; null: from the last one.
  feti::WarmStart start() const { return softening_ ? softening_->start() : feti::WarmStart(); }
  /// To which the next solution is worth to be found, where it is not the last. @param asked of answers.
  double tolerance(double asked) const;
  void commit();
  /// This rank's rows of the setup with bounds and softness by the trial state.
  std::vector<ConstraintRow> rows() const;

  /// Of what breaks, by the trial state: that which was dissipated since the run began; how much broke in the
  /// step, see scene::Effect::haste().
  double dissipated() const;
  double haste() const;
  /// Brings damage, openings and tractions to the points of an answer, of this rank, that the trial state has
  /// settled with.
  void tell(const std::vector<RowSlip>& slips, std::vector<ContactState>& answer) const;

  /// Both, for a checkpoint may be written in the middle of a step.
  void exchange(qp::StateArchive<MultiVector>& archive);
  /// The same of answers of interfaces that soften. @note Collective.
  void exchangeAnswers(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  // What effects with state act on, of all ranks.
  struct Whole {
    std::vector<contact::ContactPoint> points;     // by their numbers
    std::vector<const scene::Effect*> effects;     // of each
    std::vector<std::size_t> pointOfSlip;          // of each limited row
    std::vector<const scene::Effect*> slipEffects; // of each limited row; null: no friction
    struct Bond {
      const scene::Effect* effect;
      std::size_t point;
      double softness, tangentialSoftness;
      std::size_t firstSlip, slips; // rows
    };
    std::vector<Bond> bonds;
  };
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

  bool anyHasState() const;
  void gather();
  std::vector<ContactState> gathered(const std::vector<ContactState>& answer) const;
  std::vector<RowSlip> gathered(const std::vector<RowSlip>& slips) const;

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  const scene::ContactSetup& contact_;
  Whole whole_;
  std::vector<State> states_;
  std::optional<Softening> softening_;
};

} // namespace Harmos::run
