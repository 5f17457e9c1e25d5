// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mesh.hpp"

#include "Harmos_CellSides.hpp"

#include <numeric>

namespace Harmos::fem {
namespace {

// Whether corners go around in the same way, of two sides with the same ones.
bool goTheSameWay(const Mesh& mesh, const Side& a, const Side& b, std::size_t corners) {
  const auto cornerOf = [&](const Side& side, std::size_t k) {
    return mesh.cell(side.cell)[shapeOf(mesh.cellType).sides[static_cast<std::size_t>(side.side)][k]];
  };
  for (std::size_t k = 0; k < corners; ++k)
    if (cornerOf(b, k) == cornerOf(a, 0))
      return cornerOf(b, (k + 1) % corners) == cornerOf(a, 1) && !(corners == 2 && k == 1);
  return false;
}

} // namespace

std::vector<Side> boundarySides(const Mesh& mesh) {
  const std::vector<CornerSide> sides = sidesByCorners(mesh);
  std::vector<Side> result;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const bool shared = (k > 0 && sides[k - 1].corners == sides[k].corners) ||
                        (k + 1 < sides.size() && sides[k + 1].corners == sides[k].corners);
    if (!shared)
      result.push_back(sides[k].side);
  }
  std::sort(result.begin(), result.end(),
            [](const Side& a, const Side& b) { return std::tie(a.cell, a.side) < std::tie(b.cell, b.side); });
  return result;
}

// Corners of sides go around outwards: the other way, seen from the cell behind.
std::optional<std::pair<Side, Side>> foldedSides(const Mesh& mesh) {
  const auto corners = static_cast<std::size_t>(shapeOf(shapeOf(mesh.cellType).side).corners);
  const std::vector<CornerSide> sides = sidesByCorners(mesh);
  for (std::size_t k = 1; k < sides.size(); ++k) {
    if (sides[k - 1].corners != sides[k].corners)
      continue;
    const bool isThird = k > 1 && sides[k - 2].corners == sides[k].corners;
    if (isThird || goTheSameWay(mesh, sides[k - 1].side, sides[k].side, corners))
      return std::make_pair(sides[k - 1].side, sides[k].side);
  }
  return std::nullopt;
}

int numberOfPieces(const Mesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.numberOfNodes()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto rootOf = [&](int node) {
    while (parent[static_cast<std::size_t>(node)] != node)
      node = parent[static_cast<std::size_t>(node)] =
          parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(node)])];
    return node;
  };
  int pieces = mesh.numberOfNodes();
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    for (int k = 1; k < shapeOf(mesh.cellType).nodes; ++k) {
      const int a = rootOf(mesh.cell(c)[0]), b = rootOf(mesh.cell(c)[k]);
      if (a == b)
        continue;
      parent[static_cast<std::size_t>(b)] = a;
      --pieces;
    }
  return pieces;
}

std::vector<int> nodesOf(const Mesh& mesh, const std::vector<Side>& sides) {
  std::vector<int> nodes;
  for (const Side& side : sides) {
    const std::vector<int> more = mesh.nodesOf(side);
    nodes.insert(nodes.end(), more.begin(), more.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

} // namespace Harmos::fem
