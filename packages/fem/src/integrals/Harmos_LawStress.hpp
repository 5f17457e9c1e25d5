// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FiniteStrain.hpp"
#include "Harmos_MaterialStates.hpp"
#include "Harmos_SmallStrain.hpp"

#include <memory>
#include <vector>

namespace Harmos::fem {

/// Stresses at the points of one cell after another by the laws of materials: of small strains σ, of finite
/// ones Cauchy's σ = F̄SF̄ᵀ/J̄, see FiniteStrain.
class LawStress {
 public:
  LawStress(const Mesh& mesh, const CellIntegrator& cell, const Elasticity& elasticity);

  /// Whether a mesh needs it: others have stresses of their stiffness.
  static bool isOf(const Elasticity& elasticity);

  /// For the cell that the integrator has turned to. @throws InternalError if its region has no material.
  void turnTo(const Mesh& mesh, int cell);
  /// @param values the cell's displacements, node by node. @param states of the mesh with them, where
  /// materials have any.
  void update(const double* values, const MaterialStates* states);
  /// Zero where the cell is turned inside out. @param rise of the temperature there.
  Voigt at(int q, double rise);
  /// MaterialLaw::shownState().
  double shownAt(int q) const;

 private:
  Voigt cauchy(int q, const MaterialResponse& response) const;
  const double* stateAt(int q) const { return states_ != nullptr ? states_->at(number_, q) : nullptr; }

  bool isPlaneStress_;
  std::unique_ptr<FiniteStrain> finite_; // or
  std::unique_ptr<SmallStrain> small_;
  MaterialLaws laws_;
  const MaterialLaw* law_ = nullptr;
  int number_ = 0;
  const MaterialStates* states_ = nullptr;
  std::vector<double> unused_;
};

} // namespace Harmos::fem
