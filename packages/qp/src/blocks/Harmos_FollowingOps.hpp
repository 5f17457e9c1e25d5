// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_FollowingLimits.hpp"
#include "Harmos_SecondOrderCones.hpp"

#include <cmath>
#include <vector>

namespace Harmos::qp {

/// Vectors whose limits follow the solution, see FollowingLimit. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV>
struct FollowingOps {
  using BT = BoundTraits<Scalar, MV>;
  using Ops = BoundOps<Scalar, MV>;
  using Set = FeasibleSet<MV>;
  using Box = BoxView<Scalar, MV>;

  /// Radii, each at the first entry it is of, as limits of bounds and discs. Local.
  static void vectorToLimits(const FollowingLimits& limits, const MV& radii, MV& lower, MV* upper,
                             LocalDiscs* discs) {
    Kernels::arrayToLimits(limits, BT::read(radii), BT::write(lower),
                           upper != nullptr ? BT::write(*upper) : nullptr, discs);
  }

  /// x ← the nearest point with |x_i − c| ≤ f·(x_k − l_k) for all limits that follow, each with a source of
  /// its own, and within the bounds of the others. Local.
  static void projectOntoCones(MV& x, const Set& feasible, const FollowingLimits& limits) {
    double* const xs = BT::write(x);
    const Kernels::Cones before = Kernels::conesOf(limits, xs, feasible.discs);
    Ops::clamp(feasible, BT::length(x), xs);
    Kernels::projectOntoCones(before, limits, Box(feasible).lower(), feasible.discs, xs);
  }

  /// Infimum of wᵀx over these points; what falls without end counts in openNorm.
  static BoxInfimum coneInfimum(const MV& w, const Set& feasible, const FollowingLimits& limits) {
    std::vector<double> others = Ops::localEntries(w);
    double sums[3] = {0, 0, 0};
    Kernels::takeConeInfimum(limits, Box(feasible).lower(), feasible.discs, others.data(), sums);
    BT::sum(w, sums, 3);
    BoxInfimum result = Ops::boxInfimum(w, others.data(), feasible);
    result.value += sums[0];
    result.openNorm = std::hypot(result.openNorm, std::sqrt(sums[1]));
    result.boundNorm = std::hypot(result.boundNorm, std::sqrt(sums[2]));
    return result;
  }

  /// Bounds, discs and limits that follow. @param limits null: none. Local.
  static Kernels::SecondOrderCones conesOf(const Set& feasible, const MV& like,
                                           const FollowingLimits* limits) {
    const Box box(feasible);
    return {BT::length(like), box.lower(), box.upper(),
            feasible.discs != nullptr ? &feasible.discs->discs() : nullptr, limits};
  }
};

} // namespace Harmos::qp
