// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellGraph.hpp"

#include <vector>

namespace Harmos::fem {

/// Small groups of cells that hang together, and the graph of these groups. A body is cut on it first: what
/// is found there is a good cut of the cells but for its ragged edges, at a fraction of the time.
struct CellClusters {
  std::vector<int> of;    ///< of each cell
  std::vector<int> sizes; ///< cells of each cluster
  CellGraph graph; ///< clusters that share sides of cells; their centres are means of those of the cells
  std::vector<int> sides; ///< how many, beside graph.neighbours
};

/// Groups of up to `size` cells, in the order of the cells: each takes cells next to its own that no other
/// has. O(n). Deterministic. Local. Guarded by tests/unit/fem/test_cell_sides.cpp.
CellClusters clustersOf(const CellGraph& graph, int size);

/// The points along a space-filling curve (Morton's): neighbours in space are neighbours there. O(n). Local.
std::vector<int> curveThrough(const std::vector<Point>& points);

/// The same graph with its cells in another order. Memory is read from near one place to the next where it is
/// that of a curve: passes over the cells of meshes, whose order means little, take two thirds of the time.
/// @param order of each new cell the old one. Local.
CellGraph reordered(const CellGraph& graph, const std::vector<int>& order);

} // namespace Harmos::fem
