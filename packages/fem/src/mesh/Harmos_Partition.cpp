// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Partition.hpp"

#include "Harmos_Errors.hpp"

#include <metis.h>

#include <array>
#include <numeric>

namespace Harmos::fem {
namespace {

/// The cells that share a side, cell by cell.
struct CellGraph {
  std::vector<std::size_t> offsets;
  std::vector<int> neighbours;

  int cells() const { return static_cast<int>(offsets.size()) - 1; }
  const int* begin(int cell) const { return neighbours.data() + offsets[static_cast<std::size_t>(cell)]; }
  const int* end(int cell) const { return neighbours.data() + offsets[static_cast<std::size_t>(cell) + 1]; }
};

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

/// Cells that hang together and have one label.
struct Components {
  std::vector<int> of;                 // of each cell
  std::vector<std::vector<int>> cells; // rising; components in the order of their lowest cells
};

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

// METIS' parts of some cells that hang together, written into labels from `firstLabel` on.
void cut(const CellGraph& graph, const std::vector<int>& cells, int parts, int firstLabel,
         std::vector<int>& labels) {
  std::vector<idx_t> number(static_cast<std::size_t>(graph.cells()), -1);
  for (std::size_t k = 0; k < cells.size(); ++k)
    number[static_cast<std::size_t>(cells[k])] = static_cast<idx_t>(k);
  std::vector<idx_t> offsets = {0}, neighbours, part(cells.size(), 0);
  for (int cell : cells) {
    for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
      neighbours.push_back(number[static_cast<std::size_t>(*other)]);
    offsets.push_back(static_cast<idx_t>(neighbours.size()));
  }
  idx_t vertices = static_cast<idx_t>(cells.size()), constraints = 1, wanted = parts, edgeCut = 0;
  std::array<idx_t, METIS_NOPTIONS> options;
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_CONTIG] = 1;
  const int status =
      METIS_PartGraphKway(&vertices, &constraints, offsets.data(), neighbours.data(), nullptr, nullptr,
                          nullptr, &wanted, nullptr, nullptr, options.data(), &edgeCut, part.data());
  HARMOS_REQUIRE(status == METIS_OK, "METIS failed with status " + std::to_string(status));
  for (std::size_t k = 0; k < cells.size(); ++k)
    labels[static_cast<std::size_t>(cells[k])] = firstLabel + static_cast<int>(part[k]);
}

// At least one part each, the others one by one to the component with the largest parts.
std::vector<int> sharedOut(int wanted, const std::vector<std::vector<int>>& components) {
  std::vector<int> parts(components.size(), 1);
  for (int left = wanted - static_cast<int>(components.size()); left > 0; --left) {
    std::size_t best = 0;
    double size = 0.0;
    for (std::size_t k = 0; k < components.size(); ++k) {
      const double candidate = static_cast<double>(components[k].size()) / parts[k];
      if (candidate > size) {
        best = k;
        size = candidate;
      }
    }
    ++parts[best];
  }
  return parts;
}

int rootOf(const std::vector<int>& parent, int k) {
  while (parent[static_cast<std::size_t>(k)] != k)
    k = parent[static_cast<std::size_t>(k)];
  return k;
}

Partition mended(const CellGraph& graph, const std::vector<int>& labels) {
  const Components pieces = componentsOf(graph, labels);
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const auto count = pieces.cells.size();
  Partition result;
  std::map<int, std::size_t> largest; // piece of each label
  for (std::size_t k = 0; k < count; ++k) {
    const auto [place, isNew] = largest.emplace(labels[at(pieces.cells[k].front())], k);
    if (!isNew && pieces.cells[k].size() > pieces.cells[place->second].size())
      place->second = k;
  }
  constexpr double tiny = 0.1;
  const double averageSize = static_cast<double>(labels.size()) / static_cast<double>(largest.size());
  std::vector<int> parent(count); // pieces that are one part
  std::iota(parent.begin(), parent.end(), 0);
  std::size_t joined = 0, alone = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<int>& cells = pieces.cells[k];
    if (largest.at(labels[at(cells.front())]) == k)
      continue;
    std::map<int, int> shared; // sides with each other part
    if (static_cast<double>(cells.size()) < tiny * averageSize)
      for (int cell : cells)
        for (const int* other = graph.begin(cell); other != graph.end(cell); ++other) {
          const int root = rootOf(parent, pieces.of[at(*other)]);
          if (root != rootOf(parent, static_cast<int>(k)))
            ++shared[root];
        }
    const auto best = std::max_element(shared.begin(), shared.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (best == shared.end()) {
      ++alone;
      continue;
    }
    parent[at(rootOf(parent, static_cast<int>(k)))] = best->first;
    ++joined;
  }
  if (alone + joined > 0)
    result.notes.push_back("Parts were in pieces that share no side: " + std::to_string(alone) +
                           " of the pieces became parts of their own, " + std::to_string(joined) +
                           " tiny ones joined a neighbour.");
  std::vector<int> numbers(count, -1);
  for (std::size_t cell = 0; cell < labels.size(); ++cell) {
    int& number = numbers[at(rootOf(parent, pieces.of[cell]))];
    if (number < 0)
      number = result.parts++;
    result.part.push_back(number);
  }
  return result;
}

} // namespace

Partition partitionCells(const BodyMesh& body, int wanted) {
  const int cells = body.mesh.numberOfCells();
  if (wanted < 1 || wanted > cells)
    throw InputError("body \"" + body.name + "\" cannot be cut into " + std::to_string(wanted) +
                     " parts: it has " + std::to_string(cells) +
                     " cells. Ask for at least one part and at most as many as there are cells");
  const CellGraph graph = graphOf(body.mesh);
  const Components whole = componentsOf(graph, std::vector<int>(static_cast<std::size_t>(cells), 0));
  const auto components = static_cast<int>(whole.cells.size());
  std::vector<std::string> notes;
  if (components > 1)
    notes.push_back("Body \"" + body.name + "\" consists of " + std::to_string(components) +
                    " components that share no side; each is cut by itself.");
  const std::vector<int> shares = sharedOut(wanted, whole.cells);
  std::vector<int> labels(static_cast<std::size_t>(cells), 0);
  int label = 0;
  for (std::size_t k = 0; k < whole.cells.size(); ++k) {
    if (shares[k] == 1)
      for (int cell : whole.cells[k])
        labels[static_cast<std::size_t>(cell)] = label;
    else
      cut(graph, whole.cells[k], shares[k], label, labels);
    label += shares[k];
  }
  Partition result = mended(graph, labels);
  for (std::string& note : result.notes)
    note = "Body \"" + body.name + "\": " + note;
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  if (result.parts != wanted)
    result.notes.push_back("Body \"" + body.name + "\" is cut into " + std::to_string(result.parts) +
                           " parts in the place of " + std::to_string(wanted) + ".");
  return result;
}

Partition mendParts(const BodyMesh& body, const std::vector<int>& part) {
  HARMOS_REQUIRE(static_cast<int>(part.size()) == body.mesh.numberOfCells(), "each cell needs a part");
  return mended(graphOf(body.mesh), part);
}

} // namespace Harmos::fem
