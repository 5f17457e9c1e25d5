// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiniteElasticity.hpp"

#include "Harmos_ElasticLaw.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FiniteStrain.hpp"
#include "Harmos_StrainOperator.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace Harmos::fem {
namespace {

enum class Needs { Forces, Tangent };

// Of all nodes.
struct Given {
  const std::vector<double>& displacement;
  const TemperatureRise& rise;
};

// Goes from cell to cell with the strains of a displacement; visit(cell number, integrator, strain,
// response at point q).
template<class Visit>
void visitCells(const Mesh& mesh, const Elasticity& elasticity, const Given& given, Needs needs,
                const Visit& visit) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  CellIntegrator cell(mesh, element);
  FiniteStrain strain(mesh, cell, isProjected(mesh, elasticity));
  const std::vector<ElasticLaw> laws = elasticLaws(elasticity);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::optional<TemperatureField> field;
  if (given.rise.nodal)
    field.emplace(mesh, element, elasticity.integration);
  std::vector<double> values(strain.dofs());
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = given.displacement[static_cast<std::size_t>(mesh.cell(c)[i / dimension]) * dimension +
                                     i % dimension];
    strain.update(values.data(), needs == Needs::Tangent || strain.isProjected());
    const ElasticLaw& law = elasticLawOf(laws, mesh.region(c));
    const auto responseAt = [&](int q) {
      return law.at(strain.strain(q),
                    given.rise.uniform + (field ? field->at(*given.rise.nodal, c, q) : 0.0));
    };
    if (!visit(c, cell, strain, responseAt))
      return;
  }
}

} // namespace

namespace {

// f += weight BᵀS at a point. Without projection B_i δu = sym(Fᵀ(δu ⊗ ∇φ_i)): f_i = FS∇φ_i.
void addForces(const CellIntegrator& cell, const FiniteStrain& strain, int q, const Voigt& stress,
               std::vector<double>& f) {
  if (strain.isProjected()) {
    for (std::size_t r = 0; r < strain.rows(); ++r)
      for (std::size_t j = 0; j < strain.dofs() && stress[r] != 0.0; ++j)
        f[j] += cell.measure(q) * stress[r] * strain.row(q, r)[j];
    return;
  }
  const std::size_t dimension = strain.dofs() / static_cast<std::size_t>(cell.basisSize());
  Tensor s{}, first{};
  for (std::size_t r = 0; r < 6; ++r)
    s[voigtPairs[r][0]][voigtPairs[r][1]] = s[voigtPairs[r][1]][voigtPairs[r][0]] =
        cell.measure(q) * stress[r];
  const DeformationGradient& gradient = strain.gradient(q);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c)
        first[a][b] += gradient[a][c] * s[c][b];
  for (int i = 0; i < cell.basisSize(); ++i) {
    const Point& g = cell.gradient(i, q);
    double* own = f.data() + static_cast<std::size_t>(i) * dimension;
    for (std::size_t a = 0; a < dimension; ++a)
      for (std::size_t b = 0; b < dimension; ++b)
        own[a] += first[a][b] * g[b];
    if (strain.hasHoop())
      own[0] += first[2][2] * cell.value(i, q) / cell.position(q)[0];
  }
}

} // namespace

FiniteForces finiteForces(const Mesh& mesh, const Elasticity& elasticity,
                          const std::vector<double>& displacement, const TemperatureRise& rise) {
  FiniteForces result;
  result.internal.assign(displacement.size(), 0.0);
  result.leastJacobian = std::numeric_limits<double>::infinity();
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> own;
  visitCells(mesh, elasticity, {displacement, rise}, Needs::Forces,
             [&](int c, const CellIntegrator& cell, const FiniteStrain& strain, const auto& responseAt) {
               result.leastJacobian = std::min(result.leastJacobian, strain.leastJacobian());
               if (!(result.leastJacobian > 0.0))
                 return false;
               own.assign(strain.dofs(), 0.0);
               for (int q = 0; q < cell.points(); ++q) {
                 const ElasticResponse response = responseAt(q);
                 result.energy += cell.measure(q) * response.energy;
                 addForces(cell, strain, q, response.stress, own);
               }
               for (std::size_t j = 0; j < own.size(); ++j)
                 result.internal[static_cast<std::size_t>(mesh.cell(c)[j / dimension]) * dimension +
                                 j % dimension] += own[j];
               return true;
             });
  return result;
}

namespace {

// k += weight BᵀDB at a point. @param stress of the length of B, for the work.
void addProduct(const FiniteStrain& strain, int q, double weight, const VoigtMatrix& tangent,
                std::vector<double>& stress, std::vector<double>& k) {
  const std::size_t n = strain.dofs(), rows = strain.rows();
  std::fill(stress.begin(), stress.end(), 0.0);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t s = 0; s < rows; ++s)
      if (const double entry = weight * tangent[r][s]; entry != 0.0)
        for (std::size_t j = 0; j < n; ++j)
          stress[r * n + j] += entry * strain.row(q, s)[j];
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t i = 0; i < n; ++i)
      if (const double b = strain.row(q, r)[i]; b != 0.0)
        for (std::size_t j = 0; j < n; ++j)
          k[i * n + j] += b * stress[r * n + j];
}

} // namespace

LocalMatrix assembleStrainTangent(const Mesh& mesh, const Elasticity& elasticity,
                                  const std::vector<double>& displacement, const TemperatureRise& rise) {
  BlockAssembler assembler(mesh, mesh.dimension());
  std::vector<double> k, stress;
  visitCells(mesh, elasticity, {displacement, rise}, Needs::Tangent,
             [&](int c, const CellIntegrator& cell, const FiniteStrain& strain, const auto& responseAt) {
               HARMOS_REQUIRE(strain.leastJacobian() > 0.0, "a cell is turned inside out");
               k.assign(strain.dofs() * strain.dofs(), 0.0);
               stress.resize(strain.rows() * strain.dofs());
               for (int q = 0; q < cell.points(); ++q)
                 addProduct(strain, q, cell.measure(q),
                            strainTangent(responseAt(q), strain.strain(q), elasticity.kinematics), stress, k);
               assembler.add(c, k);
               return true;
             });
  return assembler.take();
}

} // namespace Harmos::fem
