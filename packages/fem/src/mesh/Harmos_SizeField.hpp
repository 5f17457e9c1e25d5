// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::fem {

/// Lengths of edges that a mesh is to have, from place to place: at a point the one that is known nearest to
/// it, by a tree of halves (k-d tree: Bentley, Comm. ACM 18, 1975).
///
/// All members are local. Guarded by tests/unit/fem/test_point_locator.cpp.
class SizeField {
 public:
  /// @param sizes positive, one for each place. @throws InternalError for none, or another number.
  SizeField(std::vector<Point> places, std::vector<double> sizes);

  double operator()(const Point& place) const { return sizes_[nearest(place)]; }
  /// Which of the places.
  std::size_t nearest(const Point& place) const;

 private:
  struct Search {
    const Point& place;
    std::size_t best = 0;
    double square; // of the distance
  };
  void sort(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, Search& search) const;

  std::vector<Point> places_;
  std::vector<double> sizes_;
  std::vector<std::size_t> order_; // the middle of each range splits it
  std::vector<char> axes_;         // along which, by place in the order
};

} // namespace Harmos::fem
