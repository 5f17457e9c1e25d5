// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellClusters.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace Harmos::fem {
namespace {

// Two zeros after each of the lower 21 bits.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

} // namespace

std::vector<int> curveThrough(const std::vector<Point>& points) {
  constexpr double most = std::numeric_limits<double>::max();
  Point low = {most, most, most}, high = {-most, -most, -most};
  for (const Point& x : points)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  double extent = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    extent = std::max(extent, high[d] - low[d]);
  const double scale = extent > 0.0 ? 0x1fffff / extent : 0.0;
  std::vector<std::pair<std::uint64_t, int>> keys;
  keys.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::uint64_t key = 0;
    for (std::size_t d = 0; d < 3; ++d)
      key |= spread(static_cast<std::uint64_t>(scale * (points[k][d] - low[d]))) << d;
    keys.emplace_back(key, static_cast<int>(k));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> order;
  for (const auto& [key, k] : keys)
    order.push_back(k);
  return order;
}

CellGraph reordered(const CellGraph& graph, const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    place[at(order[k])] = static_cast<int>(k);
  CellGraph result;
  result.dimension = graph.dimension;
  result.offsets = {0};
  result.offsets.reserve(graph.offsets.size());
  result.neighbours.reserve(graph.neighbours.size());
  result.centres.reserve(graph.centres.size());
  for (int old : order) {
    const auto first = static_cast<std::ptrdiff_t>(result.neighbours.size());
    for (const int* other = graph.begin(old); other != graph.end(old); ++other)
      result.neighbours.push_back(place[at(*other)]);
    std::sort(result.neighbours.begin() + first, result.neighbours.end());
    result.offsets.push_back(result.neighbours.size());
    result.centres.push_back(graph.centres[at(old)]);
  }
  return result;
}

namespace {

void group(const CellGraph& graph, int size, CellClusters& clusters) {
  clusters.of.assign(at(graph.cells()), -1);
  std::vector<int> cells;
  for (int first = 0; first < graph.cells(); ++first) {
    if (clusters.of[at(first)] >= 0)
      continue;
    const int cluster = static_cast<int>(clusters.sizes.size());
    cells = {first};
    clusters.of[at(first)] = cluster;
    for (std::size_t k = 0; k < cells.size(); ++k)
      for (const int* other = graph.begin(cells[k]); other != graph.end(cells[k]); ++other)
        if (clusters.of[at(*other)] < 0 && cells.size() < at(size)) {
          clusters.of[at(*other)] = cluster;
          cells.push_back(*other);
        }
    clusters.sizes.push_back(static_cast<int>(cells.size()));
  }
}

void connect(const CellGraph& graph, CellClusters& clusters) {
  const std::size_t count = clusters.sizes.size();
  std::vector<std::size_t> first(count + 1, 0);
  for (int cluster : clusters.of)
    ++first[at(cluster) + 1];
  for (std::size_t k = 0; k < count; ++k)
    first[k + 1] += first[k];
  std::vector<int> cells(clusters.of.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t c = 0; c < cells.size(); ++c)
    cells[next[at(clusters.of[c])]++] = static_cast<int>(c);
  clusters.graph.offsets = {0};
  std::vector<std::size_t> place(count, std::numeric_limits<std::size_t>::max()); // among the neighbours
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = clusters.graph.neighbours.size();
    for (std::size_t c = first[k]; c < first[k + 1]; ++c)
      for (const int* other = graph.begin(cells[c]); other != graph.end(cells[c]); ++other) {
        const std::size_t beside = at(clusters.of[at(*other)]);
        if (beside == k)
          continue;
        if (place[beside] == std::numeric_limits<std::size_t>::max()) {
          place[beside] = clusters.sides.size();
          clusters.graph.neighbours.push_back(static_cast<int>(beside));
          clusters.sides.push_back(0);
        }
        ++clusters.sides[place[beside]];
      }
    for (std::size_t n = begin; n < clusters.graph.neighbours.size(); ++n)
      place[at(clusters.graph.neighbours[n])] = std::numeric_limits<std::size_t>::max();
    clusters.graph.offsets.push_back(clusters.graph.neighbours.size());
  }
}

} // namespace

CellClusters clustersOf(const CellGraph& graph, int size) {
  CellClusters clusters;
  group(graph, size, clusters);
  std::vector<Point>& centres = clusters.graph.centres;
  centres.assign(clusters.sizes.size(), Point{});
  for (std::size_t c = 0; c < graph.centres.size(); ++c)
    for (std::size_t d = 0; d < 3; ++d)
      centres[at(clusters.of[c])][d] += graph.centres[c][d];
  for (std::size_t k = 0; k < centres.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d)
      centres[k][d] /= clusters.sizes[k];
  clusters.graph.dimension = graph.dimension;
  connect(graph, clusters);
  return clusters;
}

} // namespace Harmos::fem
