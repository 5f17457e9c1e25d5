// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DiscKernels.hpp"

#include "Harmos_BoundKernels.hpp"
#include "Harmos_DiscGeometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp::Kernels {

using namespace DiscGeometry;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// φ̃ᵀφ inside.
double reduced2(const Disc& disc, Pair y, Pair g, double stepLength) {
  const Pair z = {y.a - stepLength * g.a, y.b - stepLength * g.b};
  const double length = norm(z);
  if (!(length > disc.radius))
    return dot(g, g);
  const double factor = disc.radius / length;
  return ((y.a - factor * z.a) * g.a + (y.b - factor * z.b) * g.b) / stepLength;
}

// The largest α with |y − αp| ≤ r.
double chord(const Disc& disc, Pair y, Pair p) {
  const double square = dot(p, p);
  if (square == 0.0)
    return infinity;
  const double along = dot(y, p), room = std::max(disc.radius - norm(y), 0.0) * (disc.radius + norm(y));
  const double root = std::sqrt(along * along + square * room);
  // Without cancellation.
  return along >= 0.0 ? (along + root) / square : room / (root - along);
}

// The splitting at y. @return whether it is on the rim.
bool splitOne(const Disc& disc, Pair y, Pair g, double stepLength, bool fresh, signed char* active,
              SplitSums& sums) {
  const bool isOn = isOnRim(disc, y);
  if (isOn) {
    const Pair beta = chopped(disc, y, g);
    sums.choppedNorm2 += dot(beta, beta);
    sums.active += 2;
  } else {
    sums.freeNorm2 += dot(g, g);
    sums.reducedNorm2 += reduced2(disc, y, g, stepLength);
  }
  const signed char state = isOn ? ActiveFace::onRim : 0;
  if (fresh || state != active[disc.first])
    sums.changed += 2;
  active[disc.first] = active[disc.second] = state;
  return isOn;
}

} // namespace

void split(const Discs& discs, const double* x, const double* g, double stepLength, double* direction,
           signed char* active, bool fresh, SplitSums& sums) {
  for (const Disc& disc : discs) {
    const Pair y = fromCentre(disc, x), gradient = of(disc, g);
    const bool isOn = splitOne(disc, y, gradient, stepLength, fresh, active, sums);
    sums.xNorm2 += dot(of(disc, x), of(disc, x));
    if (direction == nullptr)
      continue;
    set(disc, direction, isOn ? Pair{0.0, 0.0} : gradient);
    if (!isOn)
      sums.longestStep = std::min(sums.longestStep, chord(disc, y, gradient));
  }
}

void advance(const Discs& discs, double* x, double* g, const double* p, const double* image, double step,
             double beta, double stepLength, double* next, signed char* active, SplitSums& sums) {
  for (const Disc& disc : discs) {
    const Pair along = of(disc, p); // which may be `next`
    set(disc, x, {x[disc.first] - step * along.a, x[disc.second] - step * along.b});
    DiscGeometry::project(disc, x);
    const Pair gradient = {g[disc.first] - step * image[disc.first],
                           g[disc.second] - step * image[disc.second]};
    set(disc, g, gradient);
    const Pair y = fromCentre(disc, x);
    const bool isOn = splitOne(disc, y, gradient, stepLength, false, active, sums);
    sums.xNorm2 += dot(of(disc, x), of(disc, x));
    const Pair direction =
        isOn ? Pair{0.0, 0.0} : Pair{gradient.a - beta * along.a, gradient.b - beta * along.b};
    set(disc, next, direction);
    sums.longestStep = std::min(sums.longestStep, chord(disc, y, direction));
  }
}

double conjugate(const Discs& discs, const double* x, const double* z, double beta, double* p) {
  double longest = infinity;
  for (const Disc& disc : discs) {
    const Pair fresh = of(disc, z), before = of(disc, p);
    const Pair direction = beta == 0.0 ? fresh : Pair{fresh.a - beta * before.a, fresh.b - beta * before.b};
    set(disc, p, direction);
    longest = std::min(longest, chord(disc, fromCentre(disc, x), direction));
  }
  return longest;
}

double choppedDirection(const Discs& discs, const double* x, const double* g, double* p) {
  double longest = infinity;
  for (const Disc& disc : discs) {
    const Pair y = fromCentre(disc, x);
    const Pair direction = isOnRim(disc, y) ? chopped(disc, y, of(disc, g)) : Pair{0.0, 0.0};
    set(disc, p, direction);
    longest = std::min(longest, chord(disc, y, direction));
  }
  return longest;
}

void projectedStep(const Discs& discs, double* x, double* xOld, const double* p, double step) {
  for (const Disc& disc : discs) {
    set(disc, xOld, of(disc, x));
    set(disc, x, {x[disc.first] - step * p[disc.first], x[disc.second] - step * p[disc.second]});
    DiscGeometry::project(disc, x);
  }
}

void project(const Discs& discs, double* x) {
  for (const Disc& disc : discs)
    DiscGeometry::project(disc, x);
}

void projectSmoothly(const Discs& discs, double width, double* x, double* slope, std::vector<Slip>& rims) {
  constexpr double least = 1e-12; // of weights
  for (const Disc& disc : discs) {
    const Pair y = fromCentre(disc, x);
    const double reach = norm(y);
    const Smoothed radial = projectSmoothly(reach, -disc.radius, disc.radius, width);
    const double ratio = reach > 0.0 ? radial.x / reach : radial.slope;
    set(disc, slope, {radial.slope, radial.slope});
    set(disc, x, {disc.centre[0] + ratio * y.a, disc.centre[1] + ratio * y.b});
    if (const double weight = ratio - radial.slope; reach > 0.0 && weight > least)
      rims.push_back({disc.first,
                      disc.second,
                      {disc.centre[0], disc.centre[1]},
                      disc.radius,
                      {y.a / reach, y.b / reach},
                      (1.0 - weight) / weight});
  }
}

void addInfimum(const Discs& discs, const double* w, double& value, double& boundNorm2) {
  for (const Disc& disc : discs) {
    const Pair along = of(disc, w);
    const double length = norm(along);
    const double factor = length > 0.0 ? disc.radius / length : 0.0;
    const Pair corner = {disc.centre[0] - factor * along.a, disc.centre[1] - factor * along.b};
    value += dot(along, corner);
    boundNorm2 += dot(corner, corner);
  }
}

} // namespace Harmos::qp::Kernels
