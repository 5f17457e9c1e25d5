// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiniteStress.hpp"

#include <cmath>

namespace Harmos::fem {

FiniteStress::FiniteStress(const Mesh& mesh, const CellIntegrator& cell, const Elasticity& elasticity)
    : isPlaneStress_(elasticity.kinematics == Kinematics::PlaneStress),
      strain_(mesh, cell, isProjected(mesh, elasticity)),
      laws_(elasticLaws(elasticity)) {}

Voigt FiniteStress::at(int q, double rise) const {
  Voigt stress{};
  if (!(strain_.leastJacobian() > 0.0))
    return stress;
  const ElasticResponse response = law_->at(strain_.strain(q), rise);
  DeformationGradient f = strain_.gradient(q);
  for (auto& row : f)
    for (double& entry : row)
      entry *= strain_.factor(q);
  if (isPlaneStress_)
    f[2][2] = std::sqrt(1.0 + 2.0 * response.across);
  const double det = determinant(f);
  constexpr std::array<std::array<std::size_t, 3>, 3> place = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l)
          stress[place[i][j]] += f[i][k] * response.stress[place[k][l]] * f[j][l] / det;
  return stress;
}

} // namespace Harmos::fem
