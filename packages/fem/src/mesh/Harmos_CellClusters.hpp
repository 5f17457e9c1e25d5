// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellGraph.hpp"

#include <vector>

namespace Harmos::fem {

/// Small groups of cells that hang together, and the graph of these groups. A body is cut on it first: what
/// is found there is a good cut of the cells but for its ragged edges, at a fraction of the time.
struct CellClusters {
  std::vector<int> of;        ///< of each cell
  std::vector<int> sizes;     ///< cells of each cluster
  std::vector<Point> centres; ///< means of the centres of its cells
  CellGraph graph;            ///< clusters that share sides of cells,
  std::vector<int> sides;     ///< how many, beside graph.neighbours
};

/// Groups of up to `size` cells, one after the other along a space-filling curve (Morton's): each takes cells
/// next to its own that no other has. O(n log n). Deterministic. Local. Guarded by
/// tests/unit/fem/test_cell_sides.cpp.
/// @param centres of the cells.
CellClusters clustersOf(const CellGraph& graph, const std::vector<Point>& centres, int size);

} // namespace Harmos::fem
