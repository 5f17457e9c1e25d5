// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_VtkCell.hpp"

#include <algorithm>
#include <array>

namespace Harmos::run {
namespace {

std::vector<int> nodesOfHexahedron(const fem::CellShape& shape) {
  static const std::array<fem::Point, 27> places = {
      {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
       {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
       {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0}, {-1, 0, 0},
       {1, 0, 0},    {0, -1, 0},  {0, 1, 0},   {0, 0, -1},  {0, 0, 1},   {0, 0, 0}}};
  std::vector<int> nodes(static_cast<std::size_t>(shape.nodes));
  for (std::size_t k = 0; k < nodes.size(); ++k)
    nodes[k] =
        static_cast<int>(std::find(shape.nodeCoordinates.begin(), shape.nodeCoordinates.end(), places[k]) -
                         shape.nodeCoordinates.begin());
  return nodes;
}

} // namespace

// VTK's cells agree with ours but for the order of the nodes of hexahedra of 20 and 27, which is found from
// where they lie (VTK file formats: VTK_QUADRATIC_HEXAHEDRON, VTK_TRIQUADRATIC_HEXAHEDRON), and for wedges:
// the normal of their first three nodes looks outward, and edges of both triangles are before the others.
VtkCell vtkCell(fem::CellType type) {
  const fem::CellShape& shape = fem::shapeOf(type);
  VtkCell cell{0, {}};
  for (int k = 0; k < shape.nodes; ++k)
    cell.nodes.push_back(k);
  switch (type) {
  case fem::CellType::Line2:
    cell.type = 3;
    break;
  case fem::CellType::Line3:
    cell.type = 21;
    break;
  case fem::CellType::Triangle3:
    cell.type = 5;
    break;
  case fem::CellType::Triangle6:
    cell.type = 22;
    break;
  case fem::CellType::Quadrilateral4:
    cell.type = 9;
    break;
  case fem::CellType::Quadrilateral9:
    cell.type = 28;
    break;
  case fem::CellType::Quadrilateral8:
    cell.type = 23;
    break;
  case fem::CellType::Tetrahedron4:
    cell.type = 10;
    break;
  case fem::CellType::Tetrahedron10:
    cell.type = 24;
    break;
  case fem::CellType::Hexahedron8:
    cell.type = 12;
    break;
  case fem::CellType::Wedge6:
    cell.type = 13;
    cell.nodes = {0, 2, 1, 3, 5, 4};
    break;
  case fem::CellType::Wedge15:
  case fem::CellType::Wedge18:
    cell.type = type == fem::CellType::Wedge15 ? 26 : 32;
    cell.nodes = {0, 2, 1, 3, 5, 4, 8, 7, 6, 14, 13, 12, 9, 11, 10, 17, 16, 15};
    cell.nodes.resize(static_cast<std::size_t>(shape.nodes));
    break;
  case fem::CellType::Hexahedron20:
  case fem::CellType::Hexahedron27:
    cell.type = type == fem::CellType::Hexahedron20 ? 25 : 29; // the first nodes of which are the same
    cell.nodes = nodesOfHexahedron(shape);
    break;
  }
  return cell;
}

} // namespace Harmos::run
