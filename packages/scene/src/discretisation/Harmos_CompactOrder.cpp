// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CompactOrder.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace Harmos::scene {
namespace {

// 27 groups are three times three times three; seven are not made seven slices.
std::size_t piecesOf(std::size_t groups) {
  for (const std::size_t prime : {2U, 3U, 5U, 7U})
    if (groups % prime == 0 && (prime <= 3 || groups / prime >= prime))
      return prime;
  return 2;
}

class Sections {
 public:
  Sections(const std::vector<fem::Point>& places, const std::vector<long long>& sizes)
      : places_(places), before_{0} {
    for (long long size : sizes)
      before_.push_back(before_.back() + size);
  }

  // Groups [first, end), of places that stand there.
  void cut(std::vector<int> items, std::size_t first, std::size_t end, std::vector<int>& order) const {
    if (end - first <= 1 || items.empty()) {
      std::sort(items.begin(), items.end());
      order.insert(order.end(), items.begin(), items.end());
      return;
    }
    sortAlong(items);
    const std::size_t pieces = piecesOf(end - first);
    for (std::size_t k = 0; k < pieces; ++k) {
      const std::size_t from = first + (end - first) * k / pieces,
                        to = first + (end - first) * (k + 1) / pieces;
      cut({items.begin() + (before_[from] - before_[first]), items.begin() + (before_[to] - before_[first])},
          from, to, order);
    }
  }

 private:
  void sortAlong(std::vector<int>& items) const {
    fem::Point low = places_[static_cast<std::size_t>(items.front())], high = low;
    for (int i : items)
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], places_[static_cast<std::size_t>(i)][d]);
        high[d] = std::max(high[d], places_[static_cast<std::size_t>(i)][d]);
      }
    std::array<std::size_t, 3> axes = {0, 1, 2};
    constexpr double clearly = 1.0 + 1e-6; // equal sides in the order of the axes
    std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
      return high[a] - low[a] > clearly * (high[b] - low[b]);
    });
    // Places of one layer differ by rounding errors.
    const double layer = std::max(1e-6 * (high[axes[0]] - low[axes[0]]), 1e-300);
    const auto keyOf = [&](int i) {
      std::array<double, 3> key;
      for (std::size_t d = 0; d < 3; ++d)
        key[d] = std::round((places_[static_cast<std::size_t>(i)][axes[d]] - low[axes[d]]) / layer);
      return key;
    };
    std::sort(items.begin(), items.end());
    std::stable_sort(items.begin(), items.end(), [&](int a, int b) { return keyOf(a) < keyOf(b); });
  }

  const std::vector<fem::Point>& places_;
  std::vector<long long> before_; // places of the groups before each
};

} // namespace

std::vector<int> compactOrder(const std::vector<fem::Point>& places, const std::vector<long long>& sizes) {
  HARMOS_REQUIRE(std::accumulate(sizes.begin(), sizes.end(), 0LL) == static_cast<long long>(places.size()),
                 "groups have all places");
  std::vector<int> all(places.size()), order;
  std::iota(all.begin(), all.end(), 0);
  Sections(places, sizes).cut(std::move(all), 0, sizes.size(), order);
  return order;
}

} // namespace Harmos::scene
