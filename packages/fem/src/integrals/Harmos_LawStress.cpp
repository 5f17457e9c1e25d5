// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LawStress.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {

LawStress::LawStress(const Mesh& mesh, const CellIntegrator& cell, const Elasticity& elasticity)
    : isPlaneStress_(elasticity.kinematics == Kinematics::PlaneStress),
      laws_(elasticity),
      unused_(laws_.stateSize()) {
  if (elasticity.strains == Strains::Finite)
    finite_ = std::make_unique<FiniteStrain>(mesh, cell, isProjected(mesh, elasticity));
  else
    small_ = std::make_unique<SmallStrain>(mesh, cell, isProjected(mesh, elasticity));
}

bool LawStress::isOf(const Elasticity& elasticity) {
  return elasticity.strains == Strains::Finite || MaterialLaws(elasticity).stateSize() > 0;
}

void LawStress::turnTo(const Mesh& mesh, int cell) {
  law_ = &laws_.of(mesh.region(cell));
  number_ = cell;
}

void LawStress::update(const double* values, const MaterialStates* states) {
  states_ = states;
  if (finite_)
    finite_->update(values, false);
  else
    small_->update(values);
}

double LawStress::shownAt(int q) const {
  return states_ != nullptr ? law_->shownState(stateAt(q)) : 0.0;
}

Voigt LawStress::at(int q, double rise) {
  if (small_)
    return law_->at(small_->strain(q), rise, stateAt(q), unused_.data()).stress;
  if (!(finite_->leastJacobian() > 0.0))
    return {};
  return cauchy(q, law_->at(finite_->strain(q), rise, stateAt(q), unused_.data()));
}

Voigt LawStress::cauchy(int q, const MaterialResponse& response) const {
  Voigt stress{};
  DeformationGradient f = finite_->gradient(q);
  for (auto& row : f)
    for (double& entry : row)
      entry *= finite_->factor(q);
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
