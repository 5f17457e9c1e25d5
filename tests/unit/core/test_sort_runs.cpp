// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SortRuns.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace test_sort_runs {

using namespace Harmos;

// As std::sort, for none, few and many runs, of any lengths, with items that come twice.
TEST(SortRuns, sorts_any_number_of_runs) {
  std::mt19937 random(7);
  for (int runs = 0; runs < 30; ++runs)
    for (int length : {1, 2, 17}) {
      std::vector<long long> items;
      for (int r = 0; r < runs; ++r) {
        const auto first = static_cast<long long>(random() % 100);
        for (int k = 0; k < length + r % 3; ++k)
          items.push_back(first + 2 * k);
      }
      std::vector<long long> expected = items;
      std::sort(expected.begin(), expected.end());
      sortRuns(items, std::less<>());
      EXPECT_EQ(items, expected) << runs << " runs of " << length;
    }
}

} // namespace test_sort_runs
