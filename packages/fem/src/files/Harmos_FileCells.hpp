// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <vector>

namespace Harmos::fem::Details {

/// Of cells with the same corners the first one stays. O(cells). Local.
/// @param cells their nodes, one cell after the other.
void dropCopies(const CellShape& shape, std::vector<int>& cells);

/// Puts cells, and their regions, in the order of curveThrough() their centres: what follows goes through
/// memory in this order. O(cells). Local.
/// @param coordinates three of each node. @param regions of the cells, or none.
void putAlongCurve(const CellShape& shape, const std::vector<double>& coordinates, std::vector<int>& cells,
                   std::vector<int>& regions);

} // namespace Harmos::fem::Details
