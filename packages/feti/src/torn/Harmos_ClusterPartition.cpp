// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterPartition.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <metis.h>
#include <numeric>

namespace Harmos::feti {
namespace {

using Centre = std::array<double, 3>;

// Into how many pieces a box of so many parts is cut at once: 27 parts are three times three times three, but
// seven are better not made seven slices.
int piecesOf(int parts) {
  for (int prime : {2, 3, 5, 7})
    if (parts % prime == 0 && (prime <= 3 || parts / prime >= prime))
      return prime;
  return 2;
}

// Parts by recursive sections; part numbers are from `first` on.
void section(std::vector<int> items, const std::vector<Centre>& centres, int first, int parts,
             std::vector<int>& partOf) {
  if (parts <= 1 || items.size() <= 1) {
    for (int i : items)
      partOf[static_cast<std::size_t>(i)] = first;
    return;
  }
  Centre low = centres[static_cast<std::size_t>(items.front())], high = low;
  for (int i : items)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], centres[static_cast<std::size_t>(i)][d]);
      high[d] = std::max(high[d], centres[static_cast<std::size_t>(i)][d]);
    }
  std::array<std::size_t, 3> axes = {0, 1, 2};
  constexpr double clearly = 1.0 + 1e-9; // equal sides are cut in the order of the axes
  std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
    return high[a] - low[a] > clearly * (high[b] - low[b]);
  });
  // Centres of a layer of a grid differ by rounding errors.
  const double layer = 1e-6 * std::max(high[axes[0]] - low[axes[0]], 1e-300);
  const auto keyOf = [&](int i) {
    const Centre& c = centres[static_cast<std::size_t>(i)];
    return std::array<double, 3>{std::round((c[axes[0]] - low[axes[0]]) / layer),
                                 std::round((c[axes[1]] - low[axes[1]]) / layer),
                                 std::round((c[axes[2]] - low[axes[2]]) / layer)};
  };
  std::stable_sort(items.begin(), items.end(), [&](int a, int b) { return keyOf(a) < keyOf(b); });
  const int pieces = piecesOf(parts);
  const double share = static_cast<double>(items.size()) / parts;
  int done = 0; // parts
  std::ptrdiff_t begin = 0;
  for (int piece = 1; piece <= pieces; ++piece) {
    // Between layers, if there is such a place near that of equal shares.
    const double ideal = static_cast<double>(items.size()) * piece / pieces;
    std::ptrdiff_t cut = std::llround(ideal);
    double nearest = 0.75 * share;
    for (auto k = static_cast<std::size_t>(begin) + 1; k < items.size() && piece < pieces; ++k)
      if (const double distance = std::abs(static_cast<double>(k) - ideal);
          keyOf(items[k])[0] - keyOf(items[k - 1])[0] > 1.0 && distance < nearest) {
        nearest = distance;
        cut = static_cast<std::ptrdiff_t>(k);
      }
    const int upTo = piece == pieces
                         ? parts
                         : std::clamp(static_cast<int>(std::lround(static_cast<double>(cut) / share)),
                                      done + 1, parts - (pieces - piece));
    section({items.begin() + begin, items.begin() + cut}, centres, first + done, upTo - done, partOf);
    done = upTo;
    begin = cut;
  }
}

std::vector<int> byMetis(int subdomains, const std::vector<SubdomainLink>& links, int parts) {
  std::vector<std::vector<std::pair<int, int>>> neighbours(static_cast<std::size_t>(subdomains));
  for (const SubdomainLink& link : links) {
    neighbours[static_cast<std::size_t>(link.first)].emplace_back(link.second, link.weight);
    neighbours[static_cast<std::size_t>(link.second)].emplace_back(link.first, link.weight);
  }
  std::vector<idx_t> offsets = {0}, adjacent, weights, part(static_cast<std::size_t>(subdomains));
  for (const auto& list : neighbours) {
    for (const auto& [other, weight] : list) {
      adjacent.push_back(other);
      weights.push_back(weight);
    }
    offsets.push_back(static_cast<idx_t>(adjacent.size()));
  }
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_NCUTS] = 10;    // the best of so many
  options[METIS_OPTION_UFACTOR] = 200; // parts may be larger than the mean by a fifth
  idx_t n = subdomains, constraints = 1, count = parts, cut = 0;
  HARMOS_REQUIRE(METIS_PartGraphRecursive(&n, &constraints, offsets.data(), adjacent.data(), nullptr, nullptr,
                                          weights.data(), &count, nullptr, nullptr, options, &cut,
                                          part.data()) == METIS_OK,
                 "METIS failed to partition subdomains into clusters");
  return {part.begin(), part.end()};
}

// The piece of its part that each subdomain hangs together with, numbered by its first subdomain.
std::vector<int> pieces(const std::vector<int>& partOf, const std::vector<SubdomainLink>& links) {
  std::vector<int> piece(partOf.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int i) {
    while (piece[static_cast<std::size_t>(i)] != i)
      i = piece[static_cast<std::size_t>(i)] =
          piece[static_cast<std::size_t>(piece[static_cast<std::size_t>(i)])];
    return i;
  };
  for (const SubdomainLink& link : links)
    if (partOf[static_cast<std::size_t>(link.first)] == partOf[static_cast<std::size_t>(link.second)]) {
      const int a = root(link.first), b = root(link.second);
      piece[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (std::size_t i = 0; i < piece.size(); ++i)
    piece[i] = root(static_cast<int>(i));
  return piece;
}

// Pieces that are not the largest of their part go to the part that they have most links with.
void mendParts(std::vector<int>& partOf, const std::vector<SubdomainLink>& links) {
  const std::vector<int> piece = pieces(partOf, links);
  std::map<int, int> sizes; // of pieces
  for (int p : piece)
    ++sizes[p];
  std::map<int, int> largest; // piece of each part
  for (const auto& [p, size] : sizes) {
    const auto [known, isNew] = largest.emplace(partOf[static_cast<std::size_t>(p)], p);
    if (!isNew && size > sizes[known->second])
      known->second = p;
  }
  std::map<int, std::map<int, int>> links2; // of small pieces, with parts
  const std::vector<int> before = partOf;
  const auto isSmall = [&](int i) {
    return largest[before[static_cast<std::size_t>(i)]] != piece[static_cast<std::size_t>(i)];
  };
  for (const SubdomainLink& link : links)
    for (const auto& [i, other] : {std::pair(link.first, link.second), std::pair(link.second, link.first)})
      if (isSmall(i) && !isSmall(other))
        links2[piece[static_cast<std::size_t>(i)]][before[static_cast<std::size_t>(other)]] += link.weight;
  for (std::size_t i = 0; i < partOf.size(); ++i)
    if (const auto found = links2.find(piece[i]); found != links2.end())
      partOf[i] =
          std::max_element(found->second.begin(), found->second.end(), [](const auto& a, const auto& b) {
            return a.second < b.second;
          })->first;
}

// Dofs that link different parts.
double cutOf(const std::vector<int>& partOf, const std::vector<SubdomainLink>& links) {
  double sum = 0.0;
  for (const SubdomainLink& link : links)
    if (partOf[static_cast<std::size_t>(link.first)] != partOf[static_cast<std::size_t>(link.second)])
      sum += link.weight;
  return sum;
}

// Σ|x − x̄|² over all parts, x̄ their centroids.
double inertiaOf(const std::vector<int>& partOf, const std::vector<Centre>& centres) {
  std::map<int, std::array<double, 5>> sums; // Σx, Σ|x|², count
  for (std::size_t i = 0; i < partOf.size(); ++i) {
    std::array<double, 5>& sum = sums[partOf[i]];
    for (std::size_t d = 0; d < 3; ++d) {
      sum[d] += centres[i][d];
      sum[3] += centres[i][d] * centres[i][d];
    }
    sum[4] += 1.0;
  }
  double result = 0.0;
  for (const auto& [part, s] : sums)
    result += s[3] - (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / s[4];
  return result;
}

// Each to the nearest centroid (Lloyd), some times.
std::vector<int> compacted(std::vector<int> partOf, const std::vector<Centre>& centres) {
  constexpr int sweeps = 20;
  constexpr double clearly = 1.0 - 1e-6;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    std::map<int, std::array<double, 4>> sums;
    for (std::size_t i = 0; i < partOf.size(); ++i) {
      std::array<double, 4>& sum = sums[partOf[i]];
      for (std::size_t d = 0; d < 3; ++d)
        sum[d] += centres[i][d];
      sum[3] += 1.0;
    }
    const auto distance = [&](std::size_t i, const std::array<double, 4>& sum) {
      double square = 0.0;
      for (std::size_t d = 0; d < 3; ++d)
        square += (centres[i][d] - sum[d] / sum[3]) * (centres[i][d] - sum[d] / sum[3]);
      return square;
    };
    bool hasMoved = false;
    for (std::size_t i = 0; i < partOf.size(); ++i) {
      int nearest = partOf[i];
      double least = clearly * distance(i, sums[nearest]);
      for (const auto& [part, sum] : sums)
        if (const double other = distance(i, sum); other < least) {
          least = other;
          nearest = part;
        }
      hasMoved = hasMoved || nearest != partOf[i];
      partOf[i] = nearest;
    }
    if (!hasMoved)
      break;
  }
  return partOf;
}

// Centres at the places of a grid, layer by layer.
struct Grid {
  std::array<int, 3> layers = {1, 1, 1};
  std::array<double, 3> spacing = {0.0, 0.0, 0.0}; ///< 0: one layer
  std::vector<std::array<int, 3>> places;          ///< none: there is no grid
};

Grid gridOf(const std::vector<Centre>& centres) {
  Grid grid;
  grid.places.resize(centres.size());
  for (std::size_t d = 0; d < 3; ++d) {
    std::vector<double> values;
    for (const Centre& centre : centres)
      values.push_back(centre[d]);
    std::sort(values.begin(), values.end());
    const double extent = values.back() - values.front(), rounding = 1e-6 * extent;
    values.erase(
        std::unique(values.begin(), values.end(), [&](double a, double b) { return b - a <= rounding; }),
        values.end());
    grid.layers[d] = static_cast<int>(values.size());
    grid.spacing[d] = values.size() > 1 ? extent / static_cast<double>(values.size() - 1) : 0.0;
    for (std::size_t i = 0; i < centres.size(); ++i)
      grid.places[i][d] = static_cast<int>(
          std::upper_bound(values.begin(), values.end(), centres[i][d] + rounding) - values.begin() - 1);
  }
  if (static_cast<long long>(grid.layers[0]) * grid.layers[1] * grid.layers[2] !=
      static_cast<long long>(centres.size()))
    grid.places.clear();
  return grid;
}

// Into how many pieces a grid is cut along each axis: bricks about as long as wide, of about so many. The
// worst brick counts, since pieces of one axis differ by a layer.
std::array<int, 3> piecesOf(const Grid& grid, double size) {
  std::array<int, 3> best = {1, 1, 1}, p;
  double least = std::numeric_limits<double>::infinity();
  constexpr double mostOther = 2.0;                // times the size, or its part
  const double leastMean = size > 1.5 ? 1.5 : 1.0; // most are to be joined
  for (p[0] = 1; p[0] <= grid.layers[0]; ++p[0])
    for (p[1] = 1; p[1] <= grid.layers[1]; ++p[1])
      for (p[2] = 1; p[2] <= grid.layers[2]; ++p[2]) {
        double mean = 1.0, longest = 0.0, shortest = std::numeric_limits<double>::infinity();
        for (std::size_t d = 0; d < 3; ++d) {
          mean *= static_cast<double>(grid.layers[d]) / p[d];
          if (grid.layers[d] == 1)
            continue;
          longest = std::max(longest, grid.spacing[d] * ((grid.layers[d] + p[d] - 1) / p[d]));
          shortest = std::min(shortest, grid.spacing[d] * (grid.layers[d] / p[d]));
        }
        const double other = std::max(mean / size, size / mean);
        const double shape = longest > 0.0 ? longest / shortest : 1.0;
        const double score = std::log(other) * (1.0 + 1e-6) + std::log(shape);
        if (other <= mostOther && mean >= leastMean && score <= least) {
          least = score;
          best = p;
        }
      }
  return best;
}

std::vector<int> bricksOf(const Grid& grid, const std::array<int, 3>& pieces) {
  std::vector<int> partOf;
  for (const std::array<int, 3>& place : grid.places) {
    int part = 0;
    for (std::size_t d = 0; d < 3; ++d)
      part = part * pieces[d] + place[d] * pieces[d] / grid.layers[d];
    partOf.push_back(part);
  }
  return partOf;
}

// Those that differ in nothing that counts are taken in this order.
std::vector<std::vector<int>> candidates(int subdomains, const std::vector<SubdomainLink>& links,
                                         const std::vector<Centre>& centres, int parts) {
  std::vector<std::vector<int>> result;
  if (!centres.empty()) {
    std::vector<int> all(static_cast<std::size_t>(subdomains));
    std::iota(all.begin(), all.end(), 0);
    result.emplace_back(all.size(), 0);
    section(std::move(all), centres, 0, parts, result.back());
  }
  result.push_back(byMetis(subdomains, links, parts));
  const std::size_t made = result.size();
  for (std::size_t k = 0; k < made && !centres.empty(); ++k)
    result.push_back(compacted(result[k], centres));
  for (std::vector<int>& partOf : result)
    mendParts(partOf, links);
  return result;
}

// That which cuts few dofs and is compact: the least product of both.
std::vector<int> bestOf(const std::vector<std::vector<int>>& partitions,
                        const std::vector<SubdomainLink>& links, const std::vector<Centre>& centres) {
  constexpr double clearly = 0.98;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < partitions.size(); ++k) {
    double score = cutOf(partitions[k], links);
    if (!centres.empty())
      score *= inertiaOf(partitions[k], centres);
    if (score < clearly * least) {
      least = score;
      best = k;
    }
  }
  return partitions[best];
}

} // namespace

std::vector<std::vector<int>> partitionIntoClusters(int subdomains, const std::vector<SubdomainLink>& links,
                                                    const std::vector<std::array<double, 3>>& centres,
                                                    int size) {
  const int parts =
      size <= 0 ? 1 : std::max(1, static_cast<int>(std::lround(static_cast<double>(subdomains) / size)));
  std::vector<int> partOf(static_cast<std::size_t>(subdomains), 0);
  const Grid grid = parts > 1 && !centres.empty() ? gridOf(centres) : Grid();
  if (!grid.places.empty()) {
    partOf = bricksOf(grid, piecesOf(grid, size));
    mendParts(partOf, links);
  } else if (parts > 1)
    partOf = bestOf(candidates(subdomains, links, centres, std::min(parts, subdomains)), links, centres);
  std::map<int, std::vector<int>> groups; // by their first member
  const std::vector<int> piece = pieces(partOf, links);
  for (int i = 0; i < subdomains; ++i)
    groups[piece[static_cast<std::size_t>(i)]].push_back(i);
  std::vector<std::vector<int>> result;
  for (auto& [first, members] : groups)
    result.push_back(std::move(members));
  return result;
}

} // namespace Harmos::feti
