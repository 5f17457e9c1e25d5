// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"

#include <string>
#include <vector>

namespace Harmos::app {

/// How well the cells of a mesh are shaped: 1 for equilateral simplices and for squares and cubes, 0 for
/// cells without size. Of simplices the size by that of the equilateral one of the same mean square edge
/// (Parthasarathy, Graichen, Hathaway, Finite Elem. Anal. Des. 15, 1994); of others the smallest determinant
/// of unit edges at a corner.
struct Quality {
  double least = 1.0, mean = 0.0;
  int worst = 0; ///< cell
};

Quality qualityOf(const fem::Mesh& mesh);

/// Boundary parts of two bodies that lie at each other.
struct TouchingParts {
  std::string first, second; ///< "body/part"
  int facets = 0, of = 0;    ///< of the first one: those near the second, all
};

/// Pairs of parts of different bodies with facets whose boxes, widened by a thousandth of the extent of all,
/// meet.
/// @param bodies the blocks of each, see fem::joinBlocks().
std::vector<TouchingParts> touchingParts(const std::vector<std::vector<fem::BodyMesh>>& bodies);

/// What a mesh file holds, for people.
std::string reportOf(const std::vector<std::vector<fem::BodyMesh>>& bodies);

} // namespace Harmos::app
