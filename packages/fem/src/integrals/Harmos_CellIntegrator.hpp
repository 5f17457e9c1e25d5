// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"
#include "Harmos_Mesh.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <vector>

namespace Harmos::fem {

/// Basis functions of one cell after another at the points of a quadrature rule: x = Σ x_i φ_i(r), ∇φ_i by
/// the chain rule.
class CellIntegrator {
 public:
  CellIntegrator(const Mesh& mesh, const ReferenceElement& element);

  /// Turns to a cell.
  /// @throws NumericalError if its Jacobian is not positive at a quadrature point (inverted cell, no area),
  /// naming it and its place relative to the mesh's anchor.
  void turnTo(int cell);

  int points() const { return element_.points(); }
  int basisSize() const { return element_.basisSize(); }
  /// Weight times Jacobian, times what Mesh::around() says.
  double measure(int q) const { return measures_[static_cast<std::size_t>(q)]; }
  double value(int i, int q) const { return element_.value(i, q); }
  /// ∇φ_i.
  const Point& gradient(int i, int q) const {
    return gradients_[static_cast<std::size_t>(q * basisSize() + i)];
  }
  /// Position, relative to the anchor.
  Point position(int q) const;
  /// Area or volume of the cell; axisymmetric: of the ring.
  double size() const;

 private:
  const Mesh& mesh_;
  const ReferenceElement& element_;
  int cell_ = -1;
  std::vector<Point> corners_; // node positions relative to the first one
  std::vector<double> measures_;
  std::vector<Point> gradients_;
};

/// A matrix of zeros that couples all components of all nodes of a cell: dof = node · components + component.
class BlockAssembler {
 public:
  BlockAssembler(const Mesh& mesh, int components);
  /// Adds a cell's matrix, row after row, its dofs ordered node by node.
  void add(int cell, const std::vector<double>& values);
  LocalMatrix take() { return std::move(matrix_); }

 private:
  const Mesh& mesh_;
  int components_;
  std::vector<std::size_t> offsets_; // of the graph of nodes
  std::vector<int> columns_;
  LocalMatrix matrix_;
};

} // namespace Harmos::fem
