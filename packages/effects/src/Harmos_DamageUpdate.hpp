// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CohesiveLaw.hpp"
#include "Harmos_InterfaceLaw.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace Harmos::effects {

/// Opening, not negative, and two slips, each times the root of its stiffness.
using Stretch = std::array<double, 3>;

/// What adhesion keeps of a point.
struct DamageState {
  double damage, begun;    ///< d, and that when the step began
  double lost, lostBefore; ///< what was dissipated, and that when the step began
  double mode;             ///< the last share of mode II
  Stretch place;           ///< of the answer through which its springs go
  Stretch stiffness;       ///< of its springs, where it softens; else 0

  /// The springs of a point that is not broken: so many times as stiff as intact ones, and where they have no
  /// force.
  struct Spring {
    Stretch stiffness = {}, unstretched = {};
  };
  Spring spring() const;
  /// Where it broke, if it did so in the step.
  std::optional<Stretch> brokenAt() const;
};

/// The damage of the points of an interface within a step: from solution to solution towards d = max(d_0,
/// D(δ)), d_0 that with which the step began, D the law, δ the openings.
///
/// With d frozen the springs of a solution are (1 − d)k, and D(δ) over and over comes to the answer, from
/// below, but slowly where they are stiff beside the bodies. Points that soften therefore get springs of a
/// share of how steep softening is, ρk = θs, through the law's traction at an opening δ' that is given,
///
///     t = (1 − d)kδ' + ρk(δ − δ')
///
/// along the way in which they open, and (1 − d)k across it, for a traction turns with the opening. Which
/// openings and what θ says run::Softening. What a point has opened on the way is nothing that it remembers:
/// damage is d_0 at least, and what the answer says.
///
/// A point that breaks while friction waits for it is where the law ends: bodies need no more than friction
/// may bear, and no less than nothing, to hold it there. So friction takes over from that slip, not from
/// where the step began; the point stays broken unless it goes back by more than tractions are known to.
/// (With friction from the beginning of the step on it would be held where it is not broken, be freed again,
/// slip and break, for ever.)
///
/// The brittle law breaks what is beyond its strength by at least nine tenths of what the worst point is.
///
/// Points are those of one rank; members are local unless they say otherwise. Guarded by
/// tests/unit/effects/test_damage_update.cpp.
class DamageUpdate {
 public:
  /// @param states of DamageState, which it changes; to outlive this.
  DamageUpdate(const CohesiveLaw& law, scene::PointStates& states) : law_(law), states_(states) {}

  /// A step begins, for the first time or again.
  void beginStep();

  /// Of a point in the answer, also of one that has broken.
  struct Point {
    double area = 0.0;
    Stretch stretch = {};
  };
  /// Breaks what is beyond the strength of a brittle law; whether there was anything, on any rank.
  /// @param tolerance of tractions, as a share of the strength. @note Collective.
  bool breakWorst(const std::vector<Point>& answer, double tolerance,
                  const scene::InterfaceLaw::Largest& largest);
  /// Damage of such openings; springs through the origin, or, where points soften, so many times as stiff as
  /// softening is steep, through traction and opening. @return whether any does.
  /// @param known to what tractions are, as a share of the strength: less than that brings no broken point
  /// back.
  bool follow(const std::vector<Point>& points, std::optional<double> steepness, double known);

  /// By the law, each divided by the root of its stiffness, from the damage with which the step began.
  static Stretch traction(const CohesiveLaw& law, const DamageState& state, const Stretch& stretch);
  /// How far tractions of springs are from that in an answer, at the worst point: a share of the strength.
  static double misfit(const CohesiveLaw& law, const scene::PointStates& states,
                       const std::vector<Point>& answer);
  /// @param points of which the areas count.
  static scene::InterfaceLaw::Broken broken(const CohesiveLaw& law, const scene::PointStates& states,
                                            const std::vector<Point>& points);

 private:
  void keepMode(DamageState& state, const Stretch& stretch) const;
  void linearise(DamageState& state, double steepness) const;
  bool staysBroken(const DamageState& state, const Stretch& stretch, double known) const;
  void account(DamageState& state, double area) const;

  const CohesiveLaw& law_;
  scene::PointStates& states_;
};

} // namespace Harmos::effects
