// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <vector>

namespace Harmos::fem {

/// A box along the axes.
struct Box {
  Point low{}, high{};
  bool touches(const Box& other) const {
    for (std::size_t d = 0; d < 3; ++d)
      if (low[d] > other.high[d] || other.low[d] > high[d])
        return false;
    return true;
  }
};

/// The smallest box around points. @pre not empty.
Box boxAround(const std::vector<Point>& points);
/// Larger by a margin to each side.
Box widened(const Box& box, double margin);

/// Finds the boxes that touch another one, by halving the set at the median again and again: O(n log n) to
/// make; a query costs O(log n) for each box found, whatever their sizes.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);
  /// Places in the list of boxes, rising.
  std::vector<int> touching(const Box& box) const;

 private:
  struct Branch {
    Box box;
    std::size_t begin, end;        // of order_
    std::size_t low = 0, high = 0; // branches; 0: none
  };
  std::size_t grow(std::size_t begin, std::size_t end);
  void collect(std::size_t branch, const Box& box, std::vector<int>& found) const;

  std::vector<Box> boxes_;
  std::vector<int> order_;
  std::vector<Branch> branches_;
};

} // namespace Harmos::fem
