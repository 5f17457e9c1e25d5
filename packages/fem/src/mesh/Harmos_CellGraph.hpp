// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellSides.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::fem {

/// The cells that share a side, cell by cell, and where they are.
struct CellGraph {
  std::vector<std::size_t> offsets;
  std::vector<int> neighbours; ///< rising
  std::vector<Point> centres;  ///< the mean of each cell's corners
  int dimension = 0;

  int cells() const { return static_cast<int>(offsets.size()) - 1; }
  const int* begin(int cell) const { return neighbours.data() + offsets[static_cast<std::size_t>(cell)]; }
  const int* end(int cell) const { return neighbours.data() + offsets[static_cast<std::size_t>(cell) + 1]; }
};

/// Of cells that share all corners of a side. See matchSides() for the cost. Local.
CellGraph graphOf(const Mesh& mesh, const MatchedSides& sides);
CellGraph graphOf(const Mesh& mesh);

/// Cells that hang together and have one label.
struct Components {
  std::vector<int> of;                 ///< of each cell
  std::vector<std::vector<int>> cells; ///< rising; components in the order of their lowest cells
};

/// @param labels of each cell. Local.
Components componentsOf(const CellGraph& graph, const std::vector<int>& labels);

} // namespace Harmos::fem
