// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoxTree.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace Harmos::fem {
namespace {

constexpr std::size_t leafSize = 4;

Box joined(const Box& a, const Box& b) {
  Box box = a;
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = std::min(a.low[d], b.low[d]);
    box.high[d] = std::max(a.high[d], b.high[d]);
  }
  return box;
}

} // namespace

Box boxAround(const std::vector<Point>& points) {
  Box box{points.front(), points.front()};
  for (const Point& x : points)
    box = joined(box, {x, x});
  return box;
}

Box widened(const Box& box, double margin) {
  Box result = box;
  for (std::size_t d = 0; d < 3; ++d) {
    result.low[d] -= margin;
    result.high[d] += margin;
  }
  return result;
}

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!boxes_.empty())
    grow(0, boxes_.size());
}

std::size_t BoxTree::grow(std::size_t begin, std::size_t end) {
  const std::size_t branch = branches_.size();
  Box all = boxes_[static_cast<std::size_t>(order_[begin])];
  for (std::size_t k = begin; k < end; ++k)
    all = joined(all, boxes_[static_cast<std::size_t>(order_[k])]);
  branches_.push_back({all, begin, end});
  if (end - begin <= leafSize)
    return branch;
  std::size_t longest = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (all.high[d] - all.low[d] > all.high[longest] - all.low[longest])
      longest = d;
  const std::size_t middle = (begin + end) / 2;
  const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end), [&](int a, int b) {
    const Box& x = boxes_[static_cast<std::size_t>(a)];
    const Box& y = boxes_[static_cast<std::size_t>(b)];
    return std::make_tuple(x.low[longest] + x.high[longest], a) <
           std::make_tuple(y.low[longest] + y.high[longest], b);
  });
  const std::size_t low = grow(begin, middle);
  const std::size_t high = grow(middle, end);
  branches_[branch].low = low;
  branches_[branch].high = high;
  return branch;
}

std::vector<int> BoxTree::touching(const Box& box) const {
  std::vector<int> found;
  if (!branches_.empty())
    collect(0, box, found);
  std::sort(found.begin(), found.end());
  return found;
}

void BoxTree::collect(std::size_t branch, const Box& box, std::vector<int>& found) const {
  const Branch& here = branches_[branch];
  if (!here.box.touches(box))
    return;
  if (here.low != 0) {
    collect(here.low, box, found);
    collect(here.high, box, found);
    return;
  }
  for (std::size_t k = here.begin; k < here.end; ++k)
    if (boxes_[static_cast<std::size_t>(order_[k])].touches(box))
      found.push_back(order_[k]);
}

} // namespace Harmos::fem
