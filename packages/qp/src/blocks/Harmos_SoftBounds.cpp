// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SoftBounds.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double beyond(const SoftBound& bound, double x) {
  return x < bound.lower ? x - bound.lower : x > bound.upper ? x - bound.upper : 0.0;
}

int sideAt(const SoftBound& bound, double x, int was, double noise) {
  if (bound.lower == bound.upper)
    return -1;
  if ((was <= 0 && std::abs(x - bound.lower) <= noise) || (was >= 0 && std::abs(x - bound.upper) <= noise))
    return was;
  return x < bound.lower ? -1 : x > bound.upper ? 1 : 0;
}

} // namespace

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

bool LocalSoftBounds::areSound() const {
  return std::all_of(bounds_.begin(), bounds_.end(), [](const SoftBound& bound) {
    return bound.lower <= bound.upper && bound.lower < infinity && bound.upper > -infinity &&
           bound.curvature >= 0.0 && std::isfinite(bound.curvature);
  });
}

void SoftIntervals::mark(char* entries) const {
  for (const SoftBound& bound : bounds_)
    entries[bound.entry] = 1;
}

void SoftIntervals::addForces(const double* x, double* y) const {
  for (const SoftBound& bound : bounds_)
    if (const double force = bound.curvature * beyond(bound, x[bound.entry]); force != 0.0)
      y[bound.entry] += force;
}

void SoftIntervals::update(const double* x, const double* /*g*/, const FaceUpdate& how,
                           const ActiveFace& before, ActiveFace& face, FaceTally& /*tally*/) const {
  Kernels::SpringOf springOf(before.springs);
  for (const SoftBound& bound : bounds_) {
    if (bound.curvature == 0.0)
      continue;
    const Spring* const last = springOf(bound.entry);
    const int was = last == nullptr ? 0 : last->side;
    const int side = how.keepsSprings ? was : sideAt(bound, x[bound.entry], was, how.xNoise);
    if (side != 0)
      face.springs.push_back({bound.entry, side, side < 0 ? bound.lower : bound.upper, bound.curvature});
  }
}

double SoftIntervals::recede(double* d) const {
  double removed2 = 0.0;
  for (const SoftBound& bound : bounds_)
    if (double& entry = d[bound.entry]; bound.curvature > 0.0 && ((entry < 0.0 && bound.lower > -infinity) ||
                                                                  (entry > 0.0 && bound.upper < infinity))) {
      removed2 += entry * entry;
      entry = 0.0;
    }
  return removed2;
}

} // namespace Harmos::qp
