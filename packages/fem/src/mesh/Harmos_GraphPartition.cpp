// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GraphPartition.hpp"

#include "Harmos_CellClusters.hpp"
#include "Harmos_CompactParts.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_PartShape.hpp"

#include <metis.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>

namespace Harmos::fem::Details {
namespace {

// What is cut: cells, or clusters of them with weights.
struct Graph {
  const CellGraph& graph;
  const CellClusters* clusters; // null: cells
};

// METIS' parts of some vertices that hang together, written into labels from `firstLabel` on.
void cut(const Graph& whole, const std::vector<int>& vertices, int parts, int firstLabel, int seed,
         std::vector<int>& labels) {
  const CellGraph& graph = whole.graph;
  std::vector<idx_t> number(static_cast<std::size_t>(graph.cells()), -1);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    number[static_cast<std::size_t>(vertices[k])] = static_cast<idx_t>(k);
  std::vector<idx_t> offsets = {0}, neighbours, part(vertices.size(), 0), sizes, sides;
  for (int vertex : vertices) {
    for (const int* other = graph.begin(vertex); other != graph.end(vertex); ++other) {
      neighbours.push_back(number[static_cast<std::size_t>(*other)]);
      if (whole.clusters != nullptr)
        sides.push_back(whole.clusters->sides[static_cast<std::size_t>(other - graph.neighbours.data())]);
    }
    offsets.push_back(static_cast<idx_t>(neighbours.size()));
    if (whole.clusters != nullptr)
      sizes.push_back(whole.clusters->sizes[static_cast<std::size_t>(vertex)]);
  }
  idx_t count = static_cast<idx_t>(vertices.size()), constraints = 1, wanted = parts, edgeCut = 0;
  std::array<idx_t, METIS_NOPTIONS> options;
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = seed;
  options[METIS_OPTION_NUMBERING] = 0;
  // Of clusters roundOff() and mended() see to it in the end, in 0.9 of the time.
  options[METIS_OPTION_CONTIG] = whole.clusters == nullptr ? 1 : 0;
  const auto orNull = [](std::vector<idx_t>& v) { return v.empty() ? nullptr : v.data(); };
  const int status =
      METIS_PartGraphKway(&count, &constraints, offsets.data(), neighbours.data(), orNull(sizes), nullptr,
                          orNull(sides), &wanted, nullptr, nullptr, options.data(), &edgeCut, part.data());
  HARMOS_REQUIRE(status == METIS_OK, "METIS failed with status " + std::to_string(status));
  for (std::size_t k = 0; k < vertices.size(); ++k)
    labels[static_cast<std::size_t>(vertices[k])] = firstLabel + static_cast<int>(part[k]);
}

} // namespace

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

namespace {

int rootOf(const std::vector<int>& parent, int k) {
  while (parent[static_cast<std::size_t>(k)] != k)
    k = parent[static_cast<std::size_t>(k)];
  return k;
}

} // namespace

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
    result.notes.push_back("Parts in pieces without common sides: " + std::to_string(alone) +
                           " pieces became separate parts, " + std::to_string(joined) +
                           " tiny pieces joined a neighbour.");
  std::vector<int> numbers(count, -1);
  for (std::size_t cell = 0; cell < labels.size(); ++cell) {
    int& number = numbers[at(rootOf(parent, pieces.of[cell]))];
    if (number < 0)
      number = result.parts++;
    result.part.push_back(number);
  }
  return result;
}

// Bodies of fewer cells are cut in no time, and small parts would have ragged edges of large clusters.
int clusterSize(int cells, int parts, PartitionMethod method) {
  constexpr int fewest = 30000, largest = 8, ofPart = 64; // clusters, at least
  return method == PartitionMethod::Compact && cells >= fewest ? std::min(largest, cells / parts / ofPart)
                                                               : 1;
}

namespace {

// The clusters of some cells, rising.
std::vector<int> clustersOf(const std::vector<int>& cells, const CellClusters& clusters) {
  std::vector<char> isOne(clusters.sizes.size(), 0);
  for (int cell : cells)
    isOne[static_cast<std::size_t>(clusters.of[static_cast<std::size_t>(cell)])] = 1;
  std::vector<int> result;
  for (std::size_t cluster = 0; cluster < isOne.size(); ++cluster)
    if (isOne[cluster] != 0)
      result.push_back(static_cast<int>(cluster));
  return result;
}

// Part of each cell. @param parts of each component. @param label receives their number.
std::vector<int> cutComponents(const CellGraph& graph, const CellClusters* clusters,
                               const Components& components, const std::vector<int>& parts, int seed,
                               int& label) {
  const Graph whole = {clusters != nullptr ? clusters->graph : graph, clusters};
  std::vector<int> labels(static_cast<std::size_t>(whole.graph.cells()), 0);
  for (std::size_t k = 0; k < components.cells.size(); ++k) {
    const std::vector<int> vertices =
        clusters == nullptr ? components.cells[k] : clustersOf(components.cells[k], *clusters);
    if (parts[k] == 1)
      for (int vertex : vertices)
        labels[static_cast<std::size_t>(vertex)] = label;
    else
      cut(whole, vertices, parts[k], label, seed, labels);
    label += parts[k];
  }
  if (clusters == nullptr)
    return labels;
  std::vector<int> ofCells;
  ofCells.reserve(clusters->of.size());
  for (int cluster : clusters->of)
    ofCells.push_back(labels[static_cast<std::size_t>(cluster)]);
  return ofCells;
}

} // namespace

std::string otherThanWanted(int parts, int wanted) {
  return " is partitioned into " + std::to_string(parts) + " parts instead of " + std::to_string(wanted) +
         ".";
}

Partition fewPieces(const CellGraph& graph, int wanted, int seed) {
  constexpr int cells = 8; // a cluster
  const Components whole = componentsOf(graph, std::vector<int>(static_cast<std::size_t>(graph.cells()), 0));
  if (whole.cells.size() > 1)
    return {};
  const CellClusters clusters = clustersOf(graph, cells);
  int label = 0;
  std::vector<int> labels = cutComponents(graph, &clusters, whole, {wanted}, seed, label);
  roundOff(graph, label, labels, &clusters);
  return mended(graph, labels);
}

Partition partition(const CellGraph& graph, int wanted, int clusterSize, const PartitionOptions& options) {
  const Components whole = componentsOf(graph, std::vector<int>(static_cast<std::size_t>(graph.cells()), 0));
  std::optional<CellClusters> clusters;
  if (clusterSize > 1)
    clusters = clustersOf(graph, clusterSize);
  int label = 0;
  std::vector<int> labels = cutComponents(graph, clusters ? &*clusters : nullptr, whole,
                                          sharedOut(wanted, whole.cells), options.seed, label);
  if (options.method == PartitionMethod::Compact)
    roundOff(graph, label, labels, clusters ? &*clusters : nullptr);
  Partition result = mended(graph, labels);
  result.necks = neckWidths(graph, result.part, result.parts);
  if (options.method == PartitionMethod::Compact)
    mendNecks(graph, result.part, result.necks);
  for (std::string& note : result.notes)
    note.insert(0, ": ");
  if (const std::size_t components = whole.cells.size(); components > 1)
    result.notes.insert(result.notes.begin(),
                        " consists of " + std::to_string(components) +
                            " components without common sides; each is partitioned separately.");
  if (result.parts != wanted)
    result.notes.push_back(otherThanWanted(result.parts, wanted));
  return result;
}

} // namespace Harmos::fem::Details
