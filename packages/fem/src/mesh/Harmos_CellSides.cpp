// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellSides.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Index.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>

namespace Harmos::fem {
namespace {

constexpr std::size_t mostCorners = 4; // corners of a side

// What tells a side among those of one lowest corner.
struct Key {
  std::uint64_t middle; // the second corner and the third
  int highest;          // of four
  int side;             // among all: cells one after the other

  bool isAt(const Key& other) const { return middle == other.middle && highest == other.highest; }
  bool operator<(const Key& other) const {
    return std::tie(middle, highest, side) < std::tie(other.middle, other.highest, other.side);
  }
};

std::size_t cornersOf(const CellShape& shape, int side) {
  return at(shapeOf(shape.sideTypes[at(side)]).corners);
}

// Calls take(corners, number) for every side, corners rising, −1 before them where there are fewer than four.
template<class Take>
void visitSides(const Mesh& mesh, const Take& take) {
  const CellShape& shape = shapeOf(mesh.cellType);
  struct Place {
    std::size_t corners;
    std::array<int, mostCorners> of; // the corners, in the cell
  };
  std::vector<Place> places; // of each side
  for (std::size_t s = 0; s < shape.sides.size(); ++s) {
    places.push_back({cornersOf(shape, static_cast<int>(s)), {}});
    std::copy_n(shape.sides[s].begin(), places.back().corners, places.back().of.begin());
  }
  int number = 0;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    const int* cell = mesh.cell(c);
    for (const Place& place : places) {
      std::array<int, mostCorners> side = {-1, -1, -1, -1};
      for (std::size_t k = 0; k < place.corners; ++k) {
        std::size_t free = mostCorners - 1 - k; // insertion from behind, as there are few
        const int corner = cell[place.of[k]];
        for (; free + 1 < mostCorners && side[free + 1] < corner; ++free)
          side[free] = side[free + 1];
        side[free] = corner;
      }
      take(side, number++);
    }
  }
}

} // namespace

MatchedSides matchSides(const Mesh& mesh) {
  const CellShape& shape = shapeOf(mesh.cellType);
  std::vector<std::size_t> lowestOf; // places of the first corner, by side
  for (std::size_t s = 0; s < shape.sides.size(); ++s)
    lowestOf.push_back(mostCorners - cornersOf(shape, static_cast<int>(s)));
  const auto each = static_cast<int>(shape.sides.size());
  HARMOS_REQUIRE(mesh.numberOfCells() <= std::numeric_limits<int>::max() / each, "sides are counted by int");
  std::vector<std::ptrdiff_t> first(at(mesh.numberOfNodes()) + 1, 0);
  visitSides(mesh, [&](const std::array<int, mostCorners>& side, int number) {
    ++first[at(side[lowestOf[at(number % each)]]) + 1];
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Key> keys(at(first.back()));
  std::vector<std::ptrdiff_t> next(first.begin(), first.end() - 1);
  visitSides(mesh, [&](const std::array<int, mostCorners>& side, int number) {
    const std::size_t lowest = lowestOf[at(number % each)];
    const auto corner = [&](std::size_t k) { // of those that the bucket does not tell
      const std::size_t place = lowest + 1 + k;
      return place < mostCorners ? static_cast<std::uint32_t>(side[place]) : 0U;
    };
    keys[at(next[at(side[lowest])]++)] = {static_cast<std::uint64_t>(corner(0)) << 32 | corner(1),
                                          static_cast<int>(corner(2)), number};
  });
  MatchedSides matched;
  matched.sides.reserve(keys.size());
  for (std::size_t corner = 0; corner + 1 < first.size(); ++corner) {
    const auto begin = keys.begin() + first[corner], end = keys.begin() + first[corner + 1];
    std::sort(begin, end);
    for (auto key = begin; key != end; ++key) {
      if (key == begin || !key->isAt(*(key - 1)))
        matched.first.push_back(matched.sides.size());
      matched.sides.push_back({key->side / each, key->side % each});
    }
  }
  matched.first.push_back(matched.sides.size());
  return matched;
}

std::vector<Side> boundarySides(const MatchedSides& matched) {
  std::vector<Side> result;
  for (std::size_t group = 0; group + 1 < matched.first.size(); ++group)
    if (matched.first[group + 1] == matched.first[group] + 1)
      result.push_back(matched.sides[matched.first[group]]);
  std::sort(result.begin(), result.end(),
            [](const Side& a, const Side& b) { return std::tie(a.cell, a.side) < std::tie(b.cell, b.side); });
  return result;
}

namespace {

// Whether corners go around in the same way, of two sides with the same ones.
bool goTheSameWay(const Mesh& mesh, const Side& a, const Side& b, std::size_t corners) {
  const std::vector<std::vector<int>>& sides = shapeOf(mesh.cellType).sides;
  const auto cornerOf = [&](const Side& side, std::size_t k) {
    return mesh.cell(side.cell)[sides[at(side.side)][k]];
  };
  for (std::size_t k = 0; k < corners; ++k)
    if (cornerOf(b, k) == cornerOf(a, 0))
      return cornerOf(b, (k + 1) % corners) == cornerOf(a, 1) && !(corners == 2 && k == 1);
  return false;
}

} // namespace

// Corners of sides go around outwards: the other way, seen from the cell behind.
std::optional<std::pair<Side, Side>> foldedSides(const Mesh& mesh, const MatchedSides& matched) {
  const CellShape& shape = shapeOf(mesh.cellType);
  for (std::size_t group = 0; group + 1 < matched.first.size(); ++group) {
    const std::size_t first = matched.first[group], count = matched.first[group + 1] - first;
    if (count < 2)
      continue;
    const Side &a = matched.sides[first], &b = matched.sides[first + 1];
    if (goTheSameWay(mesh, a, b, cornersOf(shape, a.side)))
      return std::make_pair(a, b);
    if (count > 2)
      return std::make_pair(b, matched.sides[first + 2]);
  }
  return std::nullopt;
}

std::vector<Side> boundarySides(const Mesh& mesh) {
  return boundarySides(matchSides(mesh));
}

std::optional<std::pair<Side, Side>> foldedSides(const Mesh& mesh) {
  return foldedSides(mesh, matchSides(mesh));
}

} // namespace Harmos::fem
