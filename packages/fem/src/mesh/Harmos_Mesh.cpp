// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mesh.hpp"

namespace Harmos::fem {

std::vector<Side> boundarySides(const Mesh& mesh) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const auto corners = static_cast<std::size_t>(shapeOf(shape.side).corners);
  struct Candidate {
    std::array<int, 4> corners; // sorted; unused ones are -1
    Side side;
  };
  std::vector<Candidate> candidates;
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    for (std::size_t s = 0; s < shape.sides.size(); ++s) {
      Candidate candidate{{-1, -1, -1, -1}, {c, static_cast<int>(s)}};
      for (std::size_t k = 0; k < corners; ++k)
        candidate.corners[k] = mesh.cell(c)[shape.sides[s][k]];
      std::sort(candidate.corners.begin(), candidate.corners.end());
      candidates.push_back(candidate);
    }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.corners, a.side.cell, a.side.side) < std::tie(b.corners, b.side.cell, b.side.side);
  });
  std::vector<Side> result;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const bool shared = (k > 0 && candidates[k - 1].corners == candidates[k].corners) ||
                        (k + 1 < candidates.size() && candidates[k + 1].corners == candidates[k].corners);
    if (!shared)
      result.push_back(candidates[k].side);
  }
  std::sort(result.begin(), result.end(),
            [](const Side& a, const Side& b) { return std::tie(a.cell, a.side) < std::tie(b.cell, b.side); });
  return result;
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
