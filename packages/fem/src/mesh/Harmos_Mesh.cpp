// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mesh.hpp"

namespace Harmos::fem {

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
