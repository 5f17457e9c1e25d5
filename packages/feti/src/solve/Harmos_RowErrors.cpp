// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

// Solvers keep forces within their limits to the last bit, but for the rounding errors of the shift.
bool isAtLimit(double force, double limit) {
  constexpr double rounding = 1e-9;
  return force >= (1.0 - rounding) * limit;
}

template<class View>
double forceOf(const std::array<int, 2>& disc, const View& lambda) {
  return std::hypot(lambda(static_cast<std::size_t>(disc[0]), 0),
                    lambda(static_cast<std::size_t>(disc[1]), 0));
}

} // namespace

std::vector<char> holdAsEquations(const Constraints& constraints, const MultiVector& multiplier) {
  const auto lambda = multiplier.getLocalViewHost(Tpetra::Access::ReadOnly);
  const std::vector<double> limits = constraints.limits(multiplier);
  std::vector<char> holds;
  for (std::size_t r = 0; r < lambda.extent(0); ++r) {
    const int row = static_cast<int>(r);
    const RowType type = constraints.rowType(row);
    const bool slips = constraints.isInterval(row) && isAtLimit(std::abs(lambda(r, 0)), limits[r]);
    const bool isClosed = type != RowType::Inequality || constraints.isSoft(row) || lambda(r, 0) > 0.0;
    holds.push_back(!slips && isClosed ? 1 : 0);
  }
  for (const std::array<int, 2>& disc : constraints.discs())
    if (isAtLimit(forceOf(disc, lambda), limits[static_cast<std::size_t>(disc[0])]))
      for (int row : disc)
        holds[static_cast<std::size_t>(row)] = 0;
  return holds;
}

void keepErrors(const Constraints& constraints, const MultiVector& multiplier, MultiVector& residual) {
  const auto lambda = multiplier.getLocalViewHost(Tpetra::Access::ReadOnly);
  const std::vector<double> limits = constraints.limits(multiplier);
  const auto view = residual.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (constraints.rowType(row) == RowType::Inequality && !constraints.isSoft(row) && !(lambda(r, 0) > 0.0))
      view(r, 0) = std::max(view(r, 0), 0.0);
    if (!constraints.isInterval(row) || !isAtLimit(std::abs(lambda(r, 0)), limits[r]))
      continue;
    const bool isAlong = limits[r] == 0.0 || view(r, 0) * lambda(r, 0) > 0.0;
    view(r, 0) = isAlong ? 0.0 : view(r, 0);
  }
  for (const std::array<int, 2>& disc : constraints.discs()) {
    const double force = forceOf(disc, lambda);
    if (!isAtLimit(force, limits[static_cast<std::size_t>(disc[0])]))
      continue;
    const auto first = static_cast<std::size_t>(disc[0]), second = static_cast<std::size_t>(disc[1]);
    if (!(force > 0.0) || limits[static_cast<std::size_t>(disc[0])] == 0.0) {
      view(first, 0) = view(second, 0) = 0.0;
      continue;
    }
    const double n[2] = {lambda(first, 0) / force, lambda(second, 0) / force};
    const double along = std::max(0.0, n[0] * view(first, 0) + n[1] * view(second, 0));
    view(first, 0) -= along * n[0];
    view(second, 0) -= along * n[1];
  }
}

} // namespace Harmos::feti
