// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellType.hpp"

#include "Harmos_ReferenceElement.hpp"

#include <Shards_CellTopology.hpp>

namespace Harmos::fem {
namespace {

const CellTopologyData* topologyOf(CellType type) {
  switch (type) {
  case CellType::Line2:
    return shards::getCellTopologyData<shards::Line<2>>();
  case CellType::Line3:
    return shards::getCellTopologyData<shards::Line<3>>();
  case CellType::Triangle3:
    return shards::getCellTopologyData<shards::Triangle<3>>();
  case CellType::Triangle6:
    return shards::getCellTopologyData<shards::Triangle<6>>();
  case CellType::Quadrilateral4:
    return shards::getCellTopologyData<shards::Quadrilateral<4>>();
  case CellType::Quadrilateral9:
    return shards::getCellTopologyData<shards::Quadrilateral<9>>();
  case CellType::Tetrahedron4:
    return shards::getCellTopologyData<shards::Tetrahedron<4>>();
  case CellType::Tetrahedron10:
    return shards::getCellTopologyData<shards::Tetrahedron<10>>();
  case CellType::Hexahedron8:
    return shards::getCellTopologyData<shards::Hexahedron<8>>();
  case CellType::Hexahedron27:
    return shards::getCellTopologyData<shards::Hexahedron<27>>();
  case CellType::Quadrilateral8:
    return shards::getCellTopologyData<shards::Quadrilateral<8>>();
  case CellType::Hexahedron20:
    return shards::getCellTopologyData<shards::Hexahedron<20>>();
  case CellType::Wedge6:
    return shards::getCellTopologyData<shards::Wedge<6>>();
  case CellType::Wedge15:
    return shards::getCellTopologyData<shards::Wedge<15>>();
  case CellType::Wedge18:
    return shards::getCellTopologyData<shards::Wedge<18>>();
  }
  return nullptr;
}

CellType sideType(int dimension, std::size_t nodes) {
  if (dimension == 1)
    return nodes == 2 ? CellType::Line2 : CellType::Line3;
  switch (nodes) {
  case 3:
    return CellType::Triangle3;
  case 4:
    return CellType::Quadrilateral4;
  case 6:
    return CellType::Triangle6;
  case 8:
    return CellType::Quadrilateral8;
  default:
    return CellType::Quadrilateral9;
  }
}

std::string nameOf(CellType type, int nodes) {
  switch (type) {
  case CellType::Line2:
  case CellType::Line3:
    return "line of " + std::to_string(nodes) + " nodes";
  case CellType::Triangle3:
  case CellType::Triangle6:
    return "triangle of " + std::to_string(nodes) + " nodes";
  case CellType::Quadrilateral4:
  case CellType::Quadrilateral8:
  case CellType::Quadrilateral9:
    return "quadrilateral of " + std::to_string(nodes) + " nodes";
  case CellType::Tetrahedron4:
  case CellType::Tetrahedron10:
    return "tetrahedron of " + std::to_string(nodes) + " nodes";
  case CellType::Hexahedron8:
  case CellType::Hexahedron20:
  case CellType::Hexahedron27:
    return "hexahedron of " + std::to_string(nodes) + " nodes";
  case CellType::Wedge6:
  case CellType::Wedge15:
  case CellType::Wedge18:
    return "wedge of " + std::to_string(nodes) + " nodes";
  }
  return "";
}

// Products of gradients on affine cells.
int stiffnessDegree(const CellShape& shape) {
  if (shape.isWedge)
    return 2 * shape.order;
  if (shape.isSimplex)
    return shape.order == 1 ? 1 : 4;
  return 2 * shape.order + 1;
}

CellShape makeShape(CellType type) {
  const shards::CellTopology topology(topologyOf(type));
  CellShape shape;
  shape.dimension = static_cast<int>(topology.getDimension());
  shape.nodes = static_cast<int>(topology.getNodeCount());
  shape.corners = static_cast<int>(topology.getVertexCount());
  shape.order = shape.nodes == shape.corners ? 1 : 2;
  shape.isSerendipity = wholeOf(type) != type;
  shape.isSimplex = shape.dimension > 1 && shape.corners == shape.dimension + 1;
  shape.isWedge = linearOf(type) == CellType::Wedge6;
  shape.stiffnessDegree = stiffnessDegree(shape);
  shape.name = nameOf(type, shape.nodes);
  shape.nodeCoordinates = nodeCoordinates(type);
  if (shape.dimension > 1) {
    const auto dimension = static_cast<unsigned>(shape.dimension - 1);
    for (unsigned s = 0; s < topology.getSideCount(); ++s) {
      std::vector<int> nodes;
      for (unsigned k = 0; k < topology.getNodeCount(dimension, s); ++k)
        nodes.push_back(static_cast<int>(topology.getNodeMap(dimension, s, k)));
      shape.sides.push_back(nodes);
      shape.sideTypes.push_back(sideType(shape.dimension - 1, nodes.size()));
    }
  }
  return shape;
}

} // namespace

CellType wholeOf(CellType type) {
  return type == CellType::Quadrilateral8 ? CellType::Quadrilateral9
         : type == CellType::Hexahedron20 ? CellType::Hexahedron27
         : type == CellType::Wedge15      ? CellType::Wedge18
                                          : type;
}

CellType linearOf(CellType type) {
  switch (type) {
  case CellType::Line3:
    return CellType::Line2;
  case CellType::Triangle6:
    return CellType::Triangle3;
  case CellType::Quadrilateral8:
  case CellType::Quadrilateral9:
    return CellType::Quadrilateral4;
  case CellType::Tetrahedron10:
    return CellType::Tetrahedron4;
  case CellType::Hexahedron20:
  case CellType::Hexahedron27:
    return CellType::Hexahedron8;
  case CellType::Wedge15:
  case CellType::Wedge18:
    return CellType::Wedge6;
  default:
    return type;
  }
}

const CellShape& shapeOf(CellType type) {
  static const std::array<CellShape, 15> shapes = [] {
    std::array<CellShape, 15> all;
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = makeShape(static_cast<CellType>(k));
    return all;
  }();
  return shapes[static_cast<std::size_t>(type)];
}

} // namespace Harmos::fem
