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

  /// Limits go where the solution is. @param gradient null: zeros. @param upper null without intervals, discs
  /// null without discs. Local.
  static void follow(const MV& x, const MV* gradient, const FollowUpdate& how, const FollowingLimits& limits,
                     MV& lower, MV* upper, LocalDiscs* discs) {
    Kernels::follow(limits, BT::read(x), gradient != nullptr ? BT::read(*gradient) : nullptr, how,
                    BT::write(lower), upper != nullptr ? BT::write(*upper) : nullptr, discs);
  }

  /// After updateActiveSet(): what it means for limits that follow. An entry that is pushed against its limit
  /// stays there, wherever that has gone; else it is active where x − αg is beyond.
  /// @param before the set before that update.
  static FollowChange updateFollowing(const MV& x, const MV& gradient, const Set& feasible,
                                      const FollowingLimits& limits, double stepLength, double gradientNoise,
                                      const LocalActiveSet& before, LocalActiveSet& set) {
    const Box box(feasible);
    const FollowChange change =
        Kernels::update(limits, BT::read(x), BT::read(gradient), box.lower(), box.upper(), feasible.discs,
                        stepLength, gradientNoise, before, set);
    double sums[] = {static_cast<double>(change.changed), static_cast<double>(change.active),
                     change.distance2};
    BT::sum(x, sums, 3);
    return {static_cast<long long>(sums[0]), static_cast<long long>(sums[1]), sums[2]};
  }

  /// y ← y + f x_k e at what follows. Local.
  static void addFollowing(const std::vector<FollowingEntry>& following, const MV& x, MV& y) {
    Kernels::addFollowing(following, BT::read(x), BT::write(y));
  }

  /// x goes to where it follows; along tangents it stays. Local.
  static void moveToFollowing(const std::vector<FollowingEntry>& following, const MV& lower, MV& x) {
    Kernels::moveToFollowing(following, BT::read(lower), BT::write(x));
  }

  /// x goes to limits that follow: active entries, and pairs that slip along their radii. Local.
  static void moveToLimits(MV& x, const Set& feasible, const FollowingLimits& limits,
                           const LocalActiveSet& active) {
    const Box box(feasible);
    Kernels::moveToLimits(limits, box.lower(), box.upper(), feasible.discs, active, BT::write(x));
  }

  /// The radii as a vector, each at the first entry it is of, and back. Local.
  static void limitsToVector(const FollowingLimits& limits, const Set& feasible, MV& radii) {
    double* const rs = BT::write(radii);
    std::fill_n(rs, BT::length(radii), 0.0);
    Kernels::limitsToArray(limits, Box(feasible).upper(), feasible.discs, rs);
  }
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
