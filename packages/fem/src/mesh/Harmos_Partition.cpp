// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Partition.hpp"

#include "Harmos_CellGraph.hpp"
#include "Harmos_CompactParts.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_PartShape.hpp"

#include <metis.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace Harmos::fem {
namespace {

// METIS' parts of some cells that hang together, written into labels from `firstLabel` on.
void cut(const CellGraph& graph, const std::vector<int>& cells, int parts, int firstLabel, int seed,
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
  options[METIS_OPTION_SEED] = seed;
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

// Numbers parts in the order of their lowest cells.
void number(Partition& partition) {
  std::vector<int> numbers(static_cast<std::size_t>(partition.parts), -1);
  std::vector<double> necks;
  for (int& part : partition.part) {
    int& renumbered = numbers[static_cast<std::size_t>(part)];
    if (renumbered < 0) {
      renumbered = static_cast<int>(necks.size());
      necks.push_back(partition.necks[static_cast<std::size_t>(part)]);
    }
    part = renumbered;
  }
  partition.necks = necks;
}

} // namespace

Partition partitionCells(const BodyMesh& body, int wanted, const PartitionOptions& options) {
  const int cells = body.mesh.numberOfCells();
  if (wanted < 1 || wanted > cells)
    throw InputError("body \"" + body.name + "\" cannot be partitioned into " + std::to_string(wanted) +
                     " parts: it has " + std::to_string(cells) +
                     " cells. Choose between 1 and that many parts");
  const CellGraph graph = graphOf(body.mesh);
  const Components whole = componentsOf(graph, std::vector<int>(static_cast<std::size_t>(cells), 0));
  const auto components = static_cast<int>(whole.cells.size());
  std::vector<std::string> notes;
  if (components > 1)
    notes.push_back("Body \"" + body.name + "\" consists of " + std::to_string(components) +
                    " components without common sides; each is partitioned separately.");
  const std::vector<int> shares = sharedOut(wanted, whole.cells);
  std::vector<int> labels(static_cast<std::size_t>(cells), 0);
  int label = 0;
  for (std::size_t k = 0; k < whole.cells.size(); ++k) {
    if (shares[k] == 1)
      for (int cell : whole.cells[k])
        labels[static_cast<std::size_t>(cell)] = label;
    else
      cut(graph, whole.cells[k], shares[k], label, options.seed, labels);
    label += shares[k];
  }
  if (options.method == PartitionMethod::Compact)
    roundOff(body.mesh, graph, label, labels);
  Partition result = mended(graph, labels);
  result.necks = neckWidths(body.mesh, graph, result.part, result.parts);
  if (options.method == PartitionMethod::Compact &&
      mendNecks(body.mesh, graph, result.part, result.necks) > 0)
    number(result);
  for (std::string& note : result.notes)
    note = "Body \"" + body.name + "\": " + note;
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  if (result.parts != wanted)
    result.notes.push_back("Body \"" + body.name + "\" is partitioned into " + std::to_string(result.parts) +
                           " parts instead of " + std::to_string(wanted) + ".");
  return result;
}

Partition mendParts(const BodyMesh& body, const std::vector<int>& part) {
  HARMOS_REQUIRE(static_cast<int>(part.size()) == body.mesh.numberOfCells(), "each cell needs a part");
  return mended(graphOf(body.mesh), part);
}

} // namespace Harmos::fem
