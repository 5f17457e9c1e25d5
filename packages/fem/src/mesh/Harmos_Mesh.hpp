// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace Harmos::fem {

/// A side of a cell: an edge in the plane, a face in space.
struct Side {
  int cell;
  int side; ///< as in CellShape::sides
};

/// Geometry and connectivity of one subdomain, relative to an anchor.
///
/// Coordinates are stored relative to the anchor, so that congruent subdomains have bit for bit the same mesh
/// and can share it: nothing that is identical is kept twice.
struct Mesh {
  CellType cellType = CellType::Quadrilateral4;
  std::vector<double> coordinates; ///< dimension() numbers a node, relative to the anchor
  std::vector<int> cells;          ///< nodes of each cell, in the order of shapeOf(cellType)
  std::vector<int> boundary;       ///< nodes on the boundary, rising
  std::vector<int> regions;        ///< region of each cell; empty: all are in region 0
  /// Of a plane mesh: the meridian plane of bodies of revolution, x the distance from their axis, y along it.
  /// The anchor is on the axis then, and all integrals go around it.
  bool isAxisymmetric = false;
  std::vector<double> thickness; ///< of a plane mesh, by region; empty: 1 everywhere

  int dimension() const { return shapeOf(cellType).dimension; }
  int nodesPerCell() const { return shapeOf(cellType).nodes; }
  int numberOfNodes() const { return static_cast<int>(coordinates.size()) / dimension(); }
  int numberOfCells() const { return static_cast<int>(cells.size()) / nodesPerCell(); }
  int region(int cell) const { return regions.empty() ? 0 : regions[static_cast<std::size_t>(cell)]; }
  const int* cell(int c) const {
    return cells.data() + static_cast<std::size_t>(c) * static_cast<std::size_t>(nodesPerCell());
  }
  /// Position of a node relative to the anchor; z = 0 in the plane.
  Point local(int node) const {
    Point x{};
    const auto d = static_cast<std::size_t>(dimension());
    for (std::size_t k = 0; k < d; ++k)
      x[k] = coordinates[static_cast<std::size_t>(node) * d + k];
    return x;
  }
  /// What integrals over the mesh are multiplied by at a place relative to the anchor: the length of the
  /// circle through it, 2πx, of axisymmetric meshes; else 1.
  double around(const Point& local) const {
    constexpr double turn = 6.283185307179586;
    return isAxisymmetric ? turn * local[0] : 1.0;
  }
  /// The same of a cell's thickness, and of both.
  double thicknessOf(int cell) const {
    return thickness.empty() ? 1.0 : thickness[static_cast<std::size_t>(region(cell))];
  }
  double around(int cell, const Point& local) const { return thicknessOf(cell) * around(local); }
  CellType typeOf(const Side& side) const {
    return shapeOf(cellType).sideTypes[static_cast<std::size_t>(side.side)];
  }
  /// Nodes of a side, in the order of shapeOf(typeOf(side)).
  std::vector<int> nodesOf(const Side& side) const {
    std::vector<int> nodes = shapeOf(cellType).sides[static_cast<std::size_t>(side.side)];
    for (int& node : nodes)
      node = cell(side.cell)[node];
    return nodes;
  }
};

/// A mesh at its place in a body. It holds only what differs between congruent subdomains.
struct PlacedMesh {
  std::shared_ptr<const Mesh> mesh;
  Point anchor{};
  std::vector<long long>
      boundaryNumbers; ///< global number of each node of mesh->boundary; copies have the same
  std::map<std::string, std::vector<int>> sets;   ///< local nodes of the body's named boundary parts, sorted;
                                                  ///< those that only touch a part are among them
  std::map<std::string, std::vector<Side>> sides; ///< sides of cells that make up the named boundary parts
  std::map<std::string, std::vector<double>> fields{}; ///< named values of all local nodes

  /// Global number of a node on the boundary.
  long long number(int boundaryNode) const {
    const auto place = std::lower_bound(mesh->boundary.begin(), mesh->boundary.end(), boundaryNode);
    return boundaryNumbers[static_cast<std::size_t>(place - mesh->boundary.begin())];
  }

  Point position(int node) const {
    const Point x = mesh->local(node);
    return {anchor[0] + x[0], anchor[1] + x[1], anchor[2] + x[2]};
  }
};

/// The sides of cells that no other cell shares: the boundary. Sorted by cell. Local.
std::vector<Side> boundarySides(const Mesh& mesh);

/// Two cells that share a side and lie on the same side of it, or of which a third shares it: the mesh is
/// folded, and cells cover each other. None in a sound one. Of cells that are not mirrored. Local.
std::optional<std::pair<Side, Side>> foldedSides(const Mesh& mesh);

/// The nodes of the given sides, sorted, once each. Local.
std::vector<int> nodesOf(const Mesh& mesh, const std::vector<Side>& sides);

} // namespace Harmos::fem
