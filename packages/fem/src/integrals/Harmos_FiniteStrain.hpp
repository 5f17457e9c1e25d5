// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Material.hpp"
#include "Harmos_StrainOperator.hpp"
#include "Harmos_Tensors.hpp"

#include <vector>

namespace Harmos::fem {

/// F = ∂x/∂X.
using DeformationGradient = Tensor;

/// Green's strain E = ½(FᵀF − I) of a cell's displacements at its quadrature points, and its derivative
/// δE = B(u)δu, rows as of StrainOperator.
///
/// δE = sym(FᵀδF) vanishes for δu = ω × x, whatever F: the kernel of ∫BᵀDB is the rigid motions of the
/// deformed body.
///
/// With a projected dilatation F̄ = (J̄/J)^{1/3}F stands for F, J̄ the projection of J = det F onto
/// DilatationSpace (Moran, Ortiz, Shih: Formulation of implicit finite element methods for multiplicative
/// finite deformation plasticity, Int. J. Numer. Meth. Engng. 29, 1990): B̄(u) is the derivative of Ē, so
/// forces have an energy, and at u = 0 that of B-bar.
///
/// Guarded by tests/unit/fem/test_finite_elasticity.cpp.
class FiniteStrain {
 public:
  FiniteStrain(const Mesh& mesh, const CellIntegrator& cell, bool projected);

  std::size_t rows() const { return rows_; }
  std::size_t dofs() const { return dofs_; }
  bool isProjected() const { return projected_; }
  bool hasHoop() const { return hasHoop_; }

  /// For the cell that the integrator has turned to. @param values its displacements, node by node.
  /// @param needsOperator whether row() will be asked.
  void update(const double* values, bool needsOperator = true);

  /// The least J of the cell: not positive where it is turned inside out; the rest is of no use then.
  double leastJacobian() const { return leastJacobian_; }
  /// Of the displacements themselves; F_zz of the kinematics but plane stress.
  const DeformationGradient& gradient(int q) const { return gradients_[static_cast<std::size_t>(q)]; }
  /// E, or Ē; zz as of plane strain where there is none.
  const Voigt& strain(int q) const { return strains_[static_cast<std::size_t>(q)]; }
  /// What F is multiplied by for Ē: (J̄/J)^{1/3}.
  double factor(int q) const { return factors_[static_cast<std::size_t>(q)]; }
  /// Row r of B(u) at point q.
  const double* row(int q, std::size_t r) const {
    return values_.data() + (static_cast<std::size_t>(q) * rows_ + r) * dofs_;
  }

 private:
  double* at(std::size_t q, std::size_t r) { return values_.data() + (q * rows_ + r) * dofs_; }
  std::size_t points() const { return gradients_.size(); }
  void findGradients(const double* values);
  void findProjection();
  void projectStrains();
  void findOperator();
  void findChangesOfVolume(std::vector<double>& changes) const;
  void project();

  const CellIntegrator& cell_;
  std::size_t dimension_, rows_, dofs_;
  bool projected_, hasHoop_;
  DilatationSpace space_;
  double leastJacobian_ = 0.0;
  std::vector<DeformationGradient> gradients_;
  std::vector<double> dilatations_, smooth_; // J − 1 and its projection
  std::vector<double> projection_;           // a matrix, of values at points
  std::vector<double> factors_;
  std::vector<Voigt> strains_;
  std::vector<double> values_;
};

} // namespace Harmos::fem
