// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_KktAudit.hpp"

#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti {
namespace {

// Maximum and minimum that keep a NaN, which std::max and std::min lose.
double largerOf(double a, double b) {
  return std::isnan(b) || b > a ? b : a;
}
double smallerOf(double a, double b) {
  return std::isnan(b) || b < a ? b : a;
}

// Over the ranks; MPI need not keep a NaN either.
double globalLargest(const Teuchos::Comm<int>& comm, double value) {
  const bool bad = globalMax(comm, std::isnan(value) ? 1LL : 0LL) > 0;
  const double result = globalMax(comm, std::isnan(value) ? 0.0 : value);
  return bad ? std::numeric_limits<double>::quiet_NaN() : result;
}

} // namespace

KktAudit audit(const SubdomainSystem& system, const Constraints& constraints, const TornSolution& solution) {
  const Teuchos::Comm<int>& comm = *system.comm();
  KktAudit result;

  const std::vector<double> overlap = constraints.toOverlap(*solution.multiplier);
  std::vector<double> sums(3, 0.0); // ‖residual‖², ‖f‖², energy
  std::vector<double> image;
  double largest = 0.0;
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double>& u = solution.displacement[static_cast<std::size_t>(i)];
    const Subdomain& physical = system.subdomain(i);
    image.resize(u.size());
    const auto addEnergy = [&] {
      for (std::size_t j = 0; j < u.size(); ++j)
        sums[2] += u[j] * (0.5 * image[j] - (*physical.load)[j]);
    };
    const bool hasTrivialEquations = physical.stiffness.get() != &system.matrix(i);
    if (hasTrivialEquations) {
      physical.stiffness->multiply(u.data(), image.data());
      addEnergy();
    }
    system.matrix(i).multiply(u.data(), image.data());
    if (!hasTrivialEquations)
      addEnergy();
    for (std::size_t j = 0; j < u.size(); ++j)
      image[j] -= system.rhs(i)[j];
    constraints.addBt(i, overlap.data(), image.data());
    for (std::size_t j = 0; j < u.size(); ++j) {
      sums[0] += image[j] * image[j];
      sums[1] += system.rhs(i)[j] * system.rhs(i)[j];
      largest = largerOf(largest, std::abs(u[j]));
    }
  }
  globalSum(comm, sums);
  result.equilibrium = sums[1] > 0.0 ? std::sqrt(sums[0] / sums[1]) : std::sqrt(sums[0]);
  result.primalEnergy = sums[2];
  result.largestDisplacement = globalLargest(comm, largest);

  MultiVector rows(constraints.rowMap(), 1);
  constraints.applyB(solution.displacement, rows);
  double jump = 0.0, penetration = 0.0, product = 0.0, work = 0.0, force = 0.0;
  double least = std::numeric_limits<double>::infinity();
  {
    const auto values = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto lambda = solution.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t r = 0; r < values.extent(0); ++r) {
      const int row = static_cast<int>(r);
      const double scale = constraints.rowScale(row);
      const double excess = (values(r, 0) - constraints.bound(row)) / scale;
      work += lambda(r, 0) * scale * excess;
      if (constraints.rowType(row) == RowType::Inequality) {
        penetration = largerOf(penetration, excess);
        least = smallerOf(least, lambda(r, 0) * scale);
        force = largerOf(force, std::abs(lambda(r, 0) * scale));
        product += lambda(r, 0) * scale * excess;
      } else {
        jump = largerOf(jump, std::abs(excess));
      }
    }
  }
  result.gluingJump = globalLargest(comm, jump);
  result.penetration = globalLargest(comm, penetration);
  least = -globalLargest(comm, -least);
  result.minContactMultiplier = constraints.inequalities() > 0 ? least : 0.0;
  result.complementarity = std::abs(globalSum(comm, product));
  result.energy = result.primalEnergy + globalSum(comm, work);
  result.largestMultiplier = globalLargest(comm, force);
  return result;
}

ContactState contactState(const Constraints& constraints, const TornSolution& solution) {
  MultiVector rows(constraints.rowMap(), 1);
  constraints.applyB(solution.displacement, rows);
  const auto values = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
  ContactState state;
  for (std::size_t r = 0; r < values.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (constraints.rowType(row) != RowType::Inequality)
      continue;
    const double scale = constraints.rowScale(row);
    state.row.push_back(static_cast<long long>(constraints.rowMap()->getGlobalElement(row)));
    state.gap.push_back((constraints.bound(row) - values(r, 0)) / scale);
    state.force.push_back(lambda(r, 0) * scale);
  }
  return state;
}

} // namespace Harmos::feti
