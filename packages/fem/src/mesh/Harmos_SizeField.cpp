// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SizeField.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace Harmos::fem {

SizeField::SizeField(std::vector<Point> places, std::vector<double> sizes)
    : places_(std::move(places)), sizes_(std::move(sizes)), order_(places_.size()), axes_(places_.size(), 0) {
  if (places_.empty() || places_.size() != sizes_.size())
    throw InternalError("a field of sizes needs places, and a size for each of them");
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  sort(0, order_.size());
}

// By the middle along the longest side of the box around the places of a range.
void SizeField::sort(std::size_t begin, std::size_t end) {
  if (end - begin < 2)
    return;
  Point least = places_[order_[begin]], most = least;
  for (std::size_t k = begin; k < end; ++k)
    for (std::size_t d = 0; d < 3; ++d) {
      least[d] = std::min(least[d], places_[order_[k]][d]);
      most[d] = std::max(most[d], places_[order_[k]][d]);
    }
  std::size_t axis = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (most[d] - least[d] > most[axis] - least[axis])
      axis = d;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t a, std::size_t b) { return places_[a][axis] < places_[b][axis]; });
  axes_[middle] = static_cast<char>(axis);
  sort(begin, middle);
  sort(middle + 1, end);
}

void SizeField::search(std::size_t begin, std::size_t end, Search& found) const {
  if (begin == end)
    return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Point& at = places_[order_[middle]];
  double square = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    square += (found.place[d] - at[d]) * (found.place[d] - at[d]);
  if (square < found.square) {
    found.square = square;
    found.best = order_[middle];
  }
  const auto axis = static_cast<std::size_t>(axes_[middle]);
  const double beyond = found.place[axis] - at[axis];
  if (beyond < 0.0)
    search(begin, middle, found);
  else
    search(middle + 1, end, found);
  if (beyond * beyond >= found.square)
    return;
  if (beyond < 0.0)
    search(middle + 1, end, found);
  else
    search(begin, middle, found);
}

std::size_t SizeField::nearest(const Point& place) const {
  Search found = {place, order_[0], std::numeric_limits<double>::max()};
  search(0, order_.size(), found);
  return found.best;
}

} // namespace Harmos::fem
