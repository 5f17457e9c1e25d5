// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A serial vector and operator for the QP layer, as plain as can be: each function of BoundOps and
/// of faces is written from its definition, in passes of its own. Whole runs with it are the reference
/// for the fused Tpetra kernels, and the proof that the layer works on types it has never heard of.

#include "Harmos_BoundOps.hpp"
#include "Harmos_DiscKernels.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_SerialVector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace Harmos::qp {

template<>
struct BoundTraits<double, SerialVector> {
  using V = SerialVector;
  static std::size_t length(const V& v) { return v().size(); }
  static const double* read(const V& v) { return v().data(); }
  static double* write(V& v) { return v().data(); }
  static long long globalIndex(const V&, std::size_t entry) { return static_cast<long long>(entry); }
  static void sum(const V&, double*, int) {}
  static void sumAndMin(const V&, double*, int, double&) {}
  static double maximum(const V&, double value) { return value; }
  static std::vector<double> gather(const V& v) { return v(); }
  static void scatter(const std::vector<double>& values, V& v) { v() = values; }
};

// Sets from their definitions.
struct SerialSets {
  using V = SerialVector;
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  using Set = FeasibleSet<V>;

  static const Disc* discOf(const Set& feasible, std::size_t i) {
    if (feasible.hasDiscs())
      for (const Disc& disc : feasible.discs->discs())
        if (disc.first == static_cast<int>(i) || disc.second == static_cast<int>(i))
          return &disc;
    return nullptr;
  }
  static double lowerOf(const Set& feasible, std::size_t i) {
    return feasible.lower == nullptr || discOf(feasible, i) != nullptr ? -infinity : (*feasible.lower)()[i];
  }
  static double upperOf(const Set& feasible, std::size_t i) {
    return feasible.upper == nullptr || discOf(feasible, i) != nullptr ? infinity : (*feasible.upper)()[i];
  }
  static std::size_t place(int entry) { return static_cast<std::size_t>(entry); }
  // Of a disc: x − c, and any vector.
  static std::array<double, 2> arm(const V& x, const Disc& disc) {
    return {x()[place(disc.first)] - disc.centre[0], x()[place(disc.second)] - disc.centre[1]};
  }
  static std::array<double, 2> pairOf(const V& v, const Disc& disc) {
    return {v()[place(disc.first)], v()[place(disc.second)]};
  }
  static double rounding(const Disc& disc) {
    return 8.0 * std::numeric_limits<double>::epsilon() *
           (disc.radius + std::abs(disc.centre[0]) + std::abs(disc.centre[1]));
  }
  static bool isOnRim(const V& x, const Disc& disc) {
    const auto y = arm(x, disc);
    return std::hypot(y[0], y[1]) >= disc.radius - rounding(disc);
  }
  // The chopped gradient's entry i, of the two of a disc.
  static double rimBeta(const V& x, const V& g, std::size_t i, const Disc& disc) {
    const auto y = arm(x, disc), gradient = pairOf(g, disc);
    const double length = std::hypot(y[0], y[1]);
    const std::size_t k = place(disc.first) == i ? 0 : 1;
    if (!isOnRim(x, disc) || length == 0.0)
      return 0.0;
    const double outwards = (y[0] * gradient[0] + y[1] * gradient[1]) / length;
    return outwards >= 0.0 ? gradient[k] : gradient[k] - outwards * y[k] / length;
  }
  // By bisection: how far x − αp stays inside.
  static double chord(const V& x, const V& p, const Disc& disc) {
    const auto y = arm(x, disc), along = pairOf(p, disc);
    const double speed = std::hypot(along[0], along[1]);
    if (speed == 0.0)
      return infinity;
    const auto isInside = [&](double a) {
      return std::hypot(y[0] - a * along[0], y[1] - a * along[1]) <= disc.radius;
    };
    double inside = 0.0, outside = 3.0 * disc.radius / speed;
    for (int k = 0; k < 200; ++k) {
      const double middle = 0.5 * (inside + outside);
      (isInside(middle) ? inside : outside) = middle;
    }
    return inside;
  }
  static bool isActive(const V& x, std::size_t i, const Set& feasible) {
    if (const Disc* disc = discOf(feasible, i))
      return isOnRim(x, *disc);
    return x()[i] <= lowerOf(feasible, i) || x()[i] >= upperOf(feasible, i);
  }
  static double phi(const V& x, const V& g, std::size_t i, const Set& feasible) {
    return isActive(x, i, feasible) ? 0.0 : g()[i];
  }
  static double beta(const V& x, const V& g, std::size_t i, const Set& feasible) {
    if (const Disc* disc = discOf(feasible, i))
      return rimBeta(x, g, i, *disc);
    if (lowerOf(feasible, i) == upperOf(feasible, i) || !isActive(x, i, feasible))
      return 0.0;
    return x()[i] <= lowerOf(feasible, i) ? std::min(g()[i], 0.0) : std::max(g()[i], 0.0);
  }
  static double longestStep(const V& x, const V& p, const Set& feasible) {
    double step = infinity;
    for (std::size_t i = 0; i < x().size(); ++i) {
      if (p()[i] > 0.0)
        step = std::min(step, (x()[i] - lowerOf(feasible, i)) / p()[i]);
      if (p()[i] < 0.0)
        step = std::min(step, (x()[i] - upperOf(feasible, i)) / p()[i]);
    }
    if (feasible.hasDiscs())
      for (const Disc& disc : feasible.discs->discs())
        step = std::min(step, chord(x, p, disc));
    return step;
  }

  static void moveToRim(V& x, const Disc& disc) {
    const auto y = arm(x, disc);
    const double factor = disc.radius / std::hypot(y[0], y[1]);
    x()[place(disc.first)] = disc.centre[0] + factor * y[0];
    x()[place(disc.second)] = disc.centre[1] + factor * y[1];
  }
};

template<>
struct BoundOps<double, SerialVector> : SerialSets {
  static SplitSums split(const V& x, const V& g, const Set& feasible, double stepLength, V* direction,
                         ActiveFace& active) {
    SplitSums sums;
    const bool fresh = active.size() != x().size();
    active.resize(x().size(), 0);
    for (std::size_t i = 0; i < x().size(); ++i) {
      const double f = phi(x, g, i, feasible), b = beta(x, g, i, feasible);
      sums.freeNorm2 += f * f;
      sums.xNorm2 += x()[i] * x()[i];
      sums.choppedNorm2 += b * b;
      if (const Disc* disc = discOf(feasible, i); disc != nullptr && f != 0.0) {
        const auto y = arm(x, *disc), gradient = pairOf(g, *disc);
        const double to[] = {y[0] - stepLength * gradient[0], y[1] - stepLength * gradient[1]};
        const double factor = std::min(1.0, disc->radius / std::hypot(to[0], to[1]));
        const std::size_t k = place(disc->first) == i ? 0 : 1;
        sums.reducedNorm2 += (y[k] - factor * to[k]) / stepLength * f;
      } else if (f > 0.0)
        sums.reducedNorm2 += std::min((x()[i] - lowerOf(feasible, i)) / stepLength, f) * f;
      else if (f < 0.0)
        sums.reducedNorm2 += std::max((x()[i] - upperOf(feasible, i)) / stepLength, f) * f;
      const signed char state = !isActive(x, i, feasible)        ? 0
                                : discOf(feasible, i) != nullptr ? 2
                                : x()[i] <= lowerOf(feasible, i) ? -1
                                                                 : 1;
      sums.active += state != 0;
      sums.changed += fresh || state != active[i];
      active[i] = state;
      if (direction != nullptr)
        (*direction)()[i] = f;
    }
    if (direction != nullptr)
      sums.longestStep = longestStep(x, *direction, feasible);
    return sums;
  }
  static ResidualSums residualSums(const V& w, const V& z, const V& image, const V& x) {
    ResidualSums sums;
    for (std::size_t i = 0; i < w.columns[0].size(); ++i) {
      sums.residualNorm2 += w.columns[0][i] * w.columns[0][i];
      sums.preconditionedDotImage += z.columns[0][i] * image.columns[0][i];
      sums.iterateNorm2 += x.columns[0][i] * x.columns[0][i];
    }
    return sums;
  }
  static CurvatureSums curvature(const V& g, const V& p, const V& image, const ActiveFace& active) {
    CurvatureSums sums;
    for (std::size_t i = 0; i < g().size(); ++i) {
      sums.gradientDotDirection += g()[i] * p()[i];
      sums.directionDotImage += p()[i] * image()[i];
      sums.directionNorm2 += p()[i] * p()[i];
      if (active.empty() || active[i] == 0) {
        sums.freeDotImage += g()[i] * image()[i];
        sums.freeImageNorm2 += image()[i] * image()[i];
      }
    }
    return sums;
  }
  static ResidualSums localResidualSums(const V& w, const V& z, const V& image, const V& x) {
    return residualSums(w, z, image, x);
  }
  static CurvatureSums localCurvature(const V& g, const V& p, const V& image, const ActiveFace& active) {
    return curvature(g, p, image, active);
  }
  static SplitSums advance(V& x, V& g, const V& p, const V& image, double step, double factor,
                           bool toBoundary, const Set& feasible, double stepLength, V& next,
                           ActiveFace& active) {
    const V direction = p;
    for (std::size_t i = 0; i < x().size(); ++i) {
      V one(std::vector<double>{x()[i]}), along(std::vector<double>{direction()[i]});
      const V l(std::vector<double>{lowerOf(feasible, i)}), u(std::vector<double>{upperOf(feasible, i)});
      const bool meets = direction()[i] != 0.0 && longestStep(one, along, Set{&l, &u, nullptr}) <= step;
      x()[i] -= step * direction()[i];
      if (toBoundary && meets)
        x()[i] = direction()[i] > 0.0 ? l()[0] : u()[0];
      g()[i] -= step * image()[i];
    }
    project(x, feasible);
    SplitSums sums = split(x, g, feasible, stepLength, &next, active);
    for (std::size_t i = 0; i < x().size(); ++i)
      if (active[i] == 0)
        next()[i] -= factor * direction()[i];
    sums.longestStep = longestStep(x, next, feasible);
    return sums;
  }
  static double conjugate(const V& x, const V& z, double factor, const Set& feasible, V& p) {
    for (std::size_t i = 0; i < x().size(); ++i)
      p()[i] = factor == 0.0 ? z()[i] : z()[i] - factor * p()[i];
    return longestStep(x, p, feasible);
  }
  static double choppedDirection(const V& x, const V& g, const Set& feasible, V& p) {
    for (std::size_t i = 0; i < x().size(); ++i)
      p()[i] = beta(x, g, i, feasible);
    return longestStep(x, p, feasible);
  }
  static void projectedStep(V& x, V& xOld, const V& p, double step, const Set& feasible) {
    xOld = x;
    for (std::size_t i = 0; i < x().size(); ++i)
      x()[i] -= step * p()[i];
    project(x, feasible);
  }
  static ChangeSums change(const V& x, const V& xOld, const V& g, const V& gOld) {
    ChangeSums sums;
    for (std::size_t i = 0; i < x().size(); ++i) {
      sums.cost += 0.5 * (x()[i] - xOld()[i]) * (g()[i] + gOld()[i]);
      sums.moved2 += std::pow(x()[i] - xOld()[i], 2);
      sums.gradientNorm2 += gOld()[i] * gOld()[i];
    }
    return sums;
  }
  static double projectedGradientNorm(const V& x, const V& g, const Set& feasible) {
    double sum = 0.0;
    for (std::size_t i = 0; i < x().size(); ++i)
      sum += std::pow(phi(x, g, i, feasible) + beta(x, g, i, feasible), 2);
    return std::sqrt(sum);
  }
  static void multiply(const V& w, V& v) {
    for (std::size_t i = 0; i < v().size(); ++i)
      v()[i] *= w()[i];
  }

  static void projectSmoothly(const V& v, const Set& feasible, double width, V& x, V& slope,
                              std::vector<Slip>& rims) {
    rims.clear();
    for (std::size_t i = 0; i < v().size(); ++i) {
      const auto smoothed =
          Kernels::projectSmoothly(v()[i], lowerOf(feasible, i), upperOf(feasible, i), width);
      x()[i] = smoothed.x;
      slope()[i] = smoothed.slope;
    }
    if (feasible.hasDiscs())
      Kernels::projectSmoothly(feasible.discs->discs(), width, x().data(), slope().data(), rims);
  }

  static void project(V& x, const Set& feasible) {
    for (std::size_t i = 0; i < x().size(); ++i)
      x()[i] = std::max(lowerOf(feasible, i), std::min(upperOf(feasible, i), x()[i]));
    if (feasible.hasDiscs())
      for (const Disc& disc : feasible.discs->discs())
        if (const auto y = arm(x, disc); std::hypot(y[0], y[1]) > disc.radius + rounding(disc))
          moveToRim(x, disc);
  }
  static BoxInfimum boxInfimum(const V& like, const double* entries, const Set& feasible) {
    return boxInfimum(V(std::vector<double>(entries, entries + like().size())), feasible);
  }
  static BoxInfimum boxInfimum(const V& w, const Set& feasible) {
    BoxInfimum result;
    for (std::size_t i = 0; i < w().size(); ++i) {
      if (const Disc* disc = discOf(feasible, i)) {
        const auto along = pairOf(w, *disc);
        const std::size_t k = place(disc->first) == i ? 0 : 1;
        const double length = std::hypot(along[0], along[1]);
        const double rim = disc->centre[k] - (length > 0.0 ? disc->radius * along[k] / length : 0.0);
        result.value += w()[i] * rim;
        result.boundNorm = std::hypot(result.boundNorm, rim);
        continue;
      }
      if (w()[i] == 0.0)
        continue;
      const double corner = w()[i] > 0.0 ? lowerOf(feasible, i) : upperOf(feasible, i);
      if (std::isinf(corner)) {
        result.openNorm = std::hypot(result.openNorm, w()[i]);
      } else {
        result.value += w()[i] * corner;
        result.boundNorm = std::hypot(result.boundNorm, corner);
      }
    }
    return result;
  }
  static BoundFault findBoundFault(const V& like, const Set& feasible) {
    for (std::size_t i = 0; i < like().size(); ++i) {
      if (const Disc* disc = discOf(feasible, i); disc != nullptr && !(disc->radius >= 0.0))
        return {true, static_cast<long long>(i), -disc->radius, disc->radius};
      const double l = lowerOf(feasible, i), u = upperOf(feasible, i);
      if (!(l <= u) || l == infinity || u == -infinity)
        return {true, static_cast<long long>(i), l, u};
    }
    return {};
  }
  static void setRandom(V& x) {
    // The start vector of a norm estimate: the same entries as Tpetra's, so that runs can be compared.
    for (std::size_t i = 0; i < x().size(); ++i) {
      std::uint64_t z = i + 0x9e3779b97f4a7c15ULL;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
      x()[i] = 2.0 * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53 - 1.0;
    }
  }

  // What projects onto cones of limits that follow, by the kernels of plain arrays.
  static void clamp(const Set& feasible, std::size_t n, double* x) {
    for (std::size_t i = 0; i < n; ++i)
      x[i] = std::max(lowerOf(feasible, i), std::min(upperOf(feasible, i), x[i]));
  }
  static std::vector<double> localEntries(const V& v) { return v(); }
  static void setLocalEntries(const std::vector<double>& entries, V& v) { v() = entries; }
};

// Faces from their definitions: the reference for blocks.
struct SerialFaces : SerialSets {
  static double recede(V& d, const Set& feasible) {
    double removed = 0.0;
    for (std::size_t i = 0; i < d().size(); ++i)
      if (discOf(feasible, i) != nullptr || (d()[i] < 0.0 && lowerOf(feasible, i) > -infinity) ||
          (d()[i] > 0.0 && upperOf(feasible, i) < infinity)) {
        removed = std::hypot(removed, d()[i]);
        d()[i] = 0.0;
      }
    return removed;
  }
  static void mask(V& v, const ActiveFace& active) {
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i] != 0 && active[i] != ActiveFace::slips)
        v()[i] = 0.0;
    for (const Slip& slip : active.slipping) {
      double& a = v()[place(slip.first)];
      double& b = v()[place(slip.second)];
      const double outwards = a * slip.normal[0] + b * slip.normal[1];
      a -= outwards * slip.normal[0];
      b -= outwards * slip.normal[1];
    }
  }
  static SlipSums slipSums(const ActiveFace& active, double q, const V& w) {
    SlipSums sums;
    for (const Slip& slip : active.slipping) {
      const double along =
          -slip.normal[1] * w()[place(slip.first)] + slip.normal[0] * w()[place(slip.second)];
      sums.along2 += along * along;
      sums.softened2 += std::pow(q / (q + slip.curvature) * along, 2);
      sums.rims2 += std::pow((q + slip.curvature) * slip.radius, 2);
    }
    for (const Spring& spring : active.springs) {
      const double entry = w()[place(spring.entry)];
      sums.springs2 += entry * entry;
      sums.softenedSprings2 += std::pow(q / (q + spring.curvature) * entry, 2);
    }
    return sums;
  }
  static void addAtSlips(const ActiveFace& active, const std::function<double(double)>& f, const V& x, V& y) {
    for (const Slip& slip : active.slipping)
      for (int entry : {slip.first, slip.second})
        y()[place(entry)] += f(slip.curvature) * x()[place(entry)];
  }
  static void addCurvature(const ActiveFace& active, double f, const V& x, bool fromCentre, V& y) {
    for (const Slip& slip : active.slipping) {
      const double t[] = {-slip.normal[1], slip.normal[0]};
      double along = t[0] * x()[place(slip.first)] + t[1] * x()[place(slip.second)];
      if (fromCentre)
        along -= t[0] * slip.centre[0] + t[1] * slip.centre[1];
      y()[place(slip.first)] += f * slip.curvature * along * t[0];
      y()[place(slip.second)] += f * slip.curvature * along * t[1];
    }
  }
  static void moveToFace(V& x, const Set& feasible, const ActiveFace& active) {
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i] == -1 || active[i] == 1)
        x()[i] = active[i] < 0 ? lowerOf(feasible, i) : upperOf(feasible, i);
      else if (const Disc* disc = active[i] == 2 ? discOf(feasible, i) : nullptr;
               disc != nullptr && !isOnRim(x, *disc))
        moveToRim(x, *disc);
    for (const Slip& slip : active.slipping) {
      const double outwards = (x()[place(slip.first)] - slip.centre[0]) * slip.normal[0] +
                              (x()[place(slip.second)] - slip.centre[1]) * slip.normal[1];
      x()[place(slip.first)] += (slip.radius - outwards) * slip.normal[0];
      x()[place(slip.second)] += (slip.radius - outwards) * slip.normal[1];
    }
  }
  static FaceChange update(const V& x, const V& g, const Set& feasible, const FaceUpdate& how,
                           ActiveFace& set) {
    FaceChange result;
    set.resize(x().size(), 0);
    for (std::size_t i = 0; i < x().size(); ++i) {
      if (discOf(feasible, i) != nullptr)
        continue;
      const double l = lowerOf(feasible, i), u = upperOf(feasible, i);
      const signed char before = set[i];
      const double wrong = before < 0 ? std::max(-g()[i], 0.0) : before > 0 ? std::max(g()[i], 0.0) : 0.0;
      if (l == u) {
        set[i] = -1;
      } else if (before != 0) {
        result.wrongSign2 += wrong * wrong;
        if (wrong > how.gradientNoise)
          set[i] = 0;
      } else {
        const double below = std::max(l - x()[i], 0.0), above = std::max(x()[i] - u, 0.0);
        result.violation2 += below * below + above * above;
        if (below > how.xNoise)
          set[i] = -1;
        else if (above > how.xNoise)
          set[i] = 1;
      }
      result.changed += set[i] != before;
      result.active += set[i] != 0;
      if (set[i] != 0) {
        std::mt19937 random(static_cast<unsigned>(2 * i) + (set[i] < 0 ? 0U : 1U));
        result.signature[0] += static_cast<double>(random());
        result.signature[1] += static_cast<double>(random());
      }
    }
    const std::vector<Slip> before = set.slipping;
    set.slipping.clear();
    if (feasible.hasDiscs())
      for (const Disc& disc : feasible.discs->discs())
        updateDisc(x, g, disc, how, before, set, result);
    result.slips = static_cast<long long>(set.slipping.size());
    return result;
  }
  static void updateDisc(const V& x, const V& g, const Disc& disc, const FaceUpdate& how,
                         const std::vector<Slip>& before, ActiveFace& set, FaceChange& result) {
    const auto y = arm(x, disc), gradient = pairOf(g, disc);
    const double z[] = {y[0] - how.stepLength * gradient[0], y[1] - how.stepLength * gradient[1]};
    const double reach = std::hypot(z[0], z[1]), length = std::hypot(y[0], y[1]);
    const double beyond = std::max(length - disc.radius, 0.0);
    signed char& state = set[place(disc.first)];
    const signed char was = state;
    const auto last = std::find_if(before.begin(), before.end(),
                                   [&](const Slip& slip) { return slip.first == disc.first; });
    state = disc.radius <= rounding(disc)                                ? 2
            : reach > disc.radius + std::max(how.xNoise, rounding(disc)) ? 3
                                                                         : 0;
    set[place(disc.second)] = state;
    result.violation2 += beyond * beyond;
    bool isChanged = state != was;
    if (state == 3 || was == 3) {
      const double outwards = (y[0] * gradient[0] + y[1] * gradient[1]) / length;
      const double taken = std::min(outwards, 0.0);
      const double wrong =
          std::hypot(gradient[0] - taken * y[0] / length, gradient[1] - taken * y[1] / length);
      result.wrongSign2 += wrong * wrong;
      const double noise = std::max(how.gradientNoise, how.turn);
      const bool hasTurned = wrong > noise || (beyond > how.xNoise && beyond > how.stepLength * noise);
      isChanged = isChanged || hasTurned;
      if (state == 3 && was == 3 && !hasTurned)
        set.slipping.push_back(*last);
      else if (state == 3)
        set.slipping.push_back(
            {disc.first,
             disc.second,
             {disc.centre[0], disc.centre[1]},
             disc.radius,
             {z[0] / reach, z[1] / reach},
             how.stepLength > 0.0 ? (reach - disc.radius) / (how.stepLength * disc.radius) : 0.0});
    }
    result.changed += isChanged;
    result.active += state != 0 ? 2 : 0;
    if (state == 3) {
      result.signature[0] += set.slipping.back().normal[0] * (1.0 + disc.first);
      result.signature[1] += set.slipping.back().normal[1] * (1.0 + disc.first);
    }
  }
};

} // namespace Harmos::qp
