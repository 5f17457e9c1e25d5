// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellGraph.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace Harmos::fem {

CellGraph graphOf(const Mesh& mesh) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const auto corners = static_cast<std::size_t>(shapeOf(shape.side).corners);
  using Key = std::array<int, 4>; // corners of a side, sorted; unused ones are -1
  std::vector<std::pair<Key, int>> sides;
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    for (const std::vector<int>& side : shape.sides) {
      Key key = {-1, -1, -1, -1};
      for (std::size_t k = 0; k < corners; ++k)
        key[k] = mesh.cell(c)[side[k]];
      std::sort(key.begin(), key.end());
      sides.emplace_back(key, c);
    }
  std::sort(sides.begin(), sides.end());
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].first == sides[first].first)
      ++last;
    for (std::size_t a = first; a < last; ++a)
      for (std::size_t b = first; b < last; ++b)
        if (a != b)
          pairs.emplace_back(sides[a].second, sides[b].second);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  CellGraph graph;
  graph.offsets.assign(static_cast<std::size_t>(mesh.numberOfCells()) + 1, 0);
  for (const auto& [cell, neighbour] : pairs) {
    ++graph.offsets[static_cast<std::size_t>(cell) + 1];
    graph.neighbours.push_back(neighbour);
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
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
