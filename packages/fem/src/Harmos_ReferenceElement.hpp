// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <vector>

namespace Harmos::fem {

/// Weights and points of a quadrature rule on a reference cell.
struct Quadrature {
  std::vector<std::array<double, 2>> points;
  std::vector<double> weights;
};

/// Exact for polynomials of the given total degree on the reference triangle (0,0), (1,0), (0,1). From
/// Intrepid2.
Quadrature triangleQuadrature(int degree);

/// Basis functions and quadrature of a cell type on its reference cell, from Intrepid2 and Shards.
class ReferenceElement {
 public:
  /// @param degree of the polynomials (in each direction) that the quadrature integrates exactly.
  ReferenceElement(CellType type, int degree);

  const Quadrature& quadrature() const { return quadrature_; }
  /// Value of basis function i at quadrature point q.
  double value(int i, int q) const { return values_[index(i, q)]; }
  /// Reference gradient of basis function i at quadrature point q.
  const std::array<double, 2>& gradient(int i, int q) const { return gradients_[index(i, q)]; }
  int basisSize() const { return basisSize_; }
  int points() const { return static_cast<int>(quadrature_.points.size()); }

  /// Basis functions at any reference points: result[point][function].
  std::vector<std::vector<double>> valuesAt(const std::vector<std::array<double, 2>>& points) const;

 private:
  std::size_t index(int i, int q) const {
    return static_cast<std::size_t>(q) * static_cast<std::size_t>(basisSize_) + static_cast<std::size_t>(i);
  }

  int basisSize_ = 0;
  Quadrature quadrature_;
  std::vector<double> values_;
  std::vector<std::array<double, 2>> gradients_;
};

} // namespace Harmos::fem
