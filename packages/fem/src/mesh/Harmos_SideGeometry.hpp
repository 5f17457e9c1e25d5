// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoxTree.hpp"
#include "Harmos_Mesh.hpp"

#include <Teuchos_Comm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace Harmos::fem {

/// Where a side of a cell is, as its corners tell: what bends between them is not looked at.
struct SideGeometry {
  std::vector<Point> corners;
  Point middle{};    ///< their mean
  Point normal{};    ///< outward, of length 1; a quadrilateral's by its diagonals
  double area = 0.0; ///< length in the plane
};

/// Local.
SideGeometry geometryOf(const Mesh& mesh, const Point& anchor, const Side& side);
SideGeometry geometryOf(const PlacedMesh& mesh, const Side& side);

/// What there is to tell of several sides together.
struct SidesGeometry {
  long long sides = 0;
  double area = 0.0;
  Point normals{};        ///< sum of the normals times the areas
  std::optional<Box> box; ///< around the corners; none without sides

  void add(const SideGeometry& side);
  /// The normal that all have; none where they differ by more than some hundredth of a degree.
  std::optional<Point> commonNormal() const;
};

/// Those of all ranks together. @note Collective.
SidesGeometry overAll(const Teuchos::Comm<int>& comm, const SidesGeometry& mine);

/// "0.25, flat with normal (0, 0, 1), in (0, 0, 1) to (0.5, 0.5, 1)": area (length in the plane), shape,
/// place.
std::string textOf(const SidesGeometry& sides);

} // namespace Harmos::fem
