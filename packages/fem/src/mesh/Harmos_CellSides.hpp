// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::fem {

/// All sides of all cells, those with the same corners next to each other: sides that cells share.
struct MatchedSides {
  std::vector<Side> sides;        ///< groups by rising corners; in a group by cells
  std::vector<std::size_t> first; ///< of each group among them, and the end
};

/// Sorted by counting the sides of each lowest corner first, then the few of one corner: O(n) as long as few
/// sides meet in a node. Local. Guarded by tests/unit/fem/test_cell_sides.cpp.
MatchedSides matchSides(const Mesh& mesh);

/// As boundarySides(mesh) and foldedSides(mesh), where the sides are matched already. Local.
std::vector<Side> boundarySides(const MatchedSides& matched);
std::optional<std::pair<Side, Side>> foldedSides(const Mesh& mesh, const MatchedSides& matched);

} // namespace Harmos::fem
