// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ElasticLaw.hpp"
#include "Harmos_FiniteStrain.hpp"

#include <vector>

namespace Harmos::fem {

/// Cauchy's stress σ = F̄SF̄ᵀ/J̄ at the points of one cell after another; see FiniteStrain.
class FiniteStress {
 public:
  FiniteStress(const Mesh& mesh, const CellIntegrator& cell, const Elasticity& elasticity);

  /// For the cell that the integrator has turned to. @throws InternalError if its region has no material.
  void turnTo(int region) { law_ = &elasticLawOf(laws_, region); }
  /// @param values the cell's displacements, node by node.
  void update(const double* values) { strain_.update(values, false); }
  /// Zero where the cell is turned inside out. @param rise of the temperature there.
  Voigt at(int q, double rise) const;

 private:
  bool isPlaneStress_;
  FiniteStrain strain_;
  std::vector<ElasticLaw> laws_;
  const ElasticLaw* law_ = nullptr;
};

} // namespace Harmos::fem
