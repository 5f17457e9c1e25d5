// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SideGeometry.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::fem {

/// Chooses a part of a body's boundary by where it is: the sides that meet each condition that is given.
///
/// Conditions look at the corners of sides, so that they mean the same for elements of first and second
/// order. Guarded by tests/unit/scene/test_boundary_rules.cpp.
struct BoundaryRule {
  struct Direction {
    Point normal;          ///< of any length but 0
    double degrees = 30.0; ///< that the outward normal of a side may be off
  };
  struct Plane {
    Point point, normal;
  };
  struct Cylinder {
    Point point, axis;
    double radius;
  };
  /// That a side faces one of other bodies, which only who knows all bodies can tell.
  struct Facing {
    std::vector<std::string> bodies;
    double distance; ///< 0: a usual one
  };
  /// Conditions, in the order in which words() tells of them.
  static constexpr std::size_t conditions = 6;
  using Verdict = std::array<bool, conditions>;

  std::string name;                ///< of the part
  std::vector<std::string> bodies; ///< none: each
  std::vector<std::string> of;     ///< among the sides of these parts; none: of the whole boundary
  std::optional<Box> box;          ///< all corners in it; ends may be infinite
  std::optional<Direction> direction;
  std::optional<Plane> plane; ///< all corners on it, and no rim: the normal is nearer to its than across
  std::optional<Cylinder> cylinder; ///< all corners on it, and no cap: the normal is nearer to the radius
                                    ///< than to the axis
  std::optional<Facing> facing;
  std::optional<std::size_t> corners; ///< of sides in space: 3, triangles, or 4
  double tolerance = 1e-5; ///< of box, plane and cylinder, in shares of the diagonal of the body's box

  bool isOn(const std::string& body) const;
  /// Of each condition whether the side meets it; those that are not given are met. @param length tolerance
  /// times the body's size. @param faces whether the side is one that faces the bodies of `facing`.
  Verdict judge(const SideGeometry& side, double length, bool faces = false) const;
  /// "in the box", ...; "": the condition is not given.
  std::array<std::string, conditions> words() const;
};

} // namespace Harmos::fem
