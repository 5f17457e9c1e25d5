// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

namespace Harmos {

/// Sorts what comes as a few ascending runs, in linear time for each: lists of items from several ranks, each
/// in order. Anything else is sorted as std::sort would. Not stable.
template<class T, class Less>
void sortRuns(std::vector<T>& items, Less less) {
  constexpr int few = 8;
  auto middle = std::is_sorted_until(items.begin(), items.end(), less);
  for (int run = 1; run < few && middle != items.end(); ++run) {
    const auto last = std::is_sorted_until(middle, items.end(), less);
    std::inplace_merge(items.begin(), middle, last, less);
    middle = last;
  }
  if (middle != items.end())
    std::sort(items.begin(), items.end(), less);
}

} // namespace Harmos
