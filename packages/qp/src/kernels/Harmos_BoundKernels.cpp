// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundKernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// The same source compiled for wider registers as well, chosen when the library is loaded: portable, and
// twice as fast where they are there. Not "fma": results are to differ by the order of sums at most.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define HARMOS_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define HARMOS_WIDE
#endif

namespace Harmos::qp::Kernels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Entries of a block: its work array stays in the first cache.
constexpr std::size_t block = 512;

// One entry's share of the sums, free of branches so that loops over it become vector instructions.
struct Entry {
  double phi;
  double chopped;
  double reduced;
  double state; // −1, 0, 1
};

inline __attribute__((always_inline)) Entry split(double x, double g, double l, double u, double inverse) {
  const bool atLower = x <= l, atUpper = x >= u;
  const double phi = atLower || atUpper ? 0.0 : g;
  // A gradient that is no number stays one.
  const double down = g > 0.0 ? 0.0 : g, up = g < 0.0 ? 0.0 : g;
  // l = u leaves nothing to move.
  const double chopped = atLower ? (atUpper ? 0.0 : down) : (atUpper ? up : 0.0);
  const double room = (phi > 0.0 ? x - l : x - u) * inverse;
  const double reduced = phi > 0.0 ? (room < phi ? room : phi) : (room > phi ? room : phi);
  return {phi, chopped, reduced, atLower ? -1.0 : (atUpper ? 1.0 : 0.0)};
}

// Step at which x − αp meets a bound.
inline __attribute__((always_inline)) double stepToBound(double x, double p, double l, double u) {
  const double step = (p > 0.0 ? x - l : x - u) / (p == 0.0 ? 1.0 : p);
  return p == 0.0 ? infinity : step;
}

// The least of a block's steps; what is no number is passed over. In lanes of its own: compilers that honour
// NaN see no minimum to reduce in a loop that has other sums, and would leave the whole loop as it stands.
inline __attribute__((always_inline)) double least(std::size_t n, const double* steps) {
  constexpr std::size_t lanes = 8;
  double lane[lanes];
  std::fill(lane, lane + lanes, infinity);
  const std::size_t whole = n - n % lanes;
  for (std::size_t i = 0; i < whole; i += lanes)
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k)
      lane[k] = steps[i + k] < lane[k] ? steps[i + k] : lane[k];
  for (std::size_t i = whole; i < n; ++i)
    lane[0] = std::min(lane[0], steps[i]);
  return *std::min_element(lane, lane + lanes);
}

// Takes over a block's states; returns how many have changed.
inline double storeStates(std::size_t n, const double* states, signed char* active, bool fresh) {
  int changed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto state = static_cast<signed char>(states[i]);
    changed += state != active[i];
    active[i] = state;
  }
  return fresh ? static_cast<double>(n) : changed;
}

// Absent bounds are infinite without being read: constants to the compiler.
template<bool hasLower, bool hasUpper>
struct Box {
  const double* l;
  const double* u;
  double lower(std::size_t i) const { return hasLower ? l[i] : -infinity; }
  double upper(std::size_t i) const { return hasUpper ? u[i] : infinity; }
};

// The loops proper are templates that are inlined into the functions compiled for each width.
template<class AnyBox>
inline __attribute__((always_inline)) SplitSums splitLoop(std::size_t n, const double* x, const double* g,
                                                          AnyBox box, double inverse, double* direction,
                                                          signed char* active, bool fresh) {
  SplitSums sums;
  double states[block], steps[block], changed = 0.0;
  for (std::size_t begin = 0; begin < n; begin += block) {
    const std::size_t end = std::min(n, begin + block);
    double free2 = 0.0, chopped2 = 0.0, reduced2 = 0.0, x2 = 0.0, count = 0.0;
#pragma omp simd reduction(+ : free2, chopped2, reduced2, x2, count)
    for (std::size_t i = begin; i < end; ++i) {
      const double l = box.lower(i), u = box.upper(i);
      const Entry entry = split(x[i], g[i], l, u, inverse);
      x2 += x[i] * x[i];
      free2 += entry.phi * entry.phi;
      chopped2 += entry.chopped * entry.chopped;
      reduced2 += entry.reduced * entry.phi;
      count += entry.state * entry.state;
      states[i - begin] = entry.state;
      steps[i - begin] = stepToBound(x[i], entry.phi, l, u);
    }
    if (direction != nullptr) {
#pragma omp simd
      for (std::size_t i = begin; i < end; ++i)
        direction[i] = states[i - begin] == 0.0 ? g[i] : 0.0;
      sums.longestStep = std::min(sums.longestStep, least(end - begin, steps));
    }
    sums.freeNorm2 += free2;
    sums.choppedNorm2 += chopped2;
    sums.reducedNorm2 += reduced2;
    sums.xNorm2 += x2;
    sums.active += static_cast<long long>(count);
    changed += storeStates(end - begin, states, active + begin, fresh);
  }
  sums.changed = static_cast<long long>(changed);
  return sums;
}

template<bool toBoundary, class AnyBox>
inline __attribute__((always_inline)) SplitSums
advanceLoop(std::size_t n, double* x, double* g, const double* p, const double* image, double step,
            double beta, AnyBox box, double inverse, double* next, signed char* active) {
  SplitSums sums;
  double states[block], steps[block], changed = 0.0;
  for (std::size_t begin = 0; begin < n; begin += block) {
    const std::size_t end = std::min(n, begin + block);
    double free2 = 0.0, chopped2 = 0.0, reduced2 = 0.0, x2 = 0.0, count = 0.0;
    // `next` may be p itself, entry by entry; nothing else overlaps.
#pragma omp simd reduction(+ : free2, chopped2, reduced2, x2, count)
    for (std::size_t i = begin; i < end; ++i) {
      const double l = box.lower(i), u = box.upper(i), pi = p[i];
      double xi = x[i] - step * pi;
      xi = xi < l ? l : (xi > u ? u : xi);
      if (toBoundary) {
        const bool meets = stepToBound(x[i], pi, l, u) <= step;
        xi = meets ? (pi > 0.0 ? l : u) : xi;
      }
      const double gi = g[i] - step * image[i];
      x[i] = xi;
      g[i] = gi;
      const Entry entry = split(xi, gi, l, u, inverse);
      x2 += xi * xi;
      free2 += entry.phi * entry.phi;
      chopped2 += entry.chopped * entry.chopped;
      reduced2 += entry.reduced * entry.phi;
      count += entry.state * entry.state;
      states[i - begin] = entry.state;
      const double direction = entry.state == 0.0 ? entry.phi - beta * pi : 0.0;
      next[i] = direction;
      steps[i - begin] = stepToBound(xi, direction, l, u);
    }
    sums.freeNorm2 += free2;
    sums.choppedNorm2 += chopped2;
    sums.reducedNorm2 += reduced2;
    sums.xNorm2 += x2;
    sums.active += static_cast<long long>(count);
    sums.longestStep = std::min(sums.longestStep, least(end - begin, steps));
    changed += storeStates(end - begin, states, active + begin, false);
  }
  sums.changed = static_cast<long long>(changed);
  return sums;
}

template<class Pass>
inline __attribute__((always_inline)) auto withBox(Bounds bounds, Pass&& pass) {
  if (bounds.lower != nullptr)
    return bounds.upper != nullptr ? pass(Box<true, true>{bounds.lower, bounds.upper})
                                   : pass(Box<true, false>{bounds.lower, nullptr});
  return bounds.upper != nullptr ? pass(Box<false, true>{nullptr, bounds.upper})
                                 : pass(Box<false, false>{nullptr, nullptr});
}

} // namespace

HARMOS_WIDE SplitSums split(std::size_t n, const double* x, const double* g, Bounds bounds, double stepLength,
                            double* direction, signed char* active, bool fresh) {
  return withBox(
      bounds, [&](auto box) __attribute__((always_inline)) {
        return splitLoop(n, x, g, box, 1.0 / stepLength, direction, active, fresh);
      });
}

HARMOS_WIDE ResidualSums residualSums(std::size_t n, const double* w, const double* z, const double* image,
                                      const double* x) {
  double residual = 0.0, product = 0.0, iterate = 0.0;
#pragma omp simd reduction(+ : residual, product, iterate)
  for (std::size_t i = 0; i < n; ++i) {
    residual += w[i] * w[i];
    product += z[i] * image[i];
    iterate += x[i] * x[i];
  }
  return {residual, product, iterate};
}

HARMOS_WIDE CurvatureSums curvature(std::size_t n, const double* g, const double* p, const double* image,
                                    const signed char* active) {
  CurvatureSums sums;
  double frees[block];
  std::fill(frees, frees + block, 1.0);
  for (std::size_t begin = 0; begin < n; begin += block) {
    const std::size_t end = std::min(n, begin + block);
    if (active != nullptr)
      for (std::size_t i = begin; i < end; ++i)
        frees[i - begin] = active[i] == 0 ? 1.0 : 0.0;
    double gp = 0.0, pq = 0.0, pp = 0.0, gq = 0.0, qq = 0.0;
#pragma omp simd reduction(+ : gp, pq, pp, gq, qq)
    for (std::size_t i = begin; i < end; ++i) {
      const double gi = g[i], pi = p[i], hi = image[i], free = frees[i - begin] * hi;
      gp += gi * pi;
      pq += pi * hi;
      pp += pi * pi;
      gq += gi * free;
      qq += free * free;
    }
    sums.gradientDotDirection += gp;
    sums.directionDotImage += pq;
    sums.directionNorm2 += pp;
    sums.freeDotImage += gq;
    sums.freeImageNorm2 += qq;
  }
  return sums;
}

HARMOS_WIDE SplitSums advance(std::size_t n, double* x, double* g, const double* p, const double* image,
                              double step, double beta, bool toBoundary, Bounds bounds, double stepLength,
                              double* next, signed char* active) {
  return withBox(
      bounds, [&](auto box) __attribute__((always_inline)) {
        return toBoundary
                   ? advanceLoop<true>(n, x, g, p, image, step, beta, box, 1.0 / stepLength, next, active)
                   : advanceLoop<false>(n, x, g, p, image, step, beta, box, 1.0 / stepLength, next, active);
      });
}

double conjugate(std::size_t n, const double* x, const double* z, double beta, Bounds bounds, double* p) {
  return withBox(bounds, [&](auto box) {
    double longest = infinity;
    for (std::size_t i = 0; i < n; ++i) {
      p[i] = beta == 0.0 ? z[i] : z[i] - beta * p[i];
      longest = std::min(longest, stepToBound(x[i], p[i], box.lower(i), box.upper(i)));
    }
    return longest;
  });
}

double choppedDirection(std::size_t n, const double* x, const double* g, Bounds bounds, double* p) {
  return withBox(bounds, [&](auto box) {
    double longest = infinity;
    for (std::size_t i = 0; i < n; ++i) {
      const double l = box.lower(i), u = box.upper(i);
      p[i] = split(x[i], g[i], l, u, 1.0).chopped;
      longest = std::min(longest, stepToBound(x[i], p[i], l, u));
    }
    return longest;
  });
}

void projectedStep(std::size_t n, double* x, double* xOld, const double* p, double step, Bounds bounds) {
  withBox(bounds, [&](auto box) {
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

namespace {

// p(a) = ½(a + √(a² + 4w²)), and its slope, without cancellation.
Smoothed positivePart(double a, double width) {
  const double root = std::hypot(a, 2.0 * width);
  if (a >= 0.0)
    return {0.5 * (a + root), 0.5 * (1.0 + a / root)};
  const double x = 2.0 * width * width / (root - a);
  return {x, x / root};
}

} // namespace

Smoothed projectSmoothly(double v, double lower, double upper, double width) {
  constexpr double open = 1e50;
  if (lower == upper)
    return {lower, 0.0};
  const bool hasLower = lower > -open, hasUpper = upper < open;
  if (!hasLower && !hasUpper)
    return {v, 1.0};
  if (!hasUpper) {
    const Smoothed above = positivePart(v - lower, width);
    return {lower + above.x, above.slope};
  }
  if (!hasLower) {
    const Smoothed below = positivePart(upper - v, width);
    return {upper - below.x, below.slope};
  }
  const double a = v - lower, b = v - upper, length = upper - lower, four = 4.0 * width * width;
  const double rootA = std::hypot(a, 2.0 * width), rootB = std::hypot(b, 2.0 * width);
  const double part = 0.5 * (1.0 + (a + b) / (rootA + rootB));
  const double sineA = a / rootA, sineB = b / rootB;
  const double slope =
      a * b > 0.0 ? 0.5 * four * length * ((a + b) / (rootA * rootA * rootB * rootB)) / (sineA + sineB)
                  : 0.5 * (sineA - sineB);
  return {std::clamp(lower + part * length, lower, upper), slope};
}

} // namespace Harmos::qp::Kernels
