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

/// For messages: "(1.000000, 0.500000, 0.000000)".
inline std::string placeText(const fem::Point& x) {
  return "(" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " + std::to_string(x[2]) + ")";
}

} // namespace Harmos
