// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiniteElasticity.hpp"

#include "Harmos_ElasticLaw.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FiniteStrain.hpp"
#include "Harmos_SmallStrain.hpp"
#include "Harmos_StrainOperator.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace Harmos::fem {
namespace {

enum class Needs { Forces, Tangent };

// Of all nodes and points.
struct Given {
  const std::vector<double>& displacement;
  const TemperatureRise& rise;
  const MaterialStates* before;
  MaterialStates* after;
};

bool needsRows(const FiniteStrain& strain) {
  return strain.isProjected();
}

bool needsRows(const SmallStrain&) {
  return true;
}

// Goes from cell to cell with the strains of a displacement; visit(cell number, integrator, strain,
// response at point q).
template<class Strain, class Visit>
void visitCells(const Mesh& mesh, const Elasticity& elasticity, const Given& given, Needs needs,
                const Visit& visit) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  CellIntegrator cell(mesh, element);
  Strain strain(mesh, cell, isProjected(mesh, elasticity));
  const MaterialLaws laws(elasticity);
  HARMOS_REQUIRE(laws.stateSize() == 0 || given.before != nullptr, "materials have states");
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::optional<TemperatureField> field;
  if (given.rise.nodal)
    field.emplace(mesh, element, elasticity.integration);
  std::vector<double> values(strain.dofs()), unused(laws.stateSize());
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = given.displacement[static_cast<std::size_t>(mesh.cell(c)[i / dimension]) * dimension +
                                     i % dimension];
    strain.update(values.data(), needs == Needs::Tangent || needsRows(strain));
    const MaterialLaw& law = laws.of(mesh.region(c));
    const auto responseAt = [&](int q) {
      return law.at(strain.strain(q), given.rise.uniform + (field ? field->at(*given.rise.nodal, c, q) : 0.0),
                    given.before != nullptr ? given.before->at(c, q) : nullptr,
                    given.after != nullptr ? given.after->at(c, q) : unused.data());
    };
    if (!visit(c, cell, strain, responseAt))
      return;
  }
}

// By rows of B.
template<class Strain>
void addByRows(double weight, const Strain& strain, int q, const Voigt& stress, std::vector<double>& f) {
  for (std::size_t r = 0; r < strain.rows(); ++r)
    for (std::size_t j = 0; j < strain.dofs() && stress[r] != 0.0; ++j)
      f[j] += weight * stress[r] * strain.row(q, r)[j];
}

void addForces(const CellIntegrator& cell, const SmallStrain& strain, int q, const Voigt& stress,
               std::vector<double>& f) {
  addByRows(cell.measure(q), strain, q, stress, f);
}

// f += weight BᵀS at a point. Without projection B_i δu = sym(Fᵀ(δu ⊗ ∇φ_i)): f_i = FS∇φ_i.
void addForces(const CellIntegrator& cell, const FiniteStrain& strain, int q, const Voigt& stress,
               std::vector<double>& f) {
  if (strain.isProjected()) {
    addByRows(cell.measure(q), strain, q, stress, f);
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

template<class Strain>
FiniteForces forcesBy(const Mesh& mesh, const Elasticity& elasticity, const Given& given) {
  FiniteForces result;
  result.internal.assign(given.displacement.size(), 0.0);
  result.leastJacobian = std::numeric_limits<double>::infinity();
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> own;
  visitCells<Strain>(mesh, elasticity, given, Needs::Forces,
                     [&](int c, const CellIntegrator& cell, const Strain& strain, const auto& responseAt) {
                       result.leastJacobian = std::min(result.leastJacobian, strain.leastJacobian());
                       if (!(result.leastJacobian > 0.0))
                         return false;
                       own.assign(strain.dofs(), 0.0);
                       for (int q = 0; q < cell.points(); ++q) {
                         const MaterialResponse response = responseAt(q);
                         result.energy += cell.measure(q) * response.energy;
                         result.dissipated += cell.measure(q) * response.dissipated;
                         result.yielding += response.yields ? 1 : 0;
                         addForces(cell, strain, q, response.stress, own);
                       }
                       for (std::size_t j = 0; j < own.size(); ++j)
                         result.internal[static_cast<std::size_t>(mesh.cell(c)[j / dimension]) * dimension +
                                         j % dimension] += own[j];
                       return true;
                     });
  return result;
}

} // namespace

FiniteForces finiteForces(const Mesh& mesh, const Elasticity& elasticity,
                          const std::vector<double>& displacement, const TemperatureRise& rise,
                          const MaterialStates* before, MaterialStates* after) {
  const Given given = {displacement, rise, before, after};
  return elasticity.strains == Strains::Small ? forcesBy<SmallStrain>(mesh, elasticity, given)
                                              : forcesBy<FiniteStrain>(mesh, elasticity, given);
}

namespace {

// k += weight BᵀDB at a point. @param stress of the length of B, for the work.
template<class Strain>
void addProduct(const Strain& strain, int q, double weight, const VoigtMatrix& tangent,
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

VoigtMatrix tangentOf(const MaterialResponse& response, const FiniteStrain& strain, int q,
                      Kinematics kinematics) {
  return strainTangent(response, strain.strain(q), kinematics);
}

VoigtMatrix tangentOf(const MaterialResponse& response, const SmallStrain&, int, Kinematics) {
  return response.tangent;
}

template<class Strain>
LocalMatrix tangentBy(const Mesh& mesh, const Elasticity& elasticity, const Given& given) {
  BlockAssembler assembler(mesh, mesh.dimension());
  std::vector<double> k, stress;
  visitCells<Strain>(mesh, elasticity, given, Needs::Tangent,
                     [&](int c, const CellIntegrator& cell, const Strain& strain, const auto& responseAt) {
                       HARMOS_REQUIRE(strain.leastJacobian() > 0.0, "a cell is turned inside out");
                       k.assign(strain.dofs() * strain.dofs(), 0.0);
                       stress.resize(strain.rows() * strain.dofs());
                       for (int q = 0; q < cell.points(); ++q)
                         addProduct(strain, q, cell.measure(q),
                                    tangentOf(responseAt(q), strain, q, elasticity.kinematics), stress, k);
                       assembler.add(c, k);
                       return true;
                     });
  return assembler.take();
}

} // namespace

LocalMatrix assembleStrainTangent(const Mesh& mesh, const Elasticity& elasticity,
                                  const std::vector<double>& displacement, const TemperatureRise& rise,
                                  const MaterialStates* before) {
  const Given given = {displacement, rise, before, nullptr};
  return elasticity.strains == Strains::Small ? tangentBy<SmallStrain>(mesh, elasticity, given)
                                              : tangentBy<FiniteStrain>(mesh, elasticity, given);
}

} // namespace Harmos::fem
