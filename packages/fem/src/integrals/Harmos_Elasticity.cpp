// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Elasticity.hpp"

#include "Harmos_StrainOperator.hpp"

#include <algorithm>

namespace Harmos::fem {

LocalMatrix assembleElasticity(const Mesh& mesh, const Elasticity& elasticity) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  CellIntegrator cell(mesh, element);
  StrainOperator strain(mesh, cell, isProjected(mesh, elasticity));
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  BlockAssembler assembler(mesh, mesh.dimension());
  const std::size_t n = strain.dofs(), rows = strain.rows();
  std::vector<double> k(n * n), stress(rows * n);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    strain.update();
    const VoigtMatrix& material = stiffnessOf(stiffness, mesh.region(c));
    std::fill(k.begin(), k.end(), 0.0);
    for (int q = 0; q < cell.points(); ++q) {
      std::fill(stress.begin(), stress.end(), 0.0);
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t s = 0; s < rows; ++s) {
          const double entry = cell.measure(q) * material[r][s];
          if (entry != 0.0)
            for (std::size_t j = 0; j < n; ++j)
              stress[r * n + j] += entry * strain.row(q, s)[j];
        }
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t i = 0; i < n; ++i) {
          const double b = strain.row(q, r)[i];
          if (b != 0.0)
            for (std::size_t j = 0; j < n; ++j)
              k[i * n + j] += b * stress[r * n + j];
        }
    }
    assembler.add(c, k);
  }
  return assembler.take();
}

namespace {

// @param rise of the temperature at a point of a cell.
template<class Rise>
std::vector<double> thermalLoad(const Mesh& mesh, const ReferenceElement& element,
                                const Elasticity& elasticity, const Rise& rise) {
  CellIntegrator cell(mesh, element);
  StrainOperator strain(mesh, cell, isProjected(mesh, elasticity));
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()) * dimension, 0.0);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    strain.update();
    const VoigtMatrix& material = stiffnessOf(stiffness, mesh.region(c));
    const Voigt expansion = elasticity.materials[static_cast<std::size_t>(mesh.region(c))].thermalStrain();
    for (std::size_t r = 0; r < strain.rows(); ++r)
      for (int q = 0; q < cell.points(); ++q) {
        double stress = 0.0;
        for (std::size_t s = 0; s < 6; ++s)
          stress += material[r][s] * expansion[s] * rise(c, q);
        for (std::size_t j = 0; j < strain.dofs() && stress != 0.0; ++j)
          f[static_cast<std::size_t>(mesh.cell(c)[j / dimension]) * dimension + j % dimension] +=
              cell.measure(q) * stress * strain.row(q, r)[j];
      }
  }
  return f;
}

// The same.
template<class Rise>
double energyOf(const Mesh& mesh, const ReferenceElement& element, const Elasticity& elasticity,
                const Rise& rise) {
  CellIntegrator cell(mesh, element);
  std::vector<double> densities; // of each region, for one degree
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  for (std::size_t region = 0; region < elasticity.materials.size(); ++region) {
    const Voigt expansion = elasticity.materials[region].thermalStrain();
    const VoigtMatrix& material = stiffnessOf(stiffness, static_cast<int>(region));
    double density = 0.0;
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s)
        density += 0.5 * expansion[r] * material[r][s] * expansion[s];
    densities.push_back(density);
  }
  double energy = 0.0;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (int q = 0; q < cell.points(); ++q)
      energy +=
          cell.measure(q) * densities[static_cast<std::size_t>(mesh.region(c))] * rise(c, q) * rise(c, q);
  }
  return energy;
}

ReferenceElement elementOf(const Mesh& mesh, const Elasticity& elasticity) {
  return {mesh.cellType, stiffnessDegree(mesh, elasticity.integration)};
}

} // namespace

std::vector<double> assembleThermalLoad(const Mesh& mesh, const Elasticity& elasticity, double temperature) {
  return thermalLoad(mesh, elementOf(mesh, elasticity), elasticity, [=](int, int) { return temperature; });
}

std::vector<double> assembleThermalLoad(const Mesh& mesh, const Elasticity& elasticity,
                                        const std::vector<double>& temperatures) {
  const ReferenceElement element = elementOf(mesh, elasticity);
  const TemperatureField field(mesh, element, elasticity.integration);
  return thermalLoad(mesh, element, elasticity, [&](int c, int q) { return field.at(temperatures, c, q); });
}

double thermalEnergy(const Mesh& mesh, const Elasticity& elasticity) {
  return energyOf(mesh, elementOf(mesh, elasticity), elasticity, [](int, int) { return 1.0; });
}

double thermalEnergy(const Mesh& mesh, const Elasticity& elasticity,
                     const std::vector<double>& temperatures) {
  const ReferenceElement element = elementOf(mesh, elasticity);
  const TemperatureField field(mesh, element, elasticity.integration);
  return energyOf(mesh, element, elasticity, [&](int c, int q) { return field.at(temperatures, c, q); });
}

} // namespace Harmos::fem
