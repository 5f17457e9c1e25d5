// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <array>
#include <vector>

namespace Harmos::fem {

/// A side of a cell by its corners, which are those of the side of the cell beside it too.
struct CornerSide {
  std::array<int, 4> corners; ///< rising; before them −1 for those that a side of fewer does not have
  Side side;
};

/// All sides of all cells by rising corners: those with the same ones next to each other, by their cells.
///
/// Sorted by counting the sides of each lowest corner first, then the few of one corner: O(n) as long as few
/// sides meet in a node. Local. Guarded by tests/unit/fem/test_cell_sides.cpp.
std::vector<CornerSide> sidesByCorners(const Mesh& mesh);

} // namespace Harmos::fem
