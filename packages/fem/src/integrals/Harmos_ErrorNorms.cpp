// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ErrorNorms.hpp"

#include "Harmos_CellIntegrator.hpp"

#include <algorithm>

namespace Harmos::fem {

EnergyDensity elasticEnergy(const Elasticity& elasticity) {
  std::vector<VoigtMatrix> stiffness;
  for (const Material& material : elasticity.materials)
    stiffness.push_back(material.stiffness(elasticity.kinematics));
  return [stiffness](int region, const std::array<Point, 3>& g) {
    const VoigtMatrix& material = stiffness.at(static_cast<std::size_t>(region));
    const Voigt e = {g[0][0], g[1][1], g[2][2], g[0][1] + g[1][0], g[1][2] + g[2][1], g[0][2] + g[2][0]};
    double sum = 0.0;
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s)
        sum += e[r] * material[r][s] * e[s];
    return sum;
  };
}

EnergyDensity membraneEnergy() {
  return [](int, const std::array<Point, 3>& g) { return g[0][0] * g[0][0] + g[0][1] * g[0][1]; };
}

int errorDegree(CellType type) {
  return std::max(stiffnessDegree(type), 2 * shapeOf(type).order);
}

SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, int degree, int components,
                            const std::vector<double>& displacement, const EnergyDensity& energy,
                            const FieldSample& other) {
  const ReferenceElement element(mesh.cellType, degree);
  CellIntegrator cell(mesh, element);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  const auto m = static_cast<std::size_t>(components);
  SquaredErrors errors;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (int q = 0; q < cell.points(); ++q) {
      Point x = cell.position(q);
      for (std::size_t d = 0; d < 3; ++d)
        x[d] += anchor[d];
      const FieldValue truth = other(c, q, x);
      Point u{};
      std::array<Point, 3> g{};
      for (std::size_t a = 0; a < m; ++a) {
        u[a] = -truth.value[a];
        for (std::size_t b = 0; b < dimension; ++b)
          g[a][b] = -truth.gradient[a][b];
      }
      for (int i = 0; i < cell.basisSize(); ++i)
        for (std::size_t a = 0; a < m; ++a) {
          const double value = displacement[static_cast<std::size_t>(mesh.cell(c)[i]) * m + a];
          u[a] += cell.value(i, q) * value;
          for (std::size_t b = 0; b < dimension; ++b)
            g[a][b] += cell.gradient(i, q)[b] * value;
        }
      if (mesh.isAxisymmetric)
        g[2][2] = u[0] / cell.position(q)[0];
      for (std::size_t a = 0; a < m; ++a)
        errors.l2 += cell.measure(q) * u[a] * u[a];
      errors.energy += cell.measure(q) * energy(mesh.region(c), g);
    }
  }
  return errors;
}

SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, const Elasticity& elasticity,
                            const std::vector<double>& displacement, const VectorField& exact,
                            const std::function<std::array<Point, 3>(const Point&)>& gradient) {
  constexpr int highDegree = 8;
  return squaredErrors(mesh, anchor, highDegree, mesh.dimension(), displacement, elasticEnergy(elasticity),
                       [&](int, int, const Point& x) {
                         return FieldValue{exact(x), gradient(x)};
                       });
}

} // namespace Harmos::fem
