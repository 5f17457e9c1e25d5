// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FeasibleSet.hpp"

#include <cmath>
#include <limits>

namespace Harmos::qp::DiscGeometry {

// What the block of discs and the passes of gradient projection over them share.

struct Pair {
  double a, b;
};

inline double dot(Pair p, Pair q) {
  return p.a * q.a + p.b * q.b;
}
inline double norm(Pair p) {
  return std::hypot(p.a, p.b);
}

inline Pair of(const Disc& disc, const double* v) {
  return {v[disc.first], v[disc.second]};
}
inline void set(const Disc& disc, double* v, Pair value) {
  v[disc.first] = value.a;
  v[disc.second] = value.b;
}
inline Pair fromCentre(const Disc& disc, const double* x) {
  return {x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]};
}

/// What rounding leaves of a distance from the rim.
inline double touching(const Disc& disc) {
  return 8.0 * std::numeric_limits<double>::epsilon() *
         (disc.radius + std::abs(disc.centre[0]) + std::abs(disc.centre[1]));
}

inline bool isOnRim(const Disc& disc, Pair y) {
  return norm(y) >= disc.radius - touching(disc);
}

/// The part of g along which x − αg, α > 0, can go from the rim at once.
inline Pair chopped(const Disc& disc, Pair y, Pair g) {
  const double length = norm(y);
  if (disc.radius <= touching(disc) || length == 0.0)
    return {0.0 * g.a, 0.0 * g.b}; // a gradient that is no number stays one
  const double outwards = dot(y, g) / length;
  if (outwards >= 0.0)
    return g;
  return {g.a - outwards * y.a / length, g.b - outwards * y.b / length};
}

/// x ← the point of the rim in the direction of y.
inline void put(const Disc& disc, Pair y, double* x) {
  const double length = norm(y), factor = length > 0.0 ? disc.radius / length : 0.0;
  set(disc, x, {disc.centre[0] + factor * y.a, disc.centre[1] + factor * y.b});
}

/// What is on the rim already stays where it is, to the last bit.
inline void project(const Disc& disc, double* x) {
  if (const Pair y = fromCentre(disc, x); norm(y) > disc.radius + touching(disc))
    put(disc, y, x);
}

} // namespace Harmos::qp::DiscGeometry
