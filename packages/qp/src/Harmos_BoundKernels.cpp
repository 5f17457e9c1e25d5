// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundKernels.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::qp::Kernels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The presence of bounds is known at compile time, so that loops without them carry no trace of them.
template<bool hasLower, bool hasUpper>
struct Box {
  const double* l;
  const double* u;
  double lower(std::size_t i) const { return hasLower ? l[i] : -infinity; }
  double upper(std::size_t i) const { return hasUpper ? u[i] : infinity; }
};

template<class Pass>
auto withBox(Bounds bounds, Pass&& pass) {
  if (bounds.lower != nullptr)
    return bounds.upper != nullptr ? pass(Box<true, true>{bounds.lower, bounds.upper})
                                   : pass(Box<true, false>{bounds.lower, nullptr});
  return bounds.upper != nullptr ? pass(Box<false, true>{nullptr, bounds.upper})
                                 : pass(Box<false, false>{nullptr, nullptr});
}

// β_i of an entry at a bound; l = u leaves nothing to move.
double chopped(double x, double g, double l, double u) {
  if (x <= l)
    return x >= u ? 0.0 : std::min(g, 0.0);
  return std::max(g, 0.0);
}

double stepToBound(double x, double p, double l, double u) {
  if (p > 0.0)
    return (x - l) / p;
  if (p < 0.0)
    return (x - u) / p;
  return infinity;
}

// What split() and advance() have in common: one entry of the sums. Returns φ_i.
template<class AnyBox>
double splitEntry(const AnyBox& box, std::size_t i, double x, double g, double inverseStepLength,
                  signed char& active, bool fresh, SplitSums& sums) {
  const double l = box.lower(i), u = box.upper(i);
  if (x <= l || x >= u) {
    const signed char state = x <= l ? -1 : 1;
    const double beta = chopped(x, g, l, u);
    sums.choppedNorm2 += beta * beta;
    ++sums.active;
    if (fresh || active != state)
      ++sums.changed;
    active = state;
    return 0.0;
  }
  const double room = (g > 0.0 ? x - l : x - u) * inverseStepLength;
  const double reduced = g > 0.0 ? std::min(room, g) : std::max(room, g);
  sums.freeNorm2 += g * g;
  sums.reducedNorm2 += reduced * g;
  if (fresh || active != 0)
    ++sums.changed;
  active = 0;
  return g;
}

} // namespace

SplitSums split(std::size_t n, const double* x, const double* g, Bounds bounds, double stepLength,
                double* direction, signed char* active, bool fresh) {
  return withBox(bounds, [&](const auto& box) {
    SplitSums sums;
    const double inverse = 1.0 / stepLength;
    for (std::size_t i = 0; i < n; ++i) {
      const double phi = splitEntry(box, i, x[i], g[i], inverse, active[i], fresh, sums);
      if (direction != nullptr) {
        direction[i] = phi;
        sums.longestStep = std::min(sums.longestStep, stepToBound(x[i], phi, box.lower(i), box.upper(i)));
      }
    }
    return sums;
  });
}

CurvatureSums curvature(std::size_t n, const double* g, const double* p, const double* image,
                        const signed char* active) {
  CurvatureSums sums;
  for (std::size_t i = 0; i < n; ++i) {
    const double gi = g[i], pi = p[i], hi = image[i];
    const double free = active == nullptr || active[i] == 0 ? hi : 0.0;
    sums.gradientDotDirection += gi * pi;
    sums.directionDotImage += pi * hi;
    sums.directionNorm2 += pi * pi;
    sums.freeDotImage += gi * free;
    sums.freeImageNorm2 += free * free;
  }
  return sums;
}

SplitSums advance(std::size_t n, double* x, double* g, const double* p, const double* image, double step,
                  double beta, bool toBoundary, Bounds bounds, double stepLength, double* next,
                  signed char* active) {
  return withBox(bounds, [&](const auto& box) {
    SplitSums sums;
    const double inverse = 1.0 / stepLength;
    for (std::size_t i = 0; i < n; ++i) {
      const double l = box.lower(i), u = box.upper(i), pi = p[i];
      double xi = std::max(l, std::min(u, x[i] - step * pi));
      if (toBoundary && pi != 0.0 && stepToBound(x[i], pi, l, u) <= step)
        xi = pi > 0.0 ? l : u;
      const double gi = g[i] - step * image[i];
      x[i] = xi;
      g[i] = gi;
      const double phi = splitEntry(box, i, xi, gi, inverse, active[i], false, sums);
      const double direction = active[i] == 0 ? phi - beta * pi : 0.0;
      next[i] = direction;
      if (active[i] == 0)
        sums.longestStep = std::min(sums.longestStep, stepToBound(xi, direction, l, u));
    }
    return sums;
  });
}

double conjugate(std::size_t n, const double* x, const double* z, double beta, Bounds bounds, double* p) {
  return withBox(bounds, [&](const auto& box) {
    double longest = infinity;
    for (std::size_t i = 0; i < n; ++i) {
      p[i] = beta == 0.0 ? z[i] : z[i] - beta * p[i];
      longest = std::min(longest, stepToBound(x[i], p[i], box.lower(i), box.upper(i)));
    }
    return longest;
  });
}

double choppedDirection(std::size_t n, const double* x, const double* g, Bounds bounds, double* p) {
  return withBox(bounds, [&](const auto& box) {
    double longest = infinity;
    for (std::size_t i = 0; i < n; ++i) {
      const double l = box.lower(i), u = box.upper(i);
      p[i] = x[i] <= l || x[i] >= u ? chopped(x[i], g[i], l, u) : 0.0;
      longest = std::min(longest, stepToBound(x[i], p[i], l, u));
    }
    return longest;
  });
}

void projectedStep(std::size_t n, double* x, double* xOld, const double* p, double step, Bounds bounds) {
  withBox(bounds, [&](const auto& box) {
    for (std::size_t i = 0; i < n; ++i) {
      xOld[i] = x[i];
      x[i] = std::max(box.lower(i), std::min(box.upper(i), x[i] - step * p[i]));
    }
    return 0;
  });
}

ChangeSums change(std::size_t n, const double* x, const double* xOld, const double* g, const double* gOld) {
  ChangeSums sums;
  for (std::size_t i = 0; i < n; ++i) {
    const double moved = x[i] - xOld[i];
    sums.cost += 0.5 * moved * (g[i] + gOld[i]);
    sums.moved2 += moved * moved;
    sums.gradientNorm2 += gOld[i] * gOld[i];
  }
  return sums;
}

} // namespace Harmos::qp::Kernels
