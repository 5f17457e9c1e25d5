// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellGraph.hpp"

#include <limits>
#include <vector>

namespace Harmos::fem {

/// The narrowest place that was found in a part: where few sides hold one side of it to the other.
struct Neck {
  /// Sides across, over the cells of the smaller side to the power (d − 1)/d in d dimensions: about as many
  /// as lie across a ball of so many. Infinite if the part has too few cells to have a neck; 0 if it does not
  /// hang together.
  double width = std::numeric_limits<double>::infinity();
  std::vector<int> cells; ///< of the smaller side, rising
};

/// Parts with a neck below it are ragged. Measured on half a ball and half a disc, four seeds, 24 to 384
/// parts of 260 to 8800 cells: compact parts have 0.69 and more, half of them more than 1.02. Of METIS' parts
/// half have more than 0.75, one in fifty of 384 has less than 0.4, the worst 0.08. A straight bar of
/// triangles is ragged when it is six times as long as wide.
constexpr double raggedNeck = 0.4;

/// Looks for the necks of parts. O(cells). Deterministic. Local.
///
/// A few tens of Chebyshev steps on the part's graph, begun with the coordinates and the square of the
/// distance from the middle, leave of them what varies slowest (approximate Fiedler vectors; a spectral
/// partitioner would cut there: Pothen, Simon, Liou, SIAM J. Matrix Anal. Appl. 11, 1990). In the order of
/// each of them all cuts in two are tried. Either side of a neck hangs together and has a twentieth of the
/// cells or more.
///
/// Guarded by tests/unit/fem/test_part_shape.cpp.
class PartShapes {
 public:
  /// Keeps a reference to the graph.
  explicit PartShapes(const CellGraph& graph);

  /// @param cells of the part.
  Neck neckOf(const std::vector<int>& cells);

 private:
  const CellGraph& graph_;
  std::vector<int> number_; // of each cell within the part that is looked at; else -1
};

/// The cells of each part, rising.
std::vector<std::vector<int>> cellsOf(const std::vector<int>& labels, int parts);

/// The width of the neck of each part; infinite for parts that have no other beside them, which no other cut
/// would change. Local.
std::vector<double> neckWidths(const CellGraph& graph, const std::vector<int>& labels, int parts);

/// Mends ragged parts: the smaller side of the neck goes to a part beside it, first to the one with which it
/// shares most sides. Nothing is done that would make a part ragged, or larger than 1.5 times the average.
///
/// @param labels part of each cell, from 0 to parts − 1; each part hangs together, before and after.
/// @param necks their widths; changed with the labels.
/// @return how many parts gave cells away. Local.
int mendNecks(const CellGraph& graph, std::vector<int>& labels, std::vector<double>& necks);

} // namespace Harmos::fem
