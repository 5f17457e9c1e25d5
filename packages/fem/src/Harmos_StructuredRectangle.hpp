// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

namespace Harmos::fem {

/// A rectangle cut into equal rectangular subdomains with regular grids of quadrilaterals.
///
/// Any subdomain can be made on any rank without the others: no rank ever holds the whole mesh. Nodes are
/// numbered row by row over the whole rectangle. Boundary parts are named "left", "right", "bottom", "top".
///
/// Guarded by tests/unit/fem/test_structured_rectangle.cpp.
class StructuredRectangle {
 public:
  /// @param origin lower left corner; @param size of the rectangle;
  /// @param subdomains, elements numbers per side (x, y); elements of one subdomain;
  /// @param firstNode global number of the first node.
  /// @throws InputError for sizes or numbers that are not positive.
  StructuredRectangle(const Point& origin, const std::array<double, 2>& size,
                      const std::array<int, 2>& subdomains, const std::array<int, 2>& elements,
                      long long firstNode);

  int numberOfSubdomains() const { return subdomains_[0] * subdomains_[1]; }
  long long numberOfNodes() const;

  /// Subdomain s = column + row · columns.
  PlacedMesh subdomain(int s) const;

 private:
  Point origin_;
  std::array<double, 2> size_;
  std::array<int, 2> subdomains_;
  std::array<int, 2> elements_;
  long long firstNode_;
  std::shared_ptr<const Mesh> mesh_;
};

} // namespace Harmos::fem
