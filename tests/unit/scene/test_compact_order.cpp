// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CompactOrder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace test_compact_order {

using namespace Harmos;
using scene::compactOrder;

namespace {

// Places of a grid, x first; with rounding errors, as centres of subdomains have them.
std::vector<fem::Point> gridOf(int x, int y, int z) {
  std::vector<fem::Point> places;
  for (int k = 0; k < z; ++k)
    for (int j = 0; j < y; ++j)
      for (int i = 0; i < x; ++i)
        places.push_back({0.1 * i + 1e-15 * std::sin(k + 2.0 * j), 0.1 * j + 1e-15 * std::cos(i + 1.0 * k),
                          0.1 * k + 1e-15 * std::sin(3.0 * i)});
  return places;
}

// Sides of the box of some places, in their distance.
std::array<int, 3> boxOf(const std::vector<fem::Point>& places, const std::vector<int>& order,
                         std::size_t begin, std::size_t end) {
  std::array<int, 3> box;
  for (std::size_t d = 0; d < 3; ++d) {
    double low = 1e300, high = -1e300;
    for (std::size_t k = begin; k < end; ++k) {
      low = std::min(low, places[static_cast<std::size_t>(order[k])][d]);
      high = std::max(high, places[static_cast<std::size_t>(order[k])][d]);
    }
    box[d] = static_cast<int>(std::lround((high - low) / 0.1)) + 1;
  }
  return box;
}

} // namespace

TEST(CompactOrder, groups_of_a_grid_are_bricks) {
  struct Case {
    std::array<int, 3> grid;
    int groups;
    std::array<int, 3> brick; // sides in falling order
  };
  for (const Case& item :
       {Case{{8, 8, 1}, 4, {4, 4, 1}}, Case{{8, 8, 1}, 16, {2, 2, 1}}, Case{{4, 4, 4}, 8, {2, 2, 2}},
        Case{{6, 6, 6}, 27, {2, 2, 2}}, Case{{4, 4, 4}, 4, {4, 2, 2}}, Case{{12, 2, 2}, 6, {2, 2, 2}}}) {
    const std::vector<fem::Point> places = gridOf(item.grid[0], item.grid[1], item.grid[2]);
    const std::size_t each = places.size() / static_cast<std::size_t>(item.groups);
    const std::vector<int> order =
        compactOrder(places, std::vector<long long>(static_cast<std::size_t>(item.groups), each));
    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < sorted.size(); ++k)
      ASSERT_EQ(sorted[k], static_cast<int>(k));
    for (std::size_t begin = 0; begin < order.size(); begin += each) {
      std::array<int, 3> box = boxOf(places, order, begin, begin + each);
      std::sort(box.rbegin(), box.rend());
      EXPECT_EQ(box, item.brick) << item.groups << " groups";
      EXPECT_TRUE(std::is_sorted(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                 order.begin() + static_cast<std::ptrdiff_t>(begin + each)));
    }
  }
}

TEST(CompactOrder, groups_have_the_sizes_that_were_asked_for) {
  const std::vector<fem::Point> places = gridOf(5, 3, 1);
  // One group: as they are. And a group beyond the places, as of a rank that has none.
  std::vector<int> all(places.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(compactOrder(places, {15}), all);
  const std::vector<int> order = compactOrder(places, {1, 9, 5});
  EXPECT_TRUE(std::is_sorted(order.begin() + 1, order.begin() + 10));
  EXPECT_TRUE(std::is_sorted(order.begin() + 10, order.end()));
  EXPECT_EQ(compactOrder({}, {}), std::vector<int>());
}

} // namespace test_compact_order
