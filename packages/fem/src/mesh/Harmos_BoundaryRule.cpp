// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryRule.hpp"

#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {
namespace {

// The part of x that is orthogonal to a direction.
Point across(const Point& x, const Point& direction) {
  return difference(x, scaled(dot(x, direction) / dot(direction, direction), direction));
}

template<class Condition>
bool allOf(const SideGeometry& side, const Condition& condition) {
  return std::all_of(side.corners.begin(), side.corners.end(), condition);
}

} // namespace

bool BoundaryRule::isOn(const std::string& body) const {
  return bodies.empty() || std::find(bodies.begin(), bodies.end(), body) != bodies.end();
}

BoundaryRule::Verdict BoundaryRule::judge(const SideGeometry& side, double length, bool faces) const {
  Verdict verdict;
  verdict.fill(true);
  if (box) {
    const Box wide = widened(*box, length);
    verdict[0] = allOf(side, [&](const Point& x) { return wide.touches({x, x}); });
  }
  if (direction) {
    const double degree = std::acos(-1.0) / 180.0;
    verdict[1] = dot(side.normal, direction->normal) >=
                 std::cos(direction->degrees * degree) * norm(direction->normal);
  }
  if (plane)
    // The rim of a thin body lies within the tolerance of the plane.
    verdict[2] =
        norm(across(side.normal, plane->normal)) < std::sqrt(0.5) && allOf(side, [&](const Point& x) {
          return std::abs(dot(difference(x, plane->point), plane->normal)) <= length * norm(plane->normal);
        });
  if (cylinder) {
    const auto radius = [&](const Point& x) {
      return across(difference(x, cylinder->point), cylinder->axis);
    };
    // The corners of a cap may all lie on the rim.
    const bool isCap = norm(across(side.normal, cylinder->axis)) < std::sqrt(0.5);
    verdict[3] = !isCap && allOf(side, [&](const Point& x) {
      return std::abs(norm(radius(x)) - cylinder->radius) <= length;
    });
  }
  verdict[4] = !facing || faces;
  verdict[5] = !corners || side.corners.size() == *corners;
  return verdict;
}

std::array<std::string, BoundaryRule::conditions> BoundaryRule::words() const {
  return {box ? "in the box" : "",
          direction ? "of that normal" : "",
          plane ? "on the plane" : "",
          cylinder ? "on the cylinder" : "",
          facing ? "facing these bodies" : "",
          !corners        ? ""
          : *corners == 3 ? "triangles"
                          : "quadrilaterals"};
}

} // namespace Harmos::fem
