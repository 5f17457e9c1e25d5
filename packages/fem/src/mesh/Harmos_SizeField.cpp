// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SizeField.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace Harmos::fem {
namespace {

// Of a place with a size, so far away.
double grown(double size, double distance) {
  constexpr double growth = 0.5;
  return std::max(size, size * (1.0 - 0.5 * growth) + growth * distance);
}

// To a power of 2^(1/8), of which all processors have the same bits.
double rounded(double size) {
  static constexpr std::array<double, 8> steps = {1.0,
                                                  1.0905077326652577,
                                                  1.189207115002721,
                                                  1.2968395546510096,
                                                  1.4142135623730951,
                                                  1.5422108254079407,
                                                  1.681792830507429,
                                                  1.8340080864093424};
  const auto step = static_cast<int>(std::floor(8.0 * std::log2(size) + 0.5));
  const int octave = step >= 0 ? step / 8 : -((7 - step) / 8);
  return std::ldexp(steps[static_cast<std::size_t>(step - 8 * octave)], octave);
}

// From a box.
double distanceTo(const Point& least, const Point& most, const Point& place) {
  double square = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double away = std::max({0.0, least[d] - place[d], place[d] - most[d]});
    square += away * away;
  }
  return std::sqrt(square);
}

} // namespace

SizeField::SizeField(std::vector<Point> places, std::vector<double> sizes)
    : places_(std::move(places)), sizes_(std::move(sizes)), order_(places_.size()), halves_(places_.size()) {
  if (places_.empty() || places_.size() != sizes_.size())
    throw InternalError("a field of sizes needs places, and a size for each of them");
  for (double& size : sizes_)
    size = rounded(size);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  sort(0, order_.size());
  std::vector<double> given = sizes_;
  for (std::size_t k = 0; k < given.size(); ++k) {
    grow(0, order_.size(), places_[k], given[k]);
    given[k] = rounded(given[k]);
  }
  sizes_ = std::move(given);
}

// By the middle along the longest side of the box around the places of a range.
void SizeField::sort(std::size_t begin, std::size_t end) {
  if (begin == end)
    return;
  Half half = {places_[order_[begin]], places_[order_[begin]], sizes_[order_[begin]]};
  for (std::size_t k = begin; k < end; ++k) {
    half.size = std::min(half.size, sizes_[order_[k]]);
    for (std::size_t d = 0; d < 3; ++d) {
      half.least[d] = std::min(half.least[d], places_[order_[k]][d]);
      half.most[d] = std::max(half.most[d], places_[order_[k]][d]);
    }
  }
  for (std::size_t d = 1; d < 3; ++d)
    if (half.most[d] - half.least[d] > half.most[half.axis] - half.least[half.axis])
      half.axis = d;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
    return places_[a][half.axis] < places_[b][half.axis];
  });
  halves_[middle] = half;
  sort(begin, middle);
  sort(middle + 1, end);
}

void SizeField::grow(std::size_t begin, std::size_t end, const Point& place, double& best) const {
  if (begin == end)
    return;
  constexpr double enough = 0.9; // where sizes grow as far as they may, many places are as good
  const std::size_t middle = begin + (end - begin) / 2;
  if (grown(halves_[middle].size, distanceTo(halves_[middle].least, halves_[middle].most, place)) >=
      enough * best)
    return;
  const Point& at = places_[order_[middle]];
  best = std::min(best, grown(sizes_[order_[middle]], distanceTo(at, at, place)));
  grow(begin, middle, place, best);
  grow(middle + 1, end, place, best);
}

void SizeField::find(std::size_t begin, std::size_t end, const Point& place, Nearest& best) const {
  if (begin == end)
    return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Half& half = halves_[middle];
  if (distanceTo(half.least, half.most, place) >= best.distance)
    return;
  const Point& at = places_[order_[middle]];
  if (const double distance = distanceTo(at, at, place); distance < best.distance)
    best = {order_[middle], distance};
  // The half that is nearer first.
  const bool isBelow = place[half.axis] < at[half.axis];
  find(isBelow ? begin : middle + 1, isBelow ? middle : end, place, best);
  find(isBelow ? middle + 1 : begin, isBelow ? end : middle, place, best);
}

std::size_t SizeField::nearest(const Point& place) const {
  Nearest best = {order_[0], std::numeric_limits<double>::max()};
  find(0, order_.size(), place, best);
  return best.place;
}

} // namespace Harmos::fem
