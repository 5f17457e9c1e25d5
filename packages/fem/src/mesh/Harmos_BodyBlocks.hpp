// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"

#include <string>
#include <vector>

namespace Harmos::fem {

/// Puts the blocks of each body together: those of one name that follow each other. Local.
std::vector<std::vector<BodyMesh>> groupedByBody(std::vector<BodyMesh> blocks);

/// Makes one body of blocks, each with the cells of one type, that share nodes by BodyMesh::numbers.
///
/// Sides that two blocks share are inside the body: they leave the named boundary parts, and their nodes stay
/// as named nodes. Nodes of a named part that another block has too are named nodes there, as all copies of a
/// node are in the same sets. Fields stay if all blocks have them. A single block stays as it is. Local,
/// O(n log n) in the sides on the boundaries of the blocks.
///
/// Guarded by tests/unit/fem/test_body_blocks.cpp.
///
/// @param blocks with matched sides. @param place for messages: "in "file.msh", body "ring"".
/// @throws InputError where sides of two blocks overlap without having the same nodes: a quadrilateral beside
/// triangles, nodes on the middle of an edge on one side alone; where blocks lie on the same side of a common
/// side, or more than two meet at one.
void joinBlocks(std::vector<BodyMesh>& blocks, const std::string& place);

/// Parts for each block of a body, by their numbers of cells: at least one each, else as many as wanted in
/// all. Local. @throws InputError if more are wanted than there are cells.
std::vector<int> partsOfBlocks(const std::vector<BodyMesh>& blocks, int wanted);

/// The number of pieces of a body that share no node with each other. Local.
int numberOfPieces(const std::vector<BodyMesh>& blocks);

/// Nodes of the body. Local.
int numberOfNodes(const std::vector<BodyMesh>& blocks);

} // namespace Harmos::fem
