// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellClusters.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace Harmos::fem {
namespace {

constexpr int bitsOfCoordinate = 16, bitsOfDigit = 12;

// Two zeros after each of the lower 16 bits.
std::uint64_t spread(std::uint64_t x) {
  x &= 0xffff;
  x = (x | x << 16) & 0xff0000ff;
  x = (x | x << 8) & 0xf00f00f00f;
  x = (x | x << 4) & 0xc30c30c30c3;
  return (x | x << 2) & 0x249249249249;
}

// Places of rising keys, of equal ones in order: digit by digit.
std::vector<int> sortedPlaces(const std::vector<std::uint64_t>& keys) {
  constexpr std::uint64_t digits = std::uint64_t{1} << bitsOfDigit;
  std::vector<int> order(keys.size()), next(keys.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = static_cast<int>(k);
  for (int shift = 0; shift < 3 * bitsOfCoordinate; shift += bitsOfDigit) {
    std::vector<std::size_t> first(digits + 1, 0);
    const auto digitOf = [&](int k) { return keys[at(k)] >> shift & (digits - 1); };
    for (int k : order)
      ++first[digitOf(k) + 1];
    for (std::size_t d = 0; d < digits; ++d)
      first[d + 1] += first[d];
    for (int k : order)
      next[first[digitOf(k)]++] = k;
    order.swap(next);
  }
  return order;
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
  const double scale = extent > 0.0 ? ((1 << bitsOfCoordinate) - 1) / extent : 0.0;
  std::vector<std::uint64_t> keys(points.size(), 0);
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d)
      keys[k] |= spread(static_cast<std::uint64_t>(scale * (points[k][d] - low[d]))) << d;
  return sortedPlaces(keys);
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
