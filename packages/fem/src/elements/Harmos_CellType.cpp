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
  }
  return nullptr;
}

CellType sideOf(CellType type) {
  switch (type) {
  case CellType::Triangle3:
  case CellType::Quadrilateral4:
    return CellType::Line2;
  case CellType::Triangle6:
  case CellType::Quadrilateral8:
  case CellType::Quadrilateral9:
    return CellType::Line3;
  case CellType::Tetrahedron4:
    return CellType::Triangle3;
  case CellType::Tetrahedron10:
    return CellType::Triangle6;
  case CellType::Hexahedron8:
    return CellType::Quadrilateral4;
  case CellType::Hexahedron27:
    return CellType::Quadrilateral9;
  case CellType::Hexahedron20:
    return CellType::Quadrilateral8;
  default:
    return type;
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
  }
  return "";
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
  shape.name = nameOf(type, shape.nodes);
  shape.nodeCoordinates = nodeCoordinates(type);
  shape.side = sideOf(type);
  if (shape.dimension > 1) {
    const auto dimension = static_cast<unsigned>(shape.dimension - 1);
    for (unsigned s = 0; s < topology.getSideCount(); ++s) {
      std::vector<int> nodes;
      for (unsigned k = 0; k < topology.getNodeCount(dimension, s); ++k)
        nodes.push_back(static_cast<int>(topology.getNodeMap(dimension, s, k)));
      shape.sides.push_back(nodes);
    }
  }
  return shape;
}

} // namespace

CellType wholeOf(CellType type) {
  return type == CellType::Quadrilateral8 ? CellType::Quadrilateral9
         : type == CellType::Hexahedron20 ? CellType::Hexahedron27
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
  default:
    return type;
  }
}

const CellShape& shapeOf(CellType type) {
  static const std::array<CellShape, 12> shapes = [] {
    std::array<CellShape, 12> all;
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = makeShape(static_cast<CellType>(k));
    return all;
  }();
  return shapes[static_cast<std::size_t>(type)];
}

} // namespace Harmos::fem
