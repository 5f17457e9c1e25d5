// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterPartition.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <metis.h>
#include <numeric>

namespace Harmos::feti {
namespace {

using Centre = std::array<double, 3>;

// Into how many pieces a box of so many parts is cut at once: 27 parts are three times three times three.
int piecesOf(int parts) {
  for (int prime : {2, 3, 5, 7})
    if (parts % prime == 0)
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

} // namespace

std::vector<std::vector<int>> partitionIntoClusters(int subdomains, const std::vector<SubdomainLink>& links,
                                                    const std::vector<std::array<double, 3>>& centres,
                                                    int size) {
  const int parts =
      size <= 0 ? 1 : std::max(1, static_cast<int>(std::lround(static_cast<double>(subdomains) / size)));
  std::vector<int> partOf(static_cast<std::size_t>(subdomains), 0);
  if (parts > 1) {
    partOf = byMetis(subdomains, links, std::min(parts, subdomains));
    mendParts(partOf, links);
    if (!centres.empty()) {
      std::vector<int> all(partOf.size()), bricks(partOf.size(), 0);
      std::iota(all.begin(), all.end(), 0);
      section(std::move(all), centres, 0, parts, bricks);
      mendParts(bricks, links);
      constexpr double muchBetter = 0.95;
      if (cutOf(partOf, links) >= muchBetter * cutOf(bricks, links))
        partOf = std::move(bricks);
    }
  }
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
