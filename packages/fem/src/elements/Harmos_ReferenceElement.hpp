// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <vector>

namespace Harmos::fem {

/// Weights and points of a quadrature rule on a reference cell.
struct Quadrature {
  std::vector<Point> points;
  std::vector<double> weights;
};

/// Exact for polynomials of the given degree on the reference cell: of total degree on triangles and
/// tetrahedra, in each direction on the others. From Intrepid2.
Quadrature quadratureOn(CellType type, int degree);

/// Node positions on the reference cell: (0,0), (1,0), (0,1) for triangles, [−1,1]^d for lines,
/// quadrilaterals and hexahedra. From Intrepid2; of serendipity elements the first ones of wholeOf().
std::vector<Point> nodeCoordinates(CellType type);

/// Values of the basis functions at any reference points: result[point][function]. From Intrepid2; of
/// serendipity elements, which it lacks in some versions, from cellBasis().
std::vector<std::vector<double>> basisValues(CellType type, const std::vector<Point>& points);
/// Their reference gradients.
std::vector<std::vector<Point>> basisGradients(CellType type, const std::vector<Point>& points);

/// Basis functions and quadrature of a cell type on its reference cell, from Intrepid2 and Shards.
class ReferenceElement {
 public:
  /// @param degree of the polynomials that the quadrature integrates exactly.
  ReferenceElement(CellType type, int degree);

  const Quadrature& quadrature() const { return quadrature_; }
  double weight(int q) const { return quadrature_.weights[static_cast<std::size_t>(q)]; }
  /// Value of basis function i at quadrature point q.
  double value(int i, int q) const { return values_[index(i, q)]; }
  /// Reference gradient of basis function i at quadrature point q.
  const Point& gradient(int i, int q) const { return gradients_[index(i, q)]; }
  int basisSize() const { return basisSize_; }
  int points() const { return static_cast<int>(quadrature_.points.size()); }

 private:
  std::size_t index(int i, int q) const {
    return static_cast<std::size_t>(q) * static_cast<std::size_t>(basisSize_) + static_cast<std::size_t>(i);
  }

  int basisSize_ = 0;
  Quadrature quadrature_;
  std::vector<double> values_;
  std::vector<Point> gradients_;
};

} // namespace Harmos::fem
