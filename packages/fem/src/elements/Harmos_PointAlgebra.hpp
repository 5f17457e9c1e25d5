// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <cmath>
#include <string>

/// Vectors of three numbers, for geometry.
namespace Harmos {

inline fem::Point sum(const fem::Point& a, const fem::Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline fem::Point difference(const fem::Point& a, const fem::Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline fem::Point scaled(double factor, const fem::Point& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const fem::Point& a, const fem::Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline fem::Point cross(const fem::Point& a, const fem::Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double norm(const fem::Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}

/// A vector turned as one direction is into another, by the smallest turn: v + w × v + w × (w × v)/(1 + c),
/// w = from × to, c = from · to (Rodrigues); of directions that are nearly opposite, which many turns bring
/// into each other, after half a turn about an axis across the first. @param from, to of length one.
inline fem::Point turned(const fem::Point& from, const fem::Point& to, const fem::Point& v) {
  const double c = dot(from, to);
  constexpr double nearlyOpposite = -0.9;
  if (c < nearlyOpposite) {
    const std::size_t least = std::abs(from[0]) < std::abs(from[1])
                                  ? (std::abs(from[0]) < std::abs(from[2]) ? 0 : 2)
                                  : (std::abs(from[1]) < std::abs(from[2]) ? 1 : 2);
    fem::Point axis{};
    axis[least] = 1.0;
    axis = cross(from, axis);
    axis = scaled(1.0 / norm(axis), axis);
    return turned(scaled(-1.0, from), to, difference(scaled(2.0 * dot(axis, v), axis), v));
  }
  const fem::Point axis = cross(from, to), once = cross(axis, v);
  return sum(sum(v, once), scaled(1.0 / (1.0 + c), cross(axis, once)));
}

/// For messages: "(1.000000, 0.500000, 0.000000)".
inline std::string placeText(const fem::Point& x) {
  return "(" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " + std::to_string(x[2]) + ")";
}

} // namespace Harmos
