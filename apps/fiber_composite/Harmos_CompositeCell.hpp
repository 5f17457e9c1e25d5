// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"

namespace Harmos::composite {

/// A square cell of a fibre composite: a circular fibre in a square of matrix with its hole.
///
/// Both meshes are O-grids of quadrilaterals that match at the circle: 4n elements along it, n along each
/// side of the square. Coordinates are relative to the cell's centre.
struct Cell {
  double size = 1.0;       ///< side of the square
  double radius = 0.3;     ///< of fibre and hole
  fem::Point centre{};     ///< of fibre and hole
  int elementsPerSide = 5; ///< n
  int fibreLayers = 3;     ///< of elements between the square core of the fibre and the circle
  int matrixLayers = 4;    ///< of elements between the circle and the square
  fem::CellType cellType =
      fem::CellType::Quadrilateral4; ///< or Quadrilateral9, whose sides follow the circle

  int nodesAround() const { return 4 * elementsPerSide * fem::shapeOf(cellType).order; }
};

/// The fibre; boundary part "surface". Nodes of the circle come last, counter-clockwise from −135°.
fem::BodyMesh fibreMesh(const Cell& cell);

/// The square with its hole; boundary parts "hole", "left", "right", "bottom", "top". Nodes come layer after
/// layer from the circle to the square, each counter-clockwise from −135°: nodesAround() a layer.
fem::BodyMesh matrixMesh(const Cell& cell);

} // namespace Harmos::composite
