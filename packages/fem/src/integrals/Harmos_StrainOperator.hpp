// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Elasticity.hpp"

#include <vector>

namespace Harmos::fem {

/// Solves the symmetric positive definite system of order n for several right-hand sides (columns).
void solveSmall(int n, std::vector<double>& matrix, int columns, double* rhs);

/// Whether the dilatation of this mesh's cells is projected.
bool isProjected(const Mesh& mesh, const Elasticity& elasticity);

/// C of each region.
std::vector<VoigtMatrix> stiffnesses(const Elasticity& elasticity);
/// @throws InternalError if the region has no material.
const VoigtMatrix& stiffnessOf(const std::vector<VoigtMatrix>& all, int region);

/// Temperatures at the points of cells, from those of nodes, of one order less than the displacements, as
/// strains are: the mean of the nodes on elements of first order; on those of second order the functions of
/// first order that come nearest to the values at the nodes (least squares), with reduced integration the
/// element's own, which do that at its points.
class TemperatureField {
 public:
  /// @param mesh has to outlive it.
  TemperatureField(const Mesh& mesh, const ReferenceElement& element, Integration integration);
  /// At point q of a cell. @param nodal of all nodes of the mesh.
  double at(const std::vector<double>& nodal, int cell, int q) const;

 private:
  const Mesh& mesh_;
  std::vector<std::vector<double>> weights_; // of the values at the nodes, at each point
};

/// The functions that the dilatation of a cell is projected onto, see Dilatation, at its quadrature points:
/// 1, or 1, x, y(, z), relative to the centre of the cell and over its length.
class DilatationSpace {
 public:
  DilatationSpace(const Mesh& mesh, const CellIntegrator& cell);

  /// For the cell that the integrator has turned to.
  void update();

  std::size_t size() const { return size_; }
  /// What coordinates are divided by: the root of the cell's size. Of no use where 1 is alone.
  double length() const { return length_; }
  /// The functions at point q.
  const double* at(std::size_t q) const { return values_.data() + q * size_; }

 private:
  const CellIntegrator& cell_;
  std::size_t dimension_, size_;
  double length_ = 1.0;
  std::vector<double> values_;
};

/// B̄ of a cell at all its quadrature points: strains of the basis functions, see Dilatation.
class StrainOperator {
 public:
  StrainOperator(const Mesh& mesh, const CellIntegrator& cell, bool projected);

  /// Rows of strains that take part: xx, yy, zz, xy in the plane, of which zz is around the axis of
  /// axisymmetric meshes; else six.
  std::size_t rows() const { return rows_; }
  std::size_t dofs() const { return dofs_; }

  /// Row r of B̄ at point q.
  const double* row(int q, std::size_t r) const {
    return values_.data() + (static_cast<std::size_t>(q) * rows_ + r) * dofs_;
  }

  /// For the cell that the integrator has turned to.
  void update();

  /// σ = C(ε̄ − ε_T) at a point. @param values the cell's displacements, node by node.
  Voigt stress(int q, const double* values, const VoigtMatrix& stiffness, const Voigt& thermalStrain) const;

 private:
  double* at(int q, std::size_t r) {
    return values_.data() + (static_cast<std::size_t>(q) * rows_ + r) * dofs_;
  }
  void project();

  const CellIntegrator& cell_;
  std::size_t dimension_, rows_, dofs_;
  bool projected_, hasHoop_;
  DilatationSpace space_;
  std::vector<double> values_;
};

} // namespace Harmos::fem
