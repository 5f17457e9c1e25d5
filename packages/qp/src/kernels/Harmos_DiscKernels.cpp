// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DiscKernels.hpp"

#include "Harmos_BoundKernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp::Kernels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Pair {
  double a, b;
};

double dot(Pair p, Pair q) {
  return p.a * q.a + p.b * q.b;
}
double norm(Pair p) {
  return std::hypot(p.a, p.b);
}

Pair of(const Disc& disc, const double* v) {
  return {v[disc.first], v[disc.second]};
}
void set(const Disc& disc, double* v, Pair value) {
  v[disc.first] = value.a;
  v[disc.second] = value.b;
}
Pair fromCentre(const Disc& disc, const double* x) {
  return {x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]};
}

// What rounding leaves of a distance from the rim.
double touching(const Disc& disc) {
  return 8.0 * std::numeric_limits<double>::epsilon() *
         (disc.radius + std::abs(disc.centre[0]) + std::abs(disc.centre[1]));
}

bool isOnRim(const Disc& disc, Pair y) {
  return norm(y) >= disc.radius - touching(disc);
}

// The part of g along which x − αg, α > 0, can go from the rim at once.
Pair chopped(const Disc& disc, Pair y, Pair g) {
  const double length = norm(y);
  if (disc.radius <= touching(disc) || length == 0.0)
    return {0.0 * g.a, 0.0 * g.b}; // a gradient that is no number stays one
  const double outwards = dot(y, g) / length;
  if (outwards >= 0.0)
    return g;
  return {g.a - outwards * y.a / length, g.b - outwards * y.b / length};
}

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

void put(const Disc& disc, Pair y, double* x) {
  const double length = norm(y), factor = length > 0.0 ? disc.radius / length : 0.0;
  set(disc, x, {disc.centre[0] + factor * y.a, disc.centre[1] + factor * y.b});
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
  const signed char state = isOn ? LocalActiveSet::onRim : 0;
  if (fresh || state != active[disc.first])
    sums.changed += 2;
  active[disc.first] = active[disc.second] = state;
  return isOn;
}

// What is on the rim already stays where it is, to the last bit.
void projectOne(const Disc& disc, double* x) {
  if (const Pair y = fromCentre(disc, x); norm(y) > disc.radius + touching(disc))
    put(disc, y, x);
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
    projectOne(disc, x);
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
    projectOne(disc, x);
  }
}

void project(const Discs& discs, double* x) {
  for (const Disc& disc : discs)
    projectOne(disc, x);
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

void moveToRims(const Discs& discs, const signed char* active, double* x) {
  for (const Disc& disc : discs)
    if (const Pair y = fromCentre(disc, x); active[disc.first] == LocalActiveSet::onRim && norm(y) > 0.0 &&
                                            std::abs(norm(y) - disc.radius) > touching(disc))
      put(disc, y, x);
}

void maskSlips(const std::vector<Slip>& slipping, double* v) {
  for (const Slip& slip : slipping) {
    const Pair t = {-slip.normal[1], slip.normal[0]};
    const double along = dot(t, {v[slip.first], v[slip.second]});
    v[slip.first] = along * t.a;
    v[slip.second] = along * t.b;
  }
}

void addCurvature(const std::vector<Slip>& slipping, double f, const double* x, bool fromCentre, double* y) {
  for (const Slip& slip : slipping) {
    const Pair t = {-slip.normal[1], slip.normal[0]};
    Pair of = {x[slip.first], x[slip.second]};
    if (fromCentre)
      of = {of.a - slip.centre[0], of.b - slip.centre[1]};
    const double along = f * slip.curvature * dot(t, of);
    y[slip.first] += along * t.a;
    y[slip.second] += along * t.b;
  }
}

void moveToTangents(const std::vector<Slip>& slipping, double* x) {
  for (const Slip& slip : slipping) {
    const Pair n = {slip.normal[0], slip.normal[1]}, t = {-n.b, n.a};
    const Pair y = {x[slip.first] - slip.centre[0], x[slip.second] - slip.centre[1]};
    const double along = dot(t, y);
    // What is there already stays, to the last bit.
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() *
                            (norm(y) + std::abs(slip.centre[0]) + std::abs(slip.centre[1]));
    if (std::abs(dot(n, y) - slip.radius) <= rounding)
      continue;
    x[slip.first] = slip.centre[0] + slip.radius * n.a + along * t.a;
    x[slip.second] = slip.centre[1] + slip.radius * n.b + along * t.b;
  }
}

DiscChange update(const Discs& discs, const double* x, const double* g, const DiscUpdate& how, double xNoise,
                  double gradientNoise, LocalActiveSet& set) {
  DiscChange result;
  std::vector<Slip> before;
  std::swap(before, set.slipping);
  auto old = before.begin(); // in the order of the discs
  for (const Disc& disc : discs) {
    const signed char was = set[static_cast<std::size_t>(disc.first)];
    const Slip* last = was == LocalActiveSet::slips ? &*old++ : nullptr;
    const Pair y = fromCentre(disc, x), gradient = of(disc, g);
    const double beyond = std::max(norm(y) - disc.radius, 0.0);
    const Pair z = {y.a - how.stepLength * gradient.a, y.b - how.stepLength * gradient.b};
    const double reach = norm(z);
    signed char state = 0;
    if (disc.radius <= touching(disc))
      state = LocalActiveSet::onRim;
    else if (reach > disc.radius + std::max(xNoise, touching(disc)))
      state = LocalActiveSet::slips;
    bool isChanged = state != was;
    result.violation2 += beyond * beyond;
    if (state == LocalActiveSet::slips || last != nullptr) {
      const double wrong = norm(chopped(disc, y, gradient));
      result.wrong2 += wrong * wrong;
      const double noise = std::max(gradientNoise, how.turn);
      const bool hasTurned = wrong > noise || (beyond > xNoise && beyond > how.stepLength * noise);
      isChanged = isChanged || hasTurned;
      if (state == LocalActiveSet::slips && last != nullptr && !hasTurned) {
        set.slipping.push_back(*last);
        set.slipping.back().radius = disc.radius; // which may follow the solution
      } else if (state == LocalActiveSet::slips)
        set.slipping.push_back(
            {disc.first,
             disc.second,
             {disc.centre[0], disc.centre[1]},
             disc.radius,
             {z.a / reach, z.b / reach},
             how.stepLength > 0.0 ? (reach - disc.radius) / (how.stepLength * disc.radius) : 0.0});
    }
    set[static_cast<std::size_t>(disc.first)] = set[static_cast<std::size_t>(disc.second)] = state;
    result.active += state != 0;
    result.changed += isChanged;
  }
  return result;
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

double clear(const Discs& discs, double* d) {
  double removed = 0.0;
  for (const Disc& disc : discs) {
    removed += dot(of(disc, d), of(disc, d));
    set(disc, d, {0.0, 0.0});
  }
  return removed;
}

} // namespace Harmos::qp::Kernels
