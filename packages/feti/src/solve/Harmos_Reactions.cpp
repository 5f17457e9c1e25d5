// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Reactions.hpp"

namespace Harmos::feti {
namespace {

// A row of K times u.
double product(const LocalMatrix& matrix, int row, const std::vector<double>& u) {
  const auto i = static_cast<std::size_t>(row);
  double sum = 0.0;
  for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
    sum += matrix.values[k] * u[static_cast<std::size_t>(matrix.columns[k])];
  return sum;
}

} // namespace

std::vector<std::vector<double>> reactions(const SubdomainSystem& system, const Constraints& constraints,
                                           const TornSolution& solution) {
  std::vector<std::vector<double>> result = constraints.heldForces(*solution.multiplier);
  for (int i = 0; i < system.size(); ++i) {
    const Subdomain& physical = system.subdomain(i);
    if (physical.fixed.empty())
      continue;
    // K times a large rigid motion is rounding errors alone; KR = 0 has been verified.
    std::vector<double> strained = solution.displacement[static_cast<std::size_t>(i)];
    removeKernel(system.kernel(i), strained);
    std::vector<double>& forces = result[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < physical.fixed.size(); ++k) {
      const int dof = physical.fixed[k].dof;
      forces[k] +=
          product(*physical.stiffness, dof, strained) - (*physical.load)[static_cast<std::size_t>(dof)];
    }
  }
  return result;
}

} // namespace Harmos::feti
