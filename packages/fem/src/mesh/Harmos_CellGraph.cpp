// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellGraph.hpp"

#include "Harmos_CellSides.hpp"
#include "Harmos_Index.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace Harmos::fem {

CellGraph graphOf(const Mesh& mesh) {
  const std::vector<CornerSide> sides = sidesByCorners(mesh);
  const auto overPairs = [&](const auto& visit) { // of cells that share a side, both ways round
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
      while (last < sides.size() && sides[last].corners == sides[first].corners)
        ++last;
      for (std::size_t a = first; a < last; ++a)
        for (std::size_t b = first; b < last; ++b)
          if (a != b)
            visit(at(sides[a].side.cell), sides[b].side.cell);
    }
  };
  std::vector<std::ptrdiff_t> first(at(mesh.numberOfCells()) + 1, 0);
  overPairs([&](std::size_t cell, int) { ++first[cell + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<int> all(at(first.back()));
  std::vector<std::ptrdiff_t> next(first.begin(), first.end() - 1);
  overPairs([&](std::size_t cell, int other) { all[at(next[cell]++)] = other; });
  CellGraph graph;
  graph.offsets.push_back(0);
  graph.neighbours.reserve(all.size());
  for (std::size_t cell = 0; cell + 1 < first.size(); ++cell) {
    const auto begin = all.begin() + first[cell], end = all.begin() + first[cell + 1];
    std::sort(begin, end);
    std::unique_copy(begin, end, std::back_inserter(graph.neighbours)); // cells may share two sides
    graph.offsets.push_back(graph.neighbours.size());
  }
  return graph;
}

std::vector<Point> centresOf(const Mesh& mesh) {
  const auto corners = shapeOf(mesh.cellType).corners;
  std::vector<Point> centres(static_cast<std::size_t>(mesh.numberOfCells()), Point{});
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    for (int k = 0; k < static_cast<int>(corners); ++k) {
      const Point x = mesh.local(mesh.cell(c)[k]);
      for (std::size_t d = 0; d < 3; ++d)
        centres[static_cast<std::size_t>(c)][d] += x[d] / static_cast<double>(corners);
    }
  }
  return centres;
}

Components componentsOf(const CellGraph& graph, const std::vector<int>& labels) {
  Components components;
  components.of.assign(labels.size(), -1);
  const auto at = [](int cell) { return static_cast<std::size_t>(cell); };
  for (int first = 0; first < graph.cells(); ++first) {
    if (components.of[at(first)] >= 0)
      continue;
    const int component = static_cast<int>(components.cells.size());
    std::vector<int> cells = {first};
    components.of[at(first)] = component;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const int cell = cells[k];
      for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
        if (components.of[at(*other)] < 0 && labels[at(*other)] == labels[at(cell)]) {
          components.of[at(*other)] = component;
          cells.push_back(*other);
        }
    }
    std::sort(cells.begin(), cells.end());
    components.cells.push_back(std::move(cells));
  }
  return components;
}

} // namespace Harmos::fem
