// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CohesiveLaw.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::effects {

/// The damage of the points of an interface within a step, as numbers that a run keeps for it: from solution
/// to solution towards d = max(d_0, D(δ(d))), d_0 that with which the step began, D the law, δ(d) the
/// openings of the solution with d frozen.
///
/// d = D(δ) over and over comes there slowly where springs are stiff beside the bodies: the error falls by
/// the factor ((1 − d)k + s)/((1 − d)k + K) a time, K the stiffness of the bodies and −s the slope of the
/// softening law. But whatever the damage was, openings and tractions of all answers lie in one affine space,
/// that of the bodies under their load, as long as the same contacts are open: answers of earlier steps too,
/// shifted by what the load has done at the same damage. Among what the last answers span, openings are
/// looked for at which tractions are least beside the law (in the spirit of D. G. Anderson, J. ACM 12, 1965),
/// and D is asked there; by no factors that multiply what answers are wrong by beyond the tolerance. What is
/// not made much better so is left to the law: 1 − d times (law/traction), to the power of one, and of twice
/// as much each time that follows; and so are some answers where the least does not fall any more, for then
/// there may be nothing near at which the points hold.
///
/// Bounds: damage is not below d_0, and no further than half way to the end of the law from where the answer
/// itself is. What breaks in between is not lost yet: the trial damage may come back, to d_0 at most.
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

  /// Of a point in the answer, also of one that has broken.
  struct Point {
    double area = 0.0;
    CohesiveLaw::Opening opening;
  };
  /// @param tolerance of the answer. @return whether the damage has changed by more than that is good for.
  bool update(const std::vector<Point>& points, double tolerance);

  // What numbers say, also of committed states.
  static const double* damage(const std::vector<double>& numbers);
  static std::size_t points(const std::vector<double>& numbers);
  static double dissipated(const std::vector<double>& numbers);
  /// Area by area, the share of what the law dissipates in all that was dissipated in the step.
  static double brokenShare(const std::vector<double>& numbers);

 private:
  bool breakWorst(const std::vector<Point>& points, double tolerance);
  bool approach(const std::vector<Point>& points, double tolerance);
  double pull(std::size_t k, const CohesiveLaw::Opening& opening) const;
  void remember(const std::vector<Point>& points);
  std::vector<double> combined(const std::vector<Point>& points, double tolerance);
  struct Normal {
    std::vector<std::vector<double>> gram;
    std::vector<double> right;
  };
  double residualAt(const std::vector<Point>& points, const std::vector<double>& factors,
                    std::vector<double>& sizes, Normal* normal);
  double* sizeOf(std::size_t answer);
  double* pullOf(std::size_t answer);
  void account(const std::vector<Point>& points);
  double* part(std::size_t index) { return numbers_.data() + index * points_; }

  const CohesiveLaw& law_;
  std::vector<double>& numbers_;
  std::size_t points_;
};

} // namespace Harmos::effects
