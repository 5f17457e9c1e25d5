// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellSides.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::fem {

/// A whole body, as a file or a generator gives it, or a block of one: on one rank only. A body with cells of
/// several types has a block of each; see joinBlocks().
struct BodyMesh {
  std::string name;
  Mesh mesh;                                         ///< boundary: all nodes on the body's boundary
  std::vector<std::string> regions;                  ///< names of the regions that mesh.regions counts
  std::map<std::string, std::vector<Side>> sides;    ///< named boundary parts
  std::map<std::string, std::vector<int>> nodes;     ///< named points, which are no sides
  std::map<std::string, std::vector<double>> fields; ///< named values of all nodes
  std::shared_ptr<const MatchedSides> matched;       ///< of the mesh, where they are known already; or null
  /// Of a block: the numbers of its nodes in the body, rising; blocks share nodes. Empty: the only block.
  std::vector<int> numbers;
  bool isAlongCurve = false; ///< whether cells come in the order of curveThrough()

  int number(int node) const { return numbers.empty() ? node : numbers[static_cast<std::size_t>(node)]; }
};

} // namespace Harmos::fem
