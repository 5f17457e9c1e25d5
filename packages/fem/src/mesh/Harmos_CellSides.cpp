// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellSides.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace Harmos::fem {

std::vector<CornerSide> sidesByCorners(const Mesh& mesh) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const auto corners = at(shapeOf(shape.side).corners);
  const std::size_t lowest = 4 - corners; // among them
  const auto visit = [&](const auto& take) {
    for (int c = 0; c < mesh.numberOfCells(); ++c)
      for (std::size_t s = 0; s < shape.sides.size(); ++s) {
        CornerSide side{{-1, -1, -1, -1}, {c, static_cast<int>(s)}};
        for (std::size_t k = 0; k < corners; ++k)
          side.corners[k] = mesh.cell(c)[shape.sides[s][k]];
        std::sort(side.corners.begin(), side.corners.end());
        take(side);
      }
  };
  std::vector<std::ptrdiff_t> first(at(mesh.numberOfNodes()) + 1, 0);
  visit([&](const CornerSide& side) { ++first[at(side.corners[lowest]) + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<CornerSide> sides(at(first.back()));
  std::vector<std::ptrdiff_t> next(first.begin(), first.end() - 1);
  visit([&](const CornerSide& side) { sides[at(next[at(side.corners[lowest])]++)] = side; });
  for (std::size_t corner = 0; corner + 1 < first.size(); ++corner)
    std::sort(sides.begin() + first[corner], sides.begin() + first[corner + 1],
              [](const CornerSide& a, const CornerSide& b) {
                return std::tie(a.corners, a.side.cell, a.side.side) <
                       std::tie(b.corners, b.side.cell, b.side.side);
              });
  return sides;
}

} // namespace Harmos::fem
