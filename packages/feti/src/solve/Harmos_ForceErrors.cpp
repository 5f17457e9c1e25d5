// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ForceErrors.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

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

// Given rows of this rank.
struct GivenForces {
  std::vector<double> forces, errors;
};

GivenForces givenForces(const Constraints& constraints, const RowForces& rows) {
  return {constraints.givenMultipliers(*rows.multiplier), constraints.givenMultipliers(*rows.error)};
}

// Of the groups' tractions.
class Tractions {
 public:
  Tractions(const Teuchos::Comm<int>& comm, const RowGroups& groups) : comm_(comm), groups_(groups) {
    areas_ = largest(comm, groups, [&](std::size_t k) { return groups.areas[k]; });
  }

  // |value|/area of a row; 0 where it does not count. Nodes at the ends of surfaces that cover a sliver of
  // their facets have hardly an area: their tractions are no one's. Of a ball on a block they would ask for a
  // quarter more applications.
  double of(double value, std::size_t k) const {
    constexpr double sliver = 0.1;
    const double area = groups_.areas[k];
    return area > 0.0 && area >= sliver * areas_[groupOf(k)] ? std::abs(value) / area : 0.0;
  }

  // By how much each row's error was larger than estimated before.
  std::vector<double> shortfalls(const GivenForces& now, const GivenForces& before) const {
    // Of moves that are smaller the estimate need not tell, and one that is hardly there is so by chance.
    constexpr double least = 0.1, most = 10.0;
    const auto moved = [&](std::size_t k) { return now.forces[k] - before.forces[k]; };
    const std::vector<double> farthest =
        largest(comm_, groups_, [&](std::size_t k) { return of(moved(k), k); });
    std::vector<double> factors(now.forces.size(), 1.0);
    for (std::size_t k = 0; k < groups_.areas.size(); ++k) {
      const double estimated = std::abs(before.errors[k]);
      if (groups_.of[k] >= 0 && estimated > 0.0 && of(moved(k), k) >= least * farthest[groupOf(k)])
        factors[k] = std::clamp(std::abs(moved(k)) / estimated, 1.0, most);
    }
    return factors;
  }

 private:
  std::size_t groupOf(std::size_t k) const { return static_cast<std::size_t>(groups_.of[k]); }

  const Teuchos::Comm<int>& comm_;
  const RowGroups& groups_;
  std::vector<double> areas_; // the largest of each group
};

void addTractions(const Teuchos::Comm<int>& comm, const RowGroups& groups, const GivenForces& now,
                  const std::optional<GivenForces>& before, std::vector<ForceError>& result) {
  const Tractions tractions(comm, groups);
  std::vector<double> errors = now.errors;
  if (before) {
    const std::vector<double> factors = tractions.shortfalls(now, *before);
    std::transform(errors.begin(), errors.end(), factors.begin(), errors.begin(), std::multiplies<>());
  }
  const auto largestOf = [&](const std::vector<double>& values) {
    return largest(comm, groups, [&](std::size_t k) { return tractions.of(values[k], k); });
  };
  const std::vector<double> ofForces = largestOf(now.forces), ofErrors = largestOf(errors),
                            ofOnes = largestOf(std::vector<double>(errors.size(), 1.0));
  for (std::size_t g = 0; g < result.size(); ++g) {
    result[g].traction = ofForces[g];
    result[g].tractionError = ofErrors[g];
    result[g].smallestArea = ofOnes[g] > 0.0 ? 1.0 / ofOnes[g] : 0.0;
  }
}

} // namespace

RowForces rowForces(const Constraints& constraints, const MultiVector& multiplier, const MultiVector& jumps,
                    const MultiVector& correction) {
  return {Teuchos::rcp(new MultiVector(multiplier, Teuchos::Copy)),
          Teuchos::rcp(new MultiVector(possible(constraints, multiplier, jumps, correction), Teuchos::Copy))};
}

std::vector<ForceError> forceErrors(const Constraints& constraints, const RowForces& now,
                                    const RowForces* before, const RowGroups& groups) {
  const Teuchos::Comm<int>& comm = *constraints.rowMap()->getComm();
  const GivenForces given = givenForces(constraints, now);
  const auto& [forces, errors] = given;
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
  std::optional<GivenForces> last;
  if (before != nullptr)
    last = givenForces(constraints, *before);
  addTractions(comm, groups, given, last, result);
  return result;
}

} // namespace Harmos::feti
