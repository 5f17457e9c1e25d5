// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellGraph.hpp"
#include "Harmos_Partition.hpp"

#include <string>
#include <vector>

namespace Harmos::fem::Details {

/// Cells in a cluster, for a body that is cut into so many parts; 1: it is cut cell by cell.
int clusterSize(int cells, int parts, PartitionMethod method);

/// How many of the wanted parts each component gets: one at least, the others one by one to the component
/// with the largest parts.
std::vector<int> sharedOut(int wanted, const std::vector<std::vector<int>>& components);

/// As mendParts(), on the graph.
Partition mended(const CellGraph& graph, const std::vector<int>& labels);

/// A note that continues "Body X".
std::string otherThanWanted(int parts, int wanted);

/// A few compact pieces that hang together, to be cut further by themselves. Not always as many as wanted;
/// none of a graph in components. @param graph its cells along a curve, see reordered().
Partition fewPieces(const CellGraph& graph, int wanted, int seed);

/// As partitionCells(), of cells in the order of the graph. Notes continue "Body X".
Partition partition(const CellGraph& graph, int wanted, int clusterSize, const PartitionOptions& options);

} // namespace Harmos::fem::Details
