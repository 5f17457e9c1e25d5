// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mesh.hpp"

#include <numeric>

namespace Harmos::fem {

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
