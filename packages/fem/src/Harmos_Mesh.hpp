// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::fem {

using Point = std::array<double, 3>;

enum class CellType { Quadrilateral4 };

/// Geometry and connectivity of one subdomain, relative to an anchor.
///
/// Coordinates are stored relative to the anchor, so that congruent subdomains have bit for bit the same mesh
/// and can share it: nothing that is identical is kept twice.
struct Mesh {
  CellType cellType = CellType::Quadrilateral4;
  std::vector<double> coordinates; ///< (x, y) of each node, relative to the anchor
  std::vector<int> cells;          ///< nodes of each cell, counter-clockwise
  std::vector<int> boundary;       ///< nodes on the boundary, rising

  static constexpr int dimension = 2;
  static constexpr int nodesPerCell = 4;

  int numberOfNodes() const { return static_cast<int>(coordinates.size()) / dimension; }
  int numberOfCells() const { return static_cast<int>(cells.size()) / nodesPerCell; }
};

/// A mesh at its place in a body. It holds only what differs between congruent subdomains.
struct PlacedMesh {
  std::shared_ptr<const Mesh> mesh;
  Point anchor{};
  std::vector<long long>
      boundaryNumbers; ///< global number of each node of mesh->boundary; copies have the same
  std::map<std::string, std::vector<int>> sets; ///< local nodes of the body's named boundary parts, sorted

  /// Global number of a node on the boundary.
  long long number(int boundaryNode) const {
    const auto place = std::lower_bound(mesh->boundary.begin(), mesh->boundary.end(), boundaryNode);
    return boundaryNumbers[static_cast<std::size_t>(place - mesh->boundary.begin())];
  }

  Point position(int node) const {
    const std::size_t k = static_cast<std::size_t>(node) * Mesh::dimension;
    return {anchor[0] + mesh->coordinates[k], anchor[1] + mesh->coordinates[k + 1], anchor[2]};
  }
};

} // namespace Harmos::fem
