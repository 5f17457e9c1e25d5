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

namespace {

double share(double error, double size) {
  if (error == 0.0)
    return 0.0;
  return size > 0.0 ? error / size : std::numeric_limits<double>::infinity();
}

} // namespace

double ForceError::relative() const {
  return share(error, force);
}

double ForceError::relativeTraction() const {
  return share(tractionError, traction);
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

// Of each group, over all ranks.
template<class OfRow>
std::vector<double> largest(const Teuchos::Comm<int>& comm, const RowGroups& groups, const OfRow& ofRow) {
  std::vector<double> result(static_cast<std::size_t>(groups.count), 0.0);
  for (std::size_t k = 0; k < groups.areas.size(); ++k)
    if (groups.of[k] >= 0) {
      double& group = result[static_cast<std::size_t>(groups.of[k])];
      group = std::max(group, ofRow(k));
    }
  globalMax(comm, result);
  return result;
}

// Nodes at the ends of surfaces that cover a sliver of their facets have hardly an area: their tractions are
// no one's. Of a ball on a block they would ask for a quarter more applications.
void addTractions(const Teuchos::Comm<int>& comm, const RowGroups& groups, const std::vector<double>& forces,
                  const std::vector<double>& errors, std::vector<ForceError>& result) {
  constexpr double sliver = 0.1;
  const std::vector<double> areas = largest(comm, groups, [&](std::size_t k) { return groups.areas[k]; });
  const auto byArea = [&](double value, std::size_t k) {
    const double area = groups.areas[k];
    return area > 0.0 && area >= sliver * areas[static_cast<std::size_t>(groups.of[k])]
               ? std::abs(value) / area
               : 0.0;
  };
  const auto ofForces = largest(comm, groups, [&](std::size_t k) { return byArea(forces[k], k); });
  const auto ofErrors = largest(comm, groups, [&](std::size_t k) { return byArea(errors[k], k); });
  const auto ofOnes = largest(comm, groups, [&](std::size_t k) { return byArea(1.0, k); });
  for (std::size_t g = 0; g < result.size(); ++g) {
    result[g].traction = ofForces[g];
    result[g].tractionError = ofErrors[g];
    result[g].smallestArea = ofOnes[g] > 0.0 ? 1.0 / ofOnes[g] : 0.0;
  }
}

} // namespace

std::vector<ForceError> forceErrors(const Constraints& constraints, const MultiVector& multiplier,
                                    const MultiVector& jumps, const MultiVector& correction,
                                    const RowGroups& groups) {
  const Teuchos::Comm<int>& comm = *constraints.rowMap()->getComm();
  const std::vector<double> forces = constraints.givenMultipliers(multiplier);
  const std::vector<double> errors =
      constraints.givenMultipliers(possible(constraints, multiplier, jumps, correction));
  HARMOS_REQUIRE(groups.of.size() == forces.size(), "each given row of this rank has a group, or -1");
  HARMOS_REQUIRE(groups.areas.empty() || groups.areas.size() == forces.size(), "each of them has an area");
  const auto count = static_cast<std::size_t>(groups.count);
  std::vector<double> sums(2 * count, 0.0);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (groups.of[k] < 0)
      continue;
    const auto place = 2 * static_cast<std::size_t>(groups.of[k]);
    sums[place] += forces[k] * forces[k];
    sums[place + 1] += errors[k] * errors[k];
  }
  globalSum(comm, sums);
  std::vector<ForceError> result(count);
  for (std::size_t g = 0; g < count; ++g) {
    result[g].force = std::sqrt(sums[2 * g]);
    result[g].error = std::sqrt(sums[2 * g + 1]);
  }
  addTractions(comm, groups, forces, errors, result);
  return result;
}

} // namespace Harmos::feti
