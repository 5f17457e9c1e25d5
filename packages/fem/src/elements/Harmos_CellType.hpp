// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace Harmos::fem {

using Point = std::array<double, 3>;

/// Elements by the number of their nodes: Lagrange elements, and serendipity elements of second order, which
/// have no nodes inside of their faces and cells (Quadrilateral8, Hexahedron20, Wedge15). Lines are sides of
/// plane cells only.
enum class CellType {
  Line2,
  Line3,
  Triangle3,
  Triangle6,
  Quadrilateral4,
  Quadrilateral9,
  Tetrahedron4,
  Tetrahedron10,
  Hexahedron8,
  Hexahedron27,
  Quadrilateral8,
  Hexahedron20,
  Wedge6,
  Wedge15,
  Wedge18
};

/// All types that bodies may have.
inline constexpr std::array<CellType, 13> bodyCells = {
    CellType::Triangle3,      CellType::Triangle6,    CellType::Quadrilateral4, CellType::Quadrilateral8,
    CellType::Quadrilateral9, CellType::Tetrahedron4, CellType::Tetrahedron10,  CellType::Wedge6,
    CellType::Wedge15,        CellType::Wedge18,      CellType::Hexahedron8,    CellType::Hexahedron20,
    CellType::Hexahedron27};

/// What is known of a cell type without any mesh. Node orders are those of Shards and Intrepid2: corners
/// first, then edges, faces, the inside.
struct CellShape {
  std::string name; ///< "triangle of 6 nodes"
  int dimension;
  int nodes;
  int corners;
  int order;                           ///< 1 or 2
  bool isSimplex;                      ///< line: no
  bool isWedge;                        ///< a triangle times the line from −1 to 1
  bool isSerendipity;                  ///< second order with nodes on corners and edges alone; no simplex
  int stiffnessDegree;                 ///< of quadrature for stiffness matrices in full: see quadratureOn()
  std::vector<Point> nodeCoordinates;  ///< on the reference cell
  std::vector<std::vector<int>> sides; ///< nodes of each side, corners first, so ordered that the normal of
                                       ///< sideNormal() looks outward
  std::vector<CellType> sideTypes;     ///< of each side; wedges have triangles and quadrilaterals
};

const CellShape& shapeOf(CellType type);

/// The Lagrange element whose first nodes are those of a serendipity element; other types: themselves.
CellType wholeOf(CellType type);

/// The element of first order with the same corners.
CellType linearOf(CellType type);

} // namespace Harmos::fem
