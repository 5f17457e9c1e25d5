// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_SlipStates.hpp"
#include "Harmos_Softening.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <optional>
#include <unordered_map>
#include <vector>

namespace Harmos::run {

/// What the effects of a scene keep from step to step, as scene::Effect describes it: committed once a step,
/// and a trial state that is thrown away where the step is.
///
/// Each rank has the states of its own points of contact, whose rows it gives. Members are collective unless
/// they say otherwise. Guarded by tests/unit/run/test_step_sequence.cpp.
class EffectStates {
 public:
  EffectStates(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const scene::ContactSetup& contact);

  /// On any rank. Local.
  bool any() const { return !states_.empty(); }
  /// Of this rank, in doubles. Local.
  std::size_t size() const;
  /// A step begins, for the first time or again: the trial state becomes the committed one.
  /// @param advance of loads, see Softening::begin().
  void begin(std::optional<double> advance = std::nullopt);
  /// Whether springs have changed in the step. Local.
  bool hasSoftened() const { return softening_ && softening_->hasChanged(); }
  /// Asks every effect; whether any wants the step to be solved again.
  /// @param answer, slips of the inequality and the limited rows of this rank, as they were by the trial
  /// state.
  /// @param tolerance of the answer.
  bool update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips = {},
              double tolerance = 0.0, const feti::WarmStart& multipliers = {}, double startedAt = 1.0);
  /// Where the next solution of the step is to start; null: from the last one.
  feti::WarmStart start() const { return softening_ ? softening_->start() : feti::WarmStart(); }
  /// To which the next solution is worth to be found, where it is not the last. @param asked of answers.
  double tolerance(double asked) const;
  void commit();
  /// This rank's rows of the setup with bounds and softness by the trial state. Local.
  std::vector<ConstraintRow> rows() const;
  /// Of each point of this rank whether it had broken when the step began. Local.
  std::vector<char> broken() const;

  /// Of what breaks, by the trial state: that which was dissipated since the run began; how much broke in the
  /// step, in units of what may, see scene::InterfaceLaw::broken().
  double dissipated() const;
  double haste() const;
  /// Brings damage, openings and tractions to the points of an answer, of this rank, that the trial state has
  /// settled with. Local.
  void tell(const std::vector<RowSlip>& slips, std::vector<ContactState>& answer) const;

  /// Both, for a checkpoint may be written in the middle of a step.
  void exchange(qp::StateArchive<MultiVector>& archive);
  /// The same of answers of interfaces that soften.
  void exchangeAnswers(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  struct State {
    const scene::Effect* effect;
    const scene::InterfaceLaw* law;
    std::vector<std::size_t> points;            // of the setup, an inequality row each
    std::vector<std::size_t> limited;           // rows, by their places on this rank
    std::vector<scene::InterfaceLaw::Row> rows; // of both
    std::vector<long long> numbers;             // of the points that have a state
    scene::PointStates committed, trial;
  };
  // What the trial states say of rows, by their places on this rank.
  struct Rows {
    std::vector<double> shift, slip; // to be added to bounds of inequalities and limited rows
    std::vector<double> unstretched; // more, of inequalities that are springs
    std::vector<std::optional<double>> softness, slipSoftness;
  };
  std::vector<scene::InterfaceLaw::RowAnswer> answersOf(const State& state, const Rows& rows,
                                                        const std::vector<ContactState>& answer,
                                                        const std::vector<RowSlip>& slips) const;
  void makeSoftening();
  std::vector<Softening::Part> softeningParts();
  Rows made() const;
  Rows applied() const;
  std::vector<double> shiftsBy(const State& state) const;
  void add(const scene::Effect& effect, const std::vector<std::size_t>& points,
           const std::vector<std::size_t>& limited);
  void placeRows();

  const Teuchos::Comm<int>& comm_;
  const scene::ContactSetup& contact_;
  std::vector<std::size_t> pointOfSlip_; // of each limited row of this rank
  // Places on this rank of points and limited rows, by their numbers.
  std::unordered_map<long long, std::size_t> placeOfPoint_, placeOfSlip_;
  std::vector<State> states_; // of each law that has points on any rank
  std::optional<Softening> softening_;
};

} // namespace Harmos::run
