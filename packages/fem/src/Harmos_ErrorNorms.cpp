// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ErrorNorms.hpp"

#include "Harmos_CellIntegrator.hpp"

namespace Harmos::fem {

SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, const Elasticity& elasticity,
                            const std::vector<double>& displacement, const VectorField& exact,
                            const std::function<std::array<Point, 3>(const Point&)>& gradient) {
  const ReferenceElement element(mesh.cellType, 8);
  CellIntegrator cell(mesh, element);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  SquaredErrors errors;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    const VoigtMatrix material =
        elasticity.materials.at(static_cast<std::size_t>(mesh.region(c))).stiffness(elasticity.kinematics);
    for (int q = 0; q < cell.points(); ++q) {
      Point x = cell.position(q), u{};
      for (std::size_t d = 0; d < 3; ++d)
        x[d] += anchor[d];
      const Point truth = exact(x);
      std::array<Point, 3> g = gradient(x);
      for (std::size_t d = 0; d < 3; ++d)
        u[d] -= truth[d];
      for (auto& row : g)
        for (double& entry : row)
          entry = -entry;
      for (int i = 0; i < cell.basisSize(); ++i)
        for (std::size_t a = 0; a < dimension; ++a) {
          const double value = displacement[static_cast<std::size_t>(mesh.cell(c)[i]) * dimension + a];
          u[a] += cell.value(i, q) * value;
          for (std::size_t b = 0; b < dimension; ++b)
            g[a][b] += cell.gradient(i, q)[b] * value;
        }
      const Voigt e = {g[0][0], g[1][1], g[2][2], g[0][1] + g[1][0], g[1][2] + g[2][1], g[0][2] + g[2][0]};
      for (std::size_t d = 0; d < dimension; ++d)
        errors.l2 += cell.measure(q) * u[d] * u[d];
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t s = 0; s < 6; ++s)
          errors.energy += cell.measure(q) * e[r] * material[r][s] * e[s];
    }
  }
  return errors;
}

} // namespace Harmos::fem
