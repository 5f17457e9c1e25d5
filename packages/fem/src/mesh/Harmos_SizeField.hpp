// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::fem {

/// Lengths of edges that a mesh is to have, from place to place: at a point those of the place that is known
/// nearest to it. Sizes that jump make cells without area: those of places are no larger than what the others
/// grow to with the distance d from them, to a tenth,
///
///     h_i ← min_j max(h_j, h_j(1 − g/2) + g d_ij),  g = 0.5
///
/// so that within a cell h_j is as given. They are rounded to eight steps an octave: meshes do not depend on
/// rounding errors of what sizes come from, but for those at the edge of a step. A tree of halves (k-d tree:
/// Bentley, Comm. ACM 18, 1975) with the box and the least size of each.
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
  struct Half {
    Point least{}, most{}; // of its places
    double size = 0.0;     // the least of them
    std::size_t axis = 0;  // along which they are split
  };
  void sort(std::size_t begin, std::size_t end);
  // Of a range, from the best so far.
  struct Nearest {
    std::size_t place;
    double distance;
  };
  void find(std::size_t begin, std::size_t end, const Point& place, Nearest& best) const;
  void grow(std::size_t begin, std::size_t end, const Point& place, double& best) const;

  std::vector<Point> places_;
  std::vector<double> sizes_;
  std::vector<std::size_t> order_; // the middle of each range splits it
  std::vector<Half> halves_;       // of the range, by its middle
};

} // namespace Harmos::fem
