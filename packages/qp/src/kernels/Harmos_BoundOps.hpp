// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundViews.hpp"
#include "Harmos_DiscKernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace Harmos::qp {

/// Vectors with bounds and discs, by the kernels over plain arrays: for every vector type with BoundTraits.
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
/// Guarded by tests/unit/qp/test_bound_ops.cpp; tests/unit/qp/test_serial_reference.cpp compares whole runs
/// with an unfused specialisation.
template<class Scalar, class MV>
struct BoundOps {
  using BT = BoundTraits<Scalar, MV>;
  using Set = FeasibleSet<MV>;
  using Box = BoxView<Scalar, MV>;

  /// Splits the gradient at x. The direction, where not null, becomes φ, and its longest step is found.
  static SplitSums split(const MV& x, const MV& gradient, const Set& feasible, double stepLength,
                         MV* direction, ActiveFace& active) {
    const std::size_t n = BT::length(x);
    const double *const xs = BT::read(x), *const gs = BT::read(gradient);
    double* const p = direction != nullptr ? BT::write(*direction) : nullptr;
    const Box box(feasible);
    const bool fresh = active.size() != n;
    if (fresh)
      active.assign(n, 0);
    SplitSums local;
    overOthers(feasible, n, [&](std::size_t k, std::size_t count) {
      add(Kernels::split(count, xs + k, gs + k, box.at(k), stepLength, p == nullptr ? nullptr : p + k,
                         active.data() + k, fresh),
          local);
    });
    Kernels::split(discsOf(feasible), xs, gs, stepLength, p, active.data(), fresh, local);
    return reduced(x, local);
  }

  /// All sums that a step along p needs. @param active of the iterate the gradient belongs to; empty: all
  /// entries are free.
  static CurvatureSums curvature(const MV& gradient, const MV& direction, const MV& image,
                                 const ActiveFace& active) {
    const CurvatureSums local = localCurvature(gradient, direction, image, active);
    double sums[] = {local.gradientDotDirection, local.directionDotImage, local.directionNorm2,
                     local.freeDotImage, local.freeImageNorm2};
    BT::sum(gradient, sums, 5);
    return {sums[0], sums[1], sums[2], sums[3], sums[4]};
  }

  /// Sums over all entries, in one pass and one reduction. z may be w.
  static ResidualSums residualSums(const MV& w, const MV& z, const MV& image, const MV& x) {
    const ResidualSums local = localResidualSums(w, z, image, x);
    double sums[] = {local.residualNorm2, local.preconditionedDotImage, local.iterateNorm2};
    BT::sum(w, sums, 3);
    return {sums[0], sums[1], sums[2]};
  }

  /// Of these sums the parts of this rank. Local.
  static CurvatureSums localCurvature(const MV& gradient, const MV& direction, const MV& image,
                                      const ActiveFace& active) {
    return Kernels::curvature(BT::length(gradient), BT::read(gradient), BT::read(direction), BT::read(image),
                              active.empty() ? nullptr : active.data());
  }
  static ResidualSums localResidualSums(const MV& w, const MV& z, const MV& image, const MV& x) {
    return Kernels::residualSums(BT::length(w), BT::read(w), BT::read(z), BT::read(image), BT::read(x));
  }

  /// x ← x − αp, g ← g − αHp, next ← φ(new) − βp, and the splitting at the new x, whose direction is `next`;
  /// one pass. `next` may be the direction itself. With toBoundary, entries that reach a bound are put
  /// exactly onto it; without, rounding may not carry them beyond it.
  static SplitSums advance(MV& x, MV& gradient, const MV& direction, const MV& image, double step,
                           double beta, bool toBoundary, const Set& feasible, double stepLength, MV& next,
                           ActiveFace& active) {
    double *const xs = BT::write(x), *const gs = BT::write(gradient), *const ns = BT::write(next);
    const double* const p = &direction == &next ? ns : BT::read(direction);
    const double* const hs = BT::read(image);
    const Box box(feasible);
    SplitSums local;
    overOthers(feasible, BT::length(x), [&](std::size_t k, std::size_t n) {
      add(Kernels::advance(n, xs + k, gs + k, p + k, hs + k, step, beta, toBoundary, box.at(k), stepLength,
                           ns + k, active.data() + k),
          local);
    });
    Kernels::advance(discsOf(feasible), xs, gs, p, hs, step, beta, stepLength, ns, active.data(), local);
    return reduced(x, local);
  }

  /// p ← z − βp; the longest step of the new p.
  static double conjugate(const MV& x, const MV& z, double beta, const Set& feasible, MV& direction) {
    const double *const xs = BT::read(x), *const zs = BT::read(z);
    double* const ps = BT::write(direction);
    const Box box(feasible);
    double longest = Kernels::conjugate(discsOf(feasible), xs, zs, beta, ps);
    overOthers(feasible, BT::length(x), [&](std::size_t k, std::size_t n) {
      longest = std::min(longest, Kernels::conjugate(n, xs + k, zs + k, beta, box.at(k), ps + k));
    });
    return least(x, longest);
  }

  /// p ← the chopped gradient; the longest step along it, which is zero where it leads along a rim.
  static double choppedDirection(const MV& x, const MV& gradient, const Set& feasible, MV& direction) {
    const double *const xs = BT::read(x), *const gs = BT::read(gradient);
    double* const ps = BT::write(direction);
    const Box box(feasible);
    double longest = Kernels::choppedDirection(discsOf(feasible), xs, gs, ps);
    overOthers(feasible, BT::length(x), [&](std::size_t k, std::size_t n) {
      longest = std::min(longest, Kernels::choppedDirection(n, xs + k, gs + k, box.at(k), ps + k));
    });
    return least(x, longest);
  }

  /// x_old ← x, x ← Π(x − αp). Local.
  static void projectedStep(MV& x, MV& xOld, const MV& direction, double step, const Set& feasible) {
    const double* const ps = BT::read(direction);
    double *const xs = BT::write(x), *const os = BT::write(xOld);
    const Box box(feasible);
    overOthers(feasible, BT::length(x), [&](std::size_t k, std::size_t n) {
      Kernels::projectedStep(n, xs + k, os + k, ps + k, step, box.at(k));
    });
    Kernels::projectedStep(discsOf(feasible), xs, os, ps, step);
  }

  static ChangeSums change(const MV& x, const MV& xOld, const MV& gradient, const MV& gradientOld) {
    const ChangeSums local = Kernels::change(BT::length(x), BT::read(x), BT::read(xOld), BT::read(gradient),
                                             BT::read(gradientOld));
    double sums[] = {local.cost, local.moved2, local.gradientNorm2};
    BT::sum(x, sums, 3);
    return {sums[0], sums[1], sums[2]};
  }

  /// ‖g^P‖.
  static double projectedGradientNorm(const MV& x, const MV& gradient, const Set& feasible) {
    ActiveFace active;
    return std::sqrt(split(x, gradient, feasible, 1.0, nullptr, active).projectedNorm2());
  }

  /// x ← Π(x), the projection onto the set. Local.
  static void project(MV& x, const Set& feasible) {
    if (feasible.isEverything())
      return;
    double* const xs = BT::write(x);
    clamp(feasible, BT::length(x), xs);
    Kernels::project(discsOf(feasible), xs);
  }

  /// x ← its projection onto the bounds, discs left alone. Local.
  static void clamp(const Set& feasible, std::size_t n, double* xs) {
    if (feasible.anyBound() == nullptr)
      return;
    const Box box(feasible);
    overOthers(feasible, n, [&](std::size_t k, std::size_t count) {
      for (std::size_t i = k; i < k + count; ++i)
        xs[i] = std::max(box.lower(i), std::min(box.upper(i), xs[i]));
    });
  }

  /// Π smoothed over a width w (Chen, Mangasarian, Comput. Optim. Appl. 5, 1996): of a bound l what solves
  /// (x − l)(x − v) = w², of an interval l + p(v − l) − p(v − u), p(a) = ½(a + √(a² + 4w²)), within them.
  /// In a disc along the radius, with the interval from −r to r.
  /// @param slope receives dx/dv, in (0, 1]; 0 where l = u. In a disc that along the radius; what there is
  /// more along the tangent, up to x/v, is added to `rims`, as 1/(1 + κ). Local.
  static void projectSmoothly(const MV& v, const Set& feasible, double width, MV& x, MV& slope,
                              std::vector<Slip>& rims) {
    const std::size_t n = BT::length(x);
    double *const xs = BT::write(x), *const slopes = BT::write(slope);
    std::copy_n(BT::read(v), n, xs);
    std::fill_n(slopes, n, 1.0);
    rims.clear();
    Kernels::projectSmoothly(discsOf(feasible), width, xs, slopes, rims);
    if (feasible.anyBound() == nullptr)
      return;
    const Box box(feasible);
    overOthers(feasible, n, [&](std::size_t k, std::size_t count) {
      for (std::size_t i = k; i < k + count; ++i) {
        const Kernels::Smoothed smoothed = Kernels::projectSmoothly(xs[i], box.lower(i), box.upper(i), width);
        xs[i] = smoothed.x;
        slopes[i] = smoothed.slope;
      }
    });
  }

  /// v_i ← w_iv_i. Local.
  static void multiply(const MV& w, MV& v) {
    const double* const ws = BT::read(w);
    double* const vs = BT::write(v);
    for (std::size_t i = 0; i < BT::length(v); ++i)
      vs[i] *= ws[i];
  }

  /// Infimum of wᵀx over the set.
  static BoxInfimum boxInfimum(const MV& w, const Set& feasible) {
    return boxInfimum(w, BT::read(w), feasible);
  }
  /// The same of other entries. @param like of their length.
  static BoxInfimum boxInfimum(const MV& like, const double* w, const Set& feasible) {
    const Box box(feasible);
    double sums[3] = {0, 0, 0};
    overOthers(feasible, BT::length(like), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i) {
        if (w[i] == 0.0)
          continue;
        const double corner = w[i] > 0.0 ? box.lower(i) : box.upper(i);
        if (std::isinf(corner)) {
          sums[1] += w[i] * w[i];
        } else {
          sums[0] += w[i] * corner;
          sums[2] += corner * corner;
        }
      }
    });
    Kernels::addInfimum(discsOf(feasible), w, sums[0], sums[2]);
    BT::sum(like, sums, 3);
    return {sums[0], std::sqrt(sums[1]), std::sqrt(sums[2])};
  }

  /// Whether discs or soft bounds are those of vectors of this length on this rank. Local.
  template<class LocalConditions>
  static bool isFit(const MV& like, const LocalConditions& conditions) {
    return conditions.length() == BT::length(like);
  }

  /// @param like any vector of the set.
  static BoundFault findBoundFault(const MV& like, const Set& feasible) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (feasible.isEverything())
      return {};
    const Box box(feasible);
    double first = none, l = 0.0, u = 0.0;
    const auto report = [&](std::size_t i, double lower, double upper) {
      const auto entry = static_cast<double>(BT::globalIndex(like, i));
      if (entry >= first)
        return;
      first = entry;
      l = lower;
      u = upper;
    };
    overOthers(feasible, BT::length(like), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i)
        if (!(box.lower(i) <= box.upper(i)) || box.lower(i) == none || box.upper(i) == -none)
          return report(i, box.lower(i), box.upper(i));
    });
    for (const Disc& disc : discsOf(feasible)) {
      const auto hasBound = [&](int entry) {
        const auto i = static_cast<std::size_t>(entry);
        return box.lower(i) != -none || box.upper(i) != none;
      };
      const bool isSound = std::isfinite(disc.radius) && std::isfinite(disc.centre[0]) &&
                           std::isfinite(disc.centre[1]) && !hasBound(disc.first) && !hasBound(disc.second);
      if (!isSound || disc.radius < 0.0)
        report(static_cast<std::size_t>(std::min(disc.first, disc.second)),
               isSound ? -disc.radius : std::numeric_limits<double>::quiet_NaN(), disc.radius);
    }
    const double found = least(like, first);
    if (found == none)
      return {};
    double values[] = {first == found ? l : 0.0, first == found ? u : 0.0};
    BT::sum(like, values, 2);
    return {true, static_cast<long long>(found), values[0], values[1]};
  }

  /// Pseudo-random entries in (−1, 1) that depend on the global index alone, not on the distribution. Local.
  static void setRandom(MV& x) {
    double* const xs = BT::write(x);
    for (std::size_t i = 0; i < BT::length(x); ++i)
      xs[i] = 2.0 * static_cast<double>(mix(static_cast<std::uint64_t>(BT::globalIndex(x, i))) >> 11) *
                  0x1.0p-53 -
              1.0;
  }

  /// The entries of this rank, and back. Local.
  static std::vector<double> localEntries(const MV& v) {
    const double* const entries = BT::read(v);
    return {entries, entries + BT::length(v)};
  }
  static void setLocalEntries(const std::vector<double>& entries, MV& v) {
    std::copy(entries.begin(), entries.end(), BT::write(v));
  }

 private:
  static void add(const SplitSums& part, SplitSums& sums) {
    sums.freeNorm2 += part.freeNorm2;
    sums.choppedNorm2 += part.choppedNorm2;
    sums.reducedNorm2 += part.reducedNorm2;
    sums.xNorm2 += part.xNorm2;
    sums.active += part.active;
    sums.changed += part.changed;
    sums.longestStep = std::min(sums.longestStep, part.longestStep);
  }
  static SplitSums reduced(const MV& x, SplitSums local) {
    double sums[] = {local.freeNorm2,
                     local.choppedNorm2,
                     local.reducedNorm2,
                     local.xNorm2,
                     static_cast<double>(local.active),
                     static_cast<double>(local.changed)};
    BT::sumAndMin(x, sums, 6, local.longestStep);
    return {sums[0],
            sums[1],
            sums[2],
            sums[3],
            static_cast<long long>(sums[4]),
            static_cast<long long>(sums[5]),
            local.longestStep};
  }
  static double least(const MV& x, double value) {
    BT::sumAndMin(x, nullptr, 0, value);
    return value;
  }
};

} // namespace Harmos::qp
