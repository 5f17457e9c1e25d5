// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

namespace Harmos::qp {

/// Which entries lie at a bound on this rank: −1 lower, +1 upper, 0 free. Kept between two splittings, so
/// that changes of the face can be counted.
using LocalActiveSet = std::vector<signed char>;

/// Sums of a gradient splitting; global, the same on all ranks.
struct SplitSums {
  double freeNorm2 = 0.0;    ///< φᵀφ
  double choppedNorm2 = 0.0; ///< βᵀβ
  double reducedNorm2 = 0.0; ///< φ̃ᵀφ
  double freeDotImage = 0.0; ///< φᵀ(Hp)
  long long active = 0;      ///< entries at a bound
  long long changed = 0;     ///< entries whose state differs from that in the given set

  double projectedNorm2() const { return freeNorm2 + choppedNorm2; }
};

/// Sums along a search direction; global.
struct DirectionSums {
  double gradientDotDirection = 0.0;                            ///< gᵀp
  double directionDotImage = 0.0;                               ///< pᵀHp
  double directionNorm2 = 0.0;                                  ///< pᵀp
  double longestStep = std::numeric_limits<double>::infinity(); ///< max α with x − αp within the bounds
};

/// What Belos::MultiVecTraits lacks for bounds; to be specialised for each vector type.
///
/// A null bound is an absent one; entries of ∓∞ are absent bounds too. Vectors have one column. The
/// definitions, for l ≤ x ≤ u and the gradient g (Dostál, Optimal Quadratic Programming Algorithms, 2009,
/// section 5.1):
///  - free gradient φ_i = g_i where l_i < x_i < u_i, else 0;
///  - chopped gradient β_i = min(g_i, 0) where x_i = l_i, max(g_i, 0) where x_i = u_i, else 0;
///  - projected gradient g^P = φ + β;
///  - reduced free gradient φ̃_i = min((x_i − l_i)/ᾱ, φ_i) for φ_i > 0, max((x_i − u_i)/ᾱ, φ_i) for φ_i < 0.
///
/// All functions are collective over the vectors' communicator, unless said otherwise.
/// Guarded by tests/unit/qp/test_bound_traits.cpp.
template<class Scalar, class MV>
struct BoundTraits {
  /// One pass, one reduction: φ, the sums, and the active set, which is updated.
  /// @param stepLength ᾱ; @param image Hp for φᵀ(Hp), or null.
  static SplitSums split(const MV& x, const MV& gradient, const MV* lower, const MV* upper, double stepLength,
                         const MV* image, MV& freeGradient, LocalActiveSet& active);

  /// ‖g^P‖.
  static double projectedGradientNorm(const MV& x, const MV& gradient, const MV* lower, const MV* upper);

  /// β. Local.
  static void choppedGradient(const MV& x, const MV& gradient, const MV* lower, const MV* upper, MV& chopped);

  /// All sums along p.
  static DirectionSums direction(const MV& x, const MV& gradient, const MV& direction, const MV& image,
                                 const MV* lower, const MV* upper);

  /// x ← Π(x), the projection onto the bounds. Local.
  static void project(MV& x, const MV* lower, const MV* upper);

  /// x ← x − αp with α the longest feasible step: entries that reach a bound are put exactly onto it. Local.
  static void stepToBoundary(MV& x, const MV& direction, double step, const MV* lower, const MV* upper);

  /// The first pair l_i > u_i or NaN among the bounds; true if there is none.
  static bool boundsAreConsistent(const MV* lower, const MV* upper);

  /// Pseudo-random entries in (−1, 1) that depend on the global index alone, not on the distribution. Local.
  static void setRandom(MV& x);
};

} // namespace Harmos::qp
