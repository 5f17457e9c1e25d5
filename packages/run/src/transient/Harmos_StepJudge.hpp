// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Motion.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <map>
#include <tuple>
#include <vector>

namespace Harmos::run {

/// Whether a transient step may stand: contacts give no energy, and it is short enough for what moves in it.
///
/// *Contacts.* A rule that weighs forces of both ends of a step, α_f and 1 − α_f, makes contacts with gaps g
/// and forces λ, gᵀλ = 0, work by
///
///     (α_f λ₀ + (1 − α_f)λ₁)ᵀ(g₁ − g₀) = α_f λ₀ᵀg₁ − (1 − α_f)λ₁ᵀg₀,
///
/// where rigid obstacles do no work: bodies that part gain, those that meet lose. Where steps resolve the
/// impact both are of second order and make up for each other, else a body may part three times as fast as it
/// came. So what contacts have given so far is counted; a step by which that comes above a share of the
/// largest energy there has been is to be done again by Motion::damp(), a rule that takes λ₁ alone and never
/// gains (Kane, Repetto, Ortiz, Marsden, Comput. Methods Appl. Mech. Eng. 180, 1999).
///
/// *Length.* Motion::error() is the relative error of the period of what moves; above what the timeline
/// allows the step is too long.
///
/// Guarded by tests/verification/physics/test_transient_finite.py, its length by test_transient.py.
class StepJudge {
 public:
  /// All to outlive it.
  StepJudge(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const Motion& motion);

  /// Looks at what was reached. @param states of the points of the contact. @note Collective.
  void look(const scene::ContactSetup& contact, const std::vector<ContactState>& states);
  /// Of it: it is longer than the timeline's error allows; contacts give energy.
  bool isTooLong() const;
  bool gains() const;
  /// The step stands. @param stored energy, with what it began with. @note Collective.
  void commit(double stored);
  /// A step of twice the length would have been good.
  bool isCalm() const;

  /// What was committed. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive);

 private:
  using Key = std::tuple<std::size_t, long long, int>; // effect, node, side
  struct Point {
    double force, gap;
  };

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  const Motion& motion_;
  std::map<Key, Point> committed_, reached_; // of this rank
  double given_ = 0.0, givenByStep_ = 0.0;   // by contacts
  double energy_ = 0.0, kinetic_ = 0.0;      // the largest there have been
  double error_ = 0.0;                       // of the step
};

} // namespace Harmos::run
