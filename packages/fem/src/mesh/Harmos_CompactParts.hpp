// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellClusters.hpp"

#include <vector>

namespace Harmos::fem {

/// Rounds parts off: Lloyd's sweeps (IEEE Trans. Inf. Theory 28, 1982) from given parts.
///
/// A sweep takes the centroids of the parts and moves each cell that has a side in common with another part
/// to the nearest one of those, as long as cells move. Distances are powers, |x − c|² − w, whose weights w
/// shrink parts that are larger than they were at first and let smaller ones grow (Aurenhammer, Hoffmann,
/// Aronov, Algorithmica 20, 1998). In the end each cell joins the part that most of its sides look at.
///
/// Only parts that touch a cell are candidates for it, so that no part reaches across a slit or a hole;
/// a sweep passes over the cells that have such sides, and over all cells once at first, O(n).
///
/// Why: parts of a graph partitioner are balanced and have short boundaries, but some are ragged, held to
/// themselves by few sides. Such a part is soft: the Dirichlet-preconditioned dual operator has an eigenvalue
/// of its own for each, and counts of iterations grow with the number of parts.
///
/// @param labels part of each cell, from 0 to parts − 1; no part is empty,
/// before and after. @param clusters null, or clusters with one label each: most sweeps are theirs, and few
/// are left for the cells. Local. Guarded by tests/unit/fem/test_compact_parts.cpp.
void roundOff(const CellGraph& graph, int parts, std::vector<int>& labels,
              const CellClusters* clusters = nullptr);

} // namespace Harmos::fem
