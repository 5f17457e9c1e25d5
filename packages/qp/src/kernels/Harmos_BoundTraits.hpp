// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FeasibleSet.hpp"
#include "Harmos_SoftBounds.hpp"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace Harmos::qp {

/// A pair of entries that moves along the tangent of its disc's rim: y = x − c has nᵀy = r, and tᵀy is free,
/// t ⊥ n. What the rim bends away from its tangent is a curvature κ ≥ 0 of the cost, ½κ(tᵀy)².
struct Slip {
  int first, second; ///< local
  double centre[2];
  double radius;
  double normal[2]; ///< n
  double curvature; ///< κ
};

/// Which entries lie at a bound on this rank: −1 lower, +1 upper, 2 on the rim of a disc, 3 slipping along
/// it, 0 free. Kept between two splittings, so that changes of the face can be counted.
struct LocalActiveSet : std::vector<signed char> {
  using std::vector<signed char>::vector;
  static constexpr signed char onRim = 2, slips = 3;
  std::vector<Slip> slipping;  ///< of each pair whose state is `slips`
  std::vector<Spring> springs; ///< entries beyond their soft bounds, whose state is 0; see SpringOps
};

/// How updateActiveSet() deals with discs.
struct DiscUpdate {
  double stepLength = 0.0; ///< α: a pair sticks where |x − c − αg| < r
  double turn = 0.0;       ///< of the gradient, by which a slipping pair may be wrong and go on as it is
};

struct FollowingLimit;
struct FollowingEntry;
namespace Kernels {
class SecondOrderCones;
}

/// How limits follow the solution.
struct FollowUpdate {
  double stepLength = 0.0; ///< α: they go where x − αg is
  double share = 1.0;      ///< s of the way
};

/// What limits that follow add to an ActiveSetChange; global.
struct FollowChange {
  long long changed = 0, active = 0;
  double distance2 =
      0.0; ///< of active entries from their limits, and of slipping pairs within theirs; squares
};

/// What one pass over an iterate and its gradient yields; global, the same on all ranks.
struct SplitSums {
  double freeNorm2 = 0.0;    ///< φᵀφ
  double choppedNorm2 = 0.0; ///< βᵀβ
  double reducedNorm2 = 0.0; ///< φ̃ᵀφ
  double xNorm2 = 0.0;       ///< xᵀx
  long long active = 0;      ///< entries at a bound
  long long changed = 0;     ///< entries whose state differs from that in the given set
  /// Largest α with x − αp within the bounds, p the direction written in the same pass.
  double longestStep = std::numeric_limits<double>::infinity();

  double projectedNorm2() const { return freeNorm2 + choppedNorm2; }
};

/// What a product Hp is asked for; global.
struct CurvatureSums {
  double gradientDotDirection = 0.0; ///< gᵀp
  double directionDotImage = 0.0;    ///< pᵀHp
  double directionNorm2 = 0.0;       ///< pᵀp
  double freeDotImage = 0.0;         ///< φᵀHp
  double freeImageNorm2 = 0.0;       ///< ‖Hp‖² over the free entries
};

/// What a conjugate gradient step ends with; global.
struct ResidualSums {
  double residualNorm2 = 0.0;          ///< wᵀw
  double preconditionedDotImage = 0.0; ///< zᵀHp
  double iterateNorm2 = 0.0;           ///< xᵀx
};

/// A step from an old iterate to a new one; global.
struct ChangeSums {
  double cost = 0.0;          ///< f(x) − f(x_old) = ½(x − x_old)ᵀ(g + g_old), free of cancellation
  double moved2 = 0.0;        ///< ‖x − x_old‖²
  double gradientNorm2 = 0.0; ///< ‖g_old‖²
};

/// Entries that a primal-dual active set method has moved between the sets; global.
struct ActiveSetChange {
  long long active = 0;
  long long changed = 0;
  double violation2 = 0.0; ///< of the bounds, squared, over free entries
  double wrongSign2 = 0.0; ///< of the multipliers of active entries, squared, where the sign is wrong
  double signature[2] = {0.0, 0.0}; ///< the same for the same set; differs with all but certainty else
  long long slips = 0;              ///< pairs
};

/// What a residual w says of slipping pairs, with q for the diagonal of A; global.
struct SlipSums {
  double along2 = 0.0;                           ///< Σ(tᵀw)²
  double softened2 = 0.0;                        ///< Σ(q/(q + κ))²(tᵀw)²
  double springs2 = 0.0, softenedSprings2 = 0.0; ///< the same of springs, w in the place of tᵀw
  double rims2 = 0.0; ///< Σ((q + κ)r)²: where tᵀw is as large, tᵀy is off by about r
};

/// Infimum of wᵀx over the feasible set.
struct BoxInfimum {
  double value = 0.0;     ///< over entries whose bound is there
  double openNorm = 0.0;  ///< ‖w‖ over entries without the bound that w pushes against
  double boundNorm = 0.0; ///< ‖x‖ of the corner where the value is attained
};

/// A pair l_i > u_i, or a bound that is no number; of a disc, ∓ its radius where that is negative, and no
/// number where its entries have bounds of their own.
struct BoundFault {
  bool found = false;
  long long entry = -1; ///< global index, if the vector type has one
  double lower = 0.0;
  double upper = 0.0;
};

/// What Belos::MultiVecTraits lacks for bounds and discs; to be specialised for each vector type.
///
/// Vectors have one column. The definitions, for l ≤ x ≤ u and the gradient g (Dostál, Optimal Quadratic
/// Programming Algorithms, 2009, section 5.1):
///  - free gradient φ_i = g_i where l_i < x_i < u_i, else 0;
///  - chopped gradient β_i = min(g_i, 0) where x_i = l_i, max(g_i, 0) where x_i = u_i, else 0;
///  - projected gradient g^P = φ + β;
///  - reduced free gradient φ̃_i = min((x_i − l_i)/ᾱ, φ_i) for φ_i > 0, max((x_i − u_i)/ᾱ, φ_i) for φ_i < 0.
///
/// In a disc, with n = (x − c)/|x − c| (Dostál, Kozubek, Math. Program. 135, 2012): φ = g inside, 0 on the
/// rim; β = 0 inside, on the rim g where nᵀg ≥ 0, else g − (nᵀg)n; φ̃ = (x − Π(x − ᾱφ))/ᾱ.
///
/// A step of MPRGP is curvature() after the product with H, and advance(): one pass over the vectors and one
/// reduction apart from the product and its pᵀHp. All functions are collective over the vectors'
/// communicator, unless said otherwise.
///
/// Guarded by tests/unit/qp/test_bound_traits.cpp; tests/unit/qp/test_serial_reference.cpp compares whole
/// runs with an unfused specialisation.
template<class Scalar, class MV>
struct BoundTraits {
  /// Splits the gradient at x. The direction, where not null, becomes φ, and its longest step is found.
  static SplitSums split(const MV& x, const MV& gradient, const FeasibleSet<MV>& feasible, double stepLength,
                         MV* direction, LocalActiveSet& active);

  /// All sums that a step along p needs. @param active of the iterate the gradient belongs to; empty: all
  /// entries are free.
  static CurvatureSums curvature(const MV& gradient, const MV& direction, const MV& image,
                                 const LocalActiveSet& active);

  /// Sums over all entries, in one pass and one reduction. z may be w.
  static ResidualSums residualSums(const MV& w, const MV& z, const MV& image, const MV& x);

  /// Of these sums the parts of this rank. Local.
  static CurvatureSums localCurvature(const MV& gradient, const MV& direction, const MV& image,
                                      const LocalActiveSet& active);
  static ResidualSums localResidualSums(const MV& w, const MV& z, const MV& image, const MV& x);

  /// x ← x − αp, g ← g − αHp, next ← φ(new) − βp, and the splitting at the new x, whose direction is `next`;
  /// one pass. `next` may be the direction itself. With toBoundary, entries that reach a bound are put
  /// exactly onto it; without, rounding may not carry them beyond it.
  static SplitSums advance(MV& x, MV& gradient, const MV& direction, const MV& image, double step,
                           double beta, bool toBoundary, const FeasibleSet<MV>& feasible, double stepLength,
                           MV& next, LocalActiveSet& active);

  /// p ← z − βp; the longest step of the new p.
  static double conjugate(const MV& x, const MV& z, double beta, const FeasibleSet<MV>& feasible,
                          MV& direction);

  /// p ← the chopped gradient; the longest step along it, which is zero where it leads along a rim.
  static double choppedDirection(const MV& x, const MV& gradient, const FeasibleSet<MV>& feasible,
                                 MV& direction);

  /// x_old ← x, x ← Π(x − αp). Local.
  static void projectedStep(MV& x, MV& xOld, const MV& direction, double step,
                            const FeasibleSet<MV>& feasible);

  static ChangeSums change(const MV& x, const MV& xOld, const MV& gradient, const MV& gradientOld);

  /// ‖g^P‖.
  static double projectedGradientNorm(const MV& x, const MV& gradient, const FeasibleSet<MV>& feasible);

  /// x ← Π(x), the projection onto the bounds. Local.
  static void project(MV& x, const FeasibleSet<MV>& feasible);

  /// Π smoothed over a width w (Chen, Mangasarian, Comput. Optim. Appl. 5, 1996): of a bound l what solves
  /// (x − l)(x − v) = w², of an interval l + p(v − l) − p(v − u), p(a) = ½(a + √(a² + 4w²)), within them.
  /// In a disc along the radius, with the interval from −r to r.
  /// @param slope receives dx/dv, in (0, 1]; 0 where l = u. In a disc that along the radius; what there is
  /// more along the tangent, up to x/v, is added to `rims`, as 1/(1 + κ). Local.
  static void projectSmoothly(const MV& v, const FeasibleSet<MV>& feasible, double width, MV& x, MV& slope,
                              std::vector<Slip>& rims);

  /// v_i ← w_iv_i. Local.
  static void multiply(const MV& w, MV& v);

  /// v_i ← 0 where the entry is active; slipping pairs keep their part along the tangent. Local.
  static void maskActive(MV& v, const LocalActiveSet& active);

  /// v_i ← −1, 0, 1 or 2, and back: an active set as a vector. An empty set comes back as one without active
  /// entries. Local.
  static void activeToVector(const LocalActiveSet& active, MV& v);
  static void vectorToActive(const MV& v, LocalActiveSet& active);

  /// y ← y + f κt(tᵀx) of slipping pairs; with fromCentre x − c in the place of x. Local.
  static void addCurvature(const LocalActiveSet& active, double f, const MV& x, bool fromCentre, MV& y);

  /// y ← y + f(κ) x at the entries of slipping pairs. Local.
  static void addAtSlips(const LocalActiveSet& active, const std::function<double(double)>& f, const MV& x,
                         MV& y);

  /// @param w along the tangents of slipping pairs, and at springs.
  static SlipSums slipSums(const LocalActiveSet& active, double q, const MV& w);

  /// Slipping pairs as vectors, and back: their normals; κ at their first entry and r at the second, which
  /// may be older than what the disc has. Local.
  static void slipsToVectors(const LocalActiveSet& active, MV& normals, MV& curvatures);
  static void vectorsToSlips(const FeasibleSet<MV>& feasible, const MV& normals, const MV& curvatures,
                             LocalActiveSet& active);

  /// x_i ← its bound where the entry is active, to the rim along its radius or to the tangent. Local.
  static void moveToBounds(MV& x, const FeasibleSet<MV>& feasible, const LocalActiveSet& active);

  /// The update of a primal-dual active set method: an active entry is freed where its multiplier has the
  /// wrong sign by more than gradientNoise, a free one becomes active where it violates its bound by more
  /// than xNoise. Entries with l = u stay active. A pair in a disc slips where z = x − c − αg lies outside,
  /// along the tangent at n = z/|z| and with κ = (|z| − r)/(αr): Newton's method for x = Π(x − αg), symmetric
  /// since the radius is given (Alart, Curnier, Comput. Methods Appl. Mech. Engrg. 92, 1991).
  /// @param set to be updated; sized here if empty.
  static ActiveSetChange updateActiveSet(const MV& x, const MV& gradient, const FeasibleSet<MV>& feasible,
                                         double xNoise, double gradientNoise, LocalActiveSet& set,
                                         const DiscUpdate& discs = {});

  /// Limits go where the solution is; see FollowingLimit. @param gradient null: zeros. @param upper null
  /// without intervals, discs null without discs. Local.
  static void follow(const MV& x, const MV* gradient, const FollowUpdate& how,
                     const std::vector<FollowingLimit>& limits, MV& lower, MV* upper, LocalDiscs* discs);

  /// After updateActiveSet(): what it means for limits that follow. An entry that is pushed against its limit
  /// stays there, wherever that has gone; else it is active where x − αg is beyond.
  /// @param before the set before that update.
  static FollowChange updateFollowing(const MV& x, const MV& gradient, const FeasibleSet<MV>& feasible,
                                      const std::vector<FollowingLimit>& limits, double stepLength,
                                      double gradientNoise, const LocalActiveSet& before,
                                      LocalActiveSet& set);

  /// y ← y + f x_k e at what follows. Local.
  static void addFollowing(const std::vector<FollowingEntry>& following, const MV& x, MV& y);

  /// x goes to where it follows; along tangents it stays. Local.
  static void moveToFollowing(const std::vector<FollowingEntry>& following, const MV& lower, MV& x);

  /// x goes to limits that follow: active entries, and pairs that slip along their radii. Local.
  static void moveToLimits(MV& x, const FeasibleSet<MV>& feasible, const std::vector<FollowingLimit>& limits,
                           const LocalActiveSet& active);

  /// The radii as a vector, each at the first entry it is of, and back. Local.
  static void limitsToVector(const std::vector<FollowingLimit>& limits, const FeasibleSet<MV>& feasible,
                             MV& radii);
  static void vectorToLimits(const std::vector<FollowingLimit>& limits, const MV& radii, MV& lower, MV* upper,
                             LocalDiscs* discs);

  /// Entries whose states differ. @param before empty: all do. @param like any vector of their length.
  static long long changed(const MV& like, const LocalActiveSet& before, const LocalActiveSet& set);

  /// x ← the nearest point with |x_i − c| ≤ f·(x_k − l_k) for all limits that follow, each with a source of
  /// its own, and within the bounds of the others. Local.
  static void projectOntoCones(MV& x, const FeasibleSet<MV>& feasible,
                               const std::vector<FollowingLimit>& limits);
  /// Infimum of wᵀx over these points; what falls without end counts in openNorm.
  static BoxInfimum coneInfimum(const MV& w, const FeasibleSet<MV>& feasible,
                                const std::vector<FollowingLimit>& limits);

  /// Bounds, discs and limits that follow. @param limits null: none. Local.
  static Kernels::SecondOrderCones conesOf(const FeasibleSet<MV>& feasible, const MV& like,
                                           const std::vector<FollowingLimit>* limits);

  static BoxInfimum boxInfimum(const MV& w, const FeasibleSet<MV>& feasible);

  /// d ← its projection onto the recession cone: d_i ≥ 0 where there is a lower bound, d_i ≤ 0 where there is
  /// an upper one, d_i = 0 in discs; returns the norm of what was taken away.
  static double projectOntoRecessionCone(MV& d, const FeasibleSet<MV>& feasible);

  /// Whether discs are those of vectors of this length on this rank. Local.
  static bool isFit(const MV& like, const LocalDiscs& discs);

  /// @param like any vector of the set.
  static BoundFault findBoundFault(const MV& like, const FeasibleSet<MV>& feasible);

  /// Pseudo-random entries in (−1, 1) that depend on the global index alone, not on the distribution. Local.
  static void setRandom(MV& x);

  /// Lends the entries of this rank. Local.
  static void read(const MV& v, const std::function<void(const double*)>& use);
  static void write(MV& v, const std::function<void(double*)>& use);
  /// Sums over the ranks that share the vector.
  static void sum(const MV& like, double* sums, int count);
  /// Whether soft bounds are those of vectors of this length on this rank. Local.
  static bool isFit(const MV& like, const LocalSoftBounds& bounds);

  /// The entries of this rank, and back. Local.
  static std::vector<double> localEntries(const MV& v);
  static void setLocalEntries(const std::vector<double>& entries, MV& v);

  /// All entries of a short vector, on every rank.
  static std::vector<double> gather(const MV& v);
  /// The inverse of gather(). Local.
  static void scatter(const std::vector<double>& values, MV& v);

  /// The largest of the ranks' numbers, over the ranks that share the vector.
  static double maximum(const MV& like, double value);
};

} // namespace Harmos::qp
