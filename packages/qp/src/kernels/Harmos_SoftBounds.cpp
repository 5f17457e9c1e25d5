// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SoftBounds.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

LocalSoftBounds::LocalSoftBounds(std::vector<SoftBound> bounds, std::size_t length)
    : bounds_(std::move(bounds)), length_(length) {
  std::sort(bounds_.begin(), bounds_.end(),
            [](const SoftBound& a, const SoftBound& b) { return a.entry < b.entry; });
  int last = -1;
  for (const SoftBound& bound : bounds_) {
    HARMOS_REQUIRE(bound.entry > last && static_cast<std::size_t>(bound.entry) < length,
                   "entries of soft bounds are local indices, each given once");
    last = bound.entry;
  }
}

namespace Kernels {
namespace {

std::size_t place(int entry) {
  return static_cast<std::size_t>(entry);
}

// Which end a spring is at: −1, 1; 0 without a spring.
int sideOf(const SoftBound& bound, const Spring* spring) {
  return spring == nullptr ? 0 : spring->centre == bound.lower ? -1 : 1;
}

// Of each bound its spring, or null: both rise.
class Matching {
 public:
  explicit Matching(const std::vector<Spring>& springs) : next_(springs.begin()), end_(springs.end()) {}
  const Spring* of(const SoftBound& bound) {
    while (next_ != end_ && next_->entry < bound.entry)
      ++next_;
    return next_ != end_ && next_->entry == bound.entry ? &*next_ : nullptr;
  }

 private:
  std::vector<Spring>::const_iterator next_, end_;
};

double beyond(const SoftBound& bound, double x) {
  return x < bound.lower ? x - bound.lower : x > bound.upper ? x - bound.upper : 0.0;
}

double forceOf(const Spring* spring, double x) {
  return spring == nullptr ? 0.0 : spring->curvature * (x - spring->centre);
}

} // namespace

SpringChange updateSprings(const std::vector<SoftBound>& bounds, const double* x, double noise,
                           const double* random, std::vector<Spring>& springs) {
  SpringChange result;
  std::vector<Spring> before;
  std::swap(before, springs);
  Matching matching(before);
  for (const SoftBound& bound : bounds) {
    if (bound.curvature == 0.0)
      continue;
    const Spring* last = matching.of(bound);
    const double at = x[place(bound.entry)];
    const int was = sideOf(bound, last);
    int side = at < bound.lower ? -1 : at > bound.upper ? 1 : 0;
    if (bound.lower == bound.upper)
      side = -1;
    else if ((was <= 0 && std::abs(at - bound.lower) <= noise) ||
             (was >= 0 && std::abs(at - bound.upper) <= noise))
      side = was;
    const double wrong = bound.curvature * beyond(bound, at) - forceOf(last, at);
    result.wrong2 += wrong * wrong;
    result.changed += side != was ? 1 : 0;
    if (side == 0)
      continue;
    springs.push_back({bound.entry, side < 0 ? bound.lower : bound.upper, bound.curvature});
    // Whole numbers of 30 bits: sums are exact.
    const double bits = std::floor(std::ldexp(random[place(bound.entry)], 30));
    result.signature[side < 0 ? 0 : 1] += bits;
  }
  return result;
}

void addSprings(const std::vector<Spring>& springs, double f, const double* x, bool fromCentre, double* y) {
  for (const Spring& spring : springs)
    y[place(spring.entry)] +=
        f * spring.curvature * (x[place(spring.entry)] - (fromCentre ? spring.centre : 0.0));
}

void soften(const std::vector<Spring>& springs, double q, double least, double* v) {
  for (const Spring& spring : springs)
    v[place(spring.entry)] *= std::max(least, q / (q + spring.curvature));
}

void addStiff(const std::vector<Spring>& springs, double q, const double* v, double* z) {
  for (const Spring& spring : springs)
    z[place(spring.entry)] += spring.curvature / std::pow(q + spring.curvature, 2) * v[place(spring.entry)];
}

void correctSprings(const std::vector<SoftBound>& bounds, const std::vector<Spring>& springs, const double* x,
                    double* y) {
  Matching matching(springs);
  for (const SoftBound& bound : bounds) {
    const Spring* spring = matching.of(bound);
    const double at = x[place(bound.entry)], force = bound.curvature * beyond(bound, at);
    if (const double model = forceOf(spring, at); force != model)
      y[place(bound.entry)] += force - model;
  }
}

void moveToSprings(const std::vector<Spring>& before, const std::vector<Spring>& springs, double q,
                   double* x) {
  auto last = before.begin();
  for (const Spring& spring : springs) {
    while (last != before.end() && last->entry < spring.entry)
      ++last;
    if (last != before.end() && last->entry == spring.entry && last->centre == spring.centre)
      continue;
    double& entry = x[place(spring.entry)];
    entry = spring.centre + q / (q + spring.curvature) * (entry - spring.centre);
  }
}

void springsToSides(const std::vector<SoftBound>& bounds, const std::vector<Spring>& springs, double* sides) {
  Matching matching(springs);
  for (const SoftBound& bound : bounds)
    sides[place(bound.entry)] = sideOf(bound, matching.of(bound));
}

std::vector<Spring> springsOfSides(const std::vector<SoftBound>& bounds, const double* sides) {
  std::vector<Spring> springs;
  for (const SoftBound& bound : bounds)
    if (const double side = sides[place(bound.entry)]; side != 0.0)
      springs.push_back({bound.entry, side < 0.0 ? bound.lower : bound.upper, bound.curvature});
  return springs;
}

double softPower(const std::vector<SoftBound>& bounds, const double* x, const double* d) {
  double sum = 0.0;
  for (const SoftBound& bound : bounds)
    sum += d[place(bound.entry)] * bound.curvature * beyond(bound, x[place(bound.entry)]);
  return sum;
}

double opposed2(const std::vector<SoftBound>& bounds, const double* d) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const SoftBound& bound : bounds)
    if (const double entry = d[place(bound.entry)];
        bound.curvature > 0.0 &&
        ((entry < 0.0 && bound.lower > -infinity) || (entry > 0.0 && bound.upper < infinity)))
      sum += entry * entry;
  return sum;
}

} // namespace Kernels
} // namespace Harmos::qp
