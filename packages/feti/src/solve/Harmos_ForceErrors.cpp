// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ForceErrors.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti {

double ForceError::relative() const {
  if (error == 0.0)
    return 0.0;
  return force > 0.0 ? error / force : std::numeric_limits<double>::infinity();
}

namespace {

// What the correction may change of each row.
MultiVector possible(const Constraints& constraints, const MultiVector& multiplier, const MultiVector& jumps,
                     const MultiVector& correction) {
  MultiVector result(correction, Teuchos::Copy);
  const std::vector<char> holds = holdAsEquations(constraints, multiplier);
  const auto change = result.getLocalViewHost(Tpetra::Access::ReadWrite);
  const auto lambda = multiplier.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto jump = jumps.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < change.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (!holds[r] && jump(r, 0) == 0.0)
      change(r, 0) = 0.0;
    if (constraints.isSoft(row)) {
      if (constraints.softness(row) * std::abs(change(r, 0)) > std::abs(jump(r, 0)))
        change(r, 0) = jump(r, 0) / constraints.softness(row);
    } else if (constraints.rowType(row) == RowType::Inequality) {
      change(r, 0) = std::max(change(r, 0), -lambda(r, 0));
    }
  }
  return result;
}

} // namespace

std::vector<ForceError> forceErrors(const Constraints& constraints, const MultiVector& multiplier,
                                    const MultiVector& jumps, const MultiVector& correction,
                                    const std::vector<int>& groupOf, int groups) {
  const std::vector<double> forces = constraints.givenMultipliers(multiplier);
  const std::vector<double> errors =
      constraints.givenMultipliers(possible(constraints, multiplier, jumps, correction));
  HARMOS_REQUIRE(groupOf.size() == forces.size(), "each given row of this rank has a group, or -1");
  std::vector<double> sums(2 * static_cast<std::size_t>(groups), 0.0);
  for (std::size_t k = 0; k < groupOf.size(); ++k) {
    if (groupOf[k] < 0)
      continue;
    const auto place = 2 * static_cast<std::size_t>(groupOf[k]);
    sums[place] += forces[k] * forces[k];
    sums[place + 1] += errors[k] * errors[k];
  }
  globalSum(*constraints.rowMap()->getComm(), sums);
  std::vector<ForceError> result;
  for (std::size_t place = 0; place < sums.size(); place += 2)
    result.push_back({std::sqrt(sums[place]), std::sqrt(sums[place + 1])});
  return result;
}

} // namespace Harmos::feti
