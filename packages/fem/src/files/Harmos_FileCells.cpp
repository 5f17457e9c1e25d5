// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FileCells.hpp"

#include "Harmos_CellClusters.hpp"
#include "Harmos_Index.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace Harmos::fem::Details {

void dropCopies(const CellShape& shape, std::vector<int>& cells) {
  const auto nodes = at(shape.nodes);
  const std::size_t count = cells.size() / nodes;
  const auto cornersOf = [&](std::size_t cell) {
    std::array<int, 8> corners;
    corners.fill(-1);
    std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(cell * nodes), shape.corners, corners.begin());
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  struct Slot {
    std::uint64_t hash = 0;
    std::size_t cell = 0; // and one; 0: the slot is free
  };
  std::size_t size = 16;
  while (size < 2 * count)
    size *= 2;
  std::vector<Slot> table(size);
  std::size_t kept = 0;
  for (std::size_t cell = 0; cell < count; ++cell) {
    const std::array<int, 8> corners = cornersOf(cell);
    std::uint64_t hash = 0;
    for (int corner : corners)
      hash = (hash ^ static_cast<std::uint64_t>(corner)) * 0x9e3779b97f4a7c15;
    std::size_t slot = hash >> 20 & (size - 1);
    const auto isIt = [&](const Slot& other) {
      return other.hash == hash && cornersOf(other.cell - 1) == corners;
    };
    while (table[slot].cell != 0 && !isIt(table[slot]))
      slot = (slot + 1) & (size - 1);
    if (table[slot].cell != 0)
      continue;
    if (kept != cell)
      std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(cell * nodes), nodes,
                  cells.begin() + static_cast<std::ptrdiff_t>(kept * nodes));
    table[slot] = {hash, ++kept};
  }
  cells.resize(kept * nodes);
}

void putAlongCurve(const CellShape& shape, const std::vector<double>& coordinates, std::vector<int>& cells,
                   std::vector<int>& regions) {
  const auto nodes = at(shape.nodes), corners = at(shape.corners);
  std::vector<Point> centres(cells.size() / nodes, Point{});
  for (std::size_t c = 0; c < centres.size(); ++c)
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t d = 0; d < 3; ++d)
        centres[c][d] += coordinates[3 * at(cells[c * nodes + k]) + d] / static_cast<double>(corners);
  const std::vector<int> cellsBefore = cells, regionsBefore = regions, order = curveThrough(centres);
  for (std::size_t c = 0; c < order.size(); ++c) {
    const auto from = cellsBefore.begin() + static_cast<std::ptrdiff_t>(at(order[c]) * nodes);
    std::copy_n(from, nodes, cells.begin() + static_cast<std::ptrdiff_t>(c * nodes));
    if (!regions.empty())
      regions[c] = regionsBefore[at(order[c])];
  }
}

} // namespace Harmos::fem::Details
