// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellGraph.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace Harmos::fem {

namespace {

std::vector<Point> centresOf(const Mesh& mesh) {
  const auto corners = at(shapeOf(mesh.cellType).corners), dimension = at(mesh.dimension());
  const double share = 1.0 / static_cast<double>(corners);
  std::vector<Point> centres(at(mesh.numberOfCells()), Point{});
  for (std::size_t c = 0; c < centres.size(); ++c) {
    const int* cell = mesh.cell(static_cast<int>(c));
    for (std::size_t k = 0; k < corners; ++k) {
      const double* x = mesh.coordinates.data() + at(cell[k]) * dimension;
      for (std::size_t d = 0; d < dimension; ++d)
        centres[c][d] += share * x[d];
    }
  }
  return centres;
}

} // namespace

CellGraph graphOf(const Mesh& mesh, const MatchedSides& sides) {
  const auto overPairs = [&](const auto& visit) { // of cells that share a side, both ways round
    for (std::size_t group = 0; group + 1 < sides.first.size(); ++group)
      for (std::size_t a = sides.first[group]; a < sides.first[group + 1]; ++a)
        for (std::size_t b = sides.first[group]; b < sides.first[group + 1]; ++b)
          if (a != b)
            visit(at(sides.sides[a].cell), sides.sides[b].cell);
  };
  std::vector<std::ptrdiff_t> first(at(mesh.numberOfCells()) + 1, 0);
  overPairs([&](std::size_t cell, int) { ++first[cell + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<int> all(at(first.back()));
  std::vector<std::ptrdiff_t> next(first.begin(), first.end() - 1);
  overPairs([&](std::size_t cell, int other) { all[at(next[cell]++)] = other; });
  CellGraph graph;
  graph.centres = centresOf(mesh);
  graph.dimension = mesh.dimension();
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

CellGraph graphOf(const Mesh& mesh) {
  return graphOf(mesh, matchSides(mesh));
}

Components componentsOf(const CellGraph& graph, const std::vector<int>& labels) {
  Components components;
  components.of.assign(labels.size(), -1);
  std::vector<int> cells; // of one component
  for (int first = 0; first < graph.cells(); ++first) {
    if (components.of[at(first)] >= 0)
      continue;
    const int component = static_cast<int>(components.cells.size());
    cells = {first};
    components.of[at(first)] = component;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const int cell = cells[k];
      for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
        if (components.of[at(*other)] < 0 && labels[at(*other)] == labels[at(cell)]) {
          components.of[at(*other)] = component;
          cells.push_back(*other);
        }
    }
    components.cells.emplace_back().reserve(cells.size());
  }
  for (std::size_t cell = 0; cell < labels.size(); ++cell)
    components.cells[at(components.of[cell])].push_back(static_cast<int>(cell));
  return components;
}

} // namespace Harmos::fem
