// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoxTree.hpp"
#include "Harmos_CellBasis.hpp"

#include <vector>

namespace Harmos::fem {

/// The value of a field of up to three components, and gradient[i][j] = ∂u_i/∂x_j.
struct FieldValue {
  Point value{};
  std::array<Point, 3> gradient{};
};

/// Finds the cell of a mesh that a point lies in, and evaluates nodal fields there.
///
/// The mesh may be a body or a surface in space or in the plane (lines, facets). A point outside gets the
/// nearest place of the mesh: where two meshes approximate one curved boundary, each overlaps the other by
/// O(h²). Reference coordinates come from Gauss-Newton steps on |x − X(ξ)|²; where they leave the cell, its
/// sides are searched in turn. Beside a curved piece of a surface the steps converge as long as the point is
/// nearer than its radius of curvature.
///
/// Cost: O(n log n) to make; a query takes a microsecond, less if the hint is right.
/// Guarded by tests/unit/fem/test_point_locator.cpp.
class PointLocator {
 public:
  /// A place on the mesh.
  struct Place {
    int cell = -1;
    Point reference{};     ///< within the reference cell
    double distance = 0.0; ///< of the point that was asked for
  };

  /// @param nodes positions, z = 0 in the plane; @param cells nodes of each cell, in the order of
  /// shapeOf(type). Copies of nodes along cuts do no harm. @pre at least one cell.
  PointLocator(CellType type, std::vector<Point> nodes, std::vector<int> cells);

  /// The place nearest to x.
  /// @param hint a cell to look at first, for instance that of the previous point.
  Place nearest(const Point& x, int hint = -1) const;

  Point position(const Place& place) const;
  /// Value of the nodal field, values[node · components + component].
  Point value(const Place& place, const std::vector<double>& values, int components) const;
  /// Value and gradient. @pre cells of as many dimensions as the space they are in.
  FieldValue valueAndGradient(const Place& place, const std::vector<double>& values, int components) const;

  const CellShape& shape() const { return shape_; }
  std::size_t numberOfNodes() const { return nodes_.size(); }
  int numberOfCells() const { return static_cast<int>(cells_.size()) / shape_.nodes; }

 private:
  /// A cell, or a side of one, by its nodes.
  struct Piece {
    CellType type;
    std::array<int, 27> nodes;
  };
  Piece piece(int cell) const;
  std::vector<Box> boxes() const;
  bool solve(const Piece& piece, const Point& x, Point& reference, double& distance) const;
  bool contains(int cell, const Point& x, Place& place) const;
  double nearestOn(const Piece& piece, const Point& x, Point& reference) const;

  CellType type_;
  const CellShape& shape_;
  std::vector<Point> nodes_;
  std::vector<int> cells_;
  BoxTree tree_; // of boxes around the cells
  double extent_, cellSize_;
};

} // namespace Harmos::fem
