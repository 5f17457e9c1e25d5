// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CohesiveLaw.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace Harmos::effects {

/// The damage of the points of an interface within a step, as numbers that a run keeps for it: from solution
/// to solution towards d = max(d_0, D(δ)), d_0 that with which the step began, D the law, δ the openings.
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
/// All members are local. Guarded by tests/unit/effects/test_damage_update.cpp.
class DamageUpdate {
 public:
  /// How many numbers it keeps of so many points.
  static std::size_t size(std::size_t points);

  /// @param numbers of that size, which it changes; to outlive this.
  DamageUpdate(const CohesiveLaw& law, std::vector<double>& numbers);

  /// A step begins, for the first time or again.
  void beginStep();

  /// Opening, not negative, and two slips, each times the root of its stiffness.
  using Stretch = std::array<double, 3>;
  /// Of a point in the answer, also of one that has broken.
  struct Point {
    double area = 0.0;
    Stretch stretch = {};
  };
  /// Breaks what is beyond the strength of a brittle law; whether there was anything. @param tolerance of
  /// tractions, as a share of the strength.
  bool breakWorst(const std::vector<Point>& answer, double tolerance);
  /// Damage of such openings; springs through the origin, or, where points soften, so many times as stiff as
  /// softening is steep, through traction and opening. @return whether any does.
  /// @param known to what tractions are, as a share of the strength: less than that brings no broken point
  /// back.
  bool follow(const std::vector<Point>& points, std::optional<double> steepness, double known);

  /// By the law, each divided by the root of its stiffness, from the damage with which the step began.
  static Stretch traction(const CohesiveLaw& law, const std::vector<double>& numbers, std::size_t point,
                          const Stretch& stretch);
  /// How far tractions of springs are from that in an answer, at the worst point: a share of the strength.
  static double misfit(const CohesiveLaw& law, const std::vector<double>& numbers,
                       const std::vector<Point>& answer);

  // What numbers say, also of committed states.
  static const double* damage(const std::vector<double>& numbers);
  static std::size_t points(const std::vector<double>& numbers);
  static double dissipated(const std::vector<double>& numbers);
  /// Area by area, the share of what the law dissipates in all that was dissipated in the step.
  static double brokenShare(const std::vector<double>& numbers);

  /// The springs of a point that is not broken: so many times as stiff as intact ones, and where they have no
  /// force.
  struct Spring {
    Stretch stiffness = {}, unstretched = {};
  };
  static Spring spring(const std::vector<double>& numbers, std::size_t point);
  /// Where a point of the bilinear law broke, if it did so in the step.
  static std::optional<Stretch> brokenAt(const std::vector<double>& numbers, std::size_t point);

 private:
  void keepModes(const std::vector<Point>& points);
  void place(std::size_t k, const Stretch& stretch, double share);
  void linearise(std::size_t k, double steepness);
  bool staysBroken(std::size_t k, const Stretch& stretch, double known) const;
  void account(const std::vector<Point>& points);
  double* part(std::size_t index) { return numbers_.data() + index * points_; }
  const double* part(std::size_t index) const { return numbers_.data() + index * points_; }

  const CohesiveLaw& law_;
  std::vector<double>& numbers_;
  std::size_t points_;
};

} // namespace Harmos::effects
