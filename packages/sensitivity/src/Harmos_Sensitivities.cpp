// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Sensitivities.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::sensitivity {
namespace {

using Kind = ConstraintRow::Kind;
using Status = ConstraintRow::Status;

void requireLaw(const std::vector<ConstraintRow>& rows) {
  for (const ConstraintRow& row : rows) {
    if (row.kind == Kind::Limited && row.normal >= 0)
      throw InputError("solutions with Coulomb friction (\"Coefficient\") minimise no potential energy and "
                       "have no derivatives of this kind; use a slip bound or remove the friction");
    if (row.softness)
      throw InputError("solutions with adhesion have one-sided derivatives only, because of damage, and "
                       "these are not implemented; remove the adhesion");
  }
}

} // namespace

Sensitivities::Sensitivities(feti::FetiSolver& solver, const std::vector<ConstraintRow>& rows,
                             double weakShare)
    : solver_(solver), rows_(rows), isWeak_(rows.size(), 0) {
  const Teuchos::Comm<int>& comm = *solver.system().comm();
  agree(comm, [&] { requireLaw(rows); });
  if (solver.hasSolution() && !solver.report().converged)
    throw InputError("the solver has not converged, so its result has no derivatives: " +
                     solver.report().reason);
  const std::vector<double> forces = solver.rowForces();
  const std::vector<double> residuals =
      solver.constraints()->givenResiduals(solver.displacement(), *solver.solution().multiplier);
  double largest = 0.0;
  long long limited = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    largest = std::max(largest, rows[r].kind == Kind::Inequality ? forces[r] : 0.0);
    limited += rows[r].kind == Kind::Limited ? 1 : 0;
  }
  largest = globalMax(comm, largest);
  hasLimited_ = globalSum(comm, limited) > 0;
  const double displacement = solver.audit().largestDisplacement;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows_[r].bound = rows_[r].rounding = 0.0;
    if (rows[r].kind != Kind::Inequality)
      continue;
    const bool isClosed = forces[r] > 0.0;
    rows_[r].status = isClosed ? Status::Closed : Status::Open;
    isWeak_[r] =
        forces[r] <= weakShare * largest && std::abs(residuals[r]) <= weakShare * displacement ? 1 : 0;
  }
  weakContacts_ = globalSum(comm, static_cast<long long>(std::count(isWeak_.begin(), isWeak_.end(), 1)));
}

feti::FetiSolver::Increment Sensitivities::increment(const feti::TornVector& loads,
                                                     const std::vector<double>& bounds, bool isAdjoint,
                                                     double tolerance, bool withDisplacement) {
  const feti::SubdomainSystem& system = solver_.system();
  if (hasLimited_)
    throw InputError("with friction, forces and displacements have one-sided derivatives only, which are not "
                     "implemented; use the energy (cost \"softest\" or \"stiffest\")");
  std::vector<ConstraintRow> rows = rows_;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (isWeak_[r] != 0 && !isAdjoint)
      rows[r].status = Status::Undecided;
    if (rows[r].status != Status::Open && !bounds.empty())
      rows[r].bound = bounds[r];
  }
  std::vector<std::shared_ptr<const std::vector<double>>> vectors;
  for (int i = 0; i < system.size(); ++i)
    vectors.push_back(std::make_shared<const std::vector<double>>(
        loads.empty() ? std::vector<double>(system.rhs(i).size(), 0.0) : loads[static_cast<std::size_t>(i)]));
  feti::FetiSolver::Increment increment =
      solver_.solveIncrement(std::move(vectors), rows, tolerance, withDisplacement);
  products_ += increment.report.result.counters.hessianApplications;
  if (!increment.report.converged)
    throw NumericalError("the linear problem of a derivative did not converge: " + increment.report.reason);
  return increment;
}

Functional::Adjoint Sensitivities::adjoint(const Functional& functional, const Response& response,
                                           double tolerance, bool withDisplacement) {
  if (std::optional<Functional::Adjoint> known = functional.knownAdjoint(response))
    return std::move(*known);
  const Functional::Partials partials = functional.partials(response);
  feti::FetiSolver::Increment increment =
      this->increment(partials.displacement, partials.forces, true, tolerance, withDisplacement);
  return {std::move(increment.displacement), std::move(increment.rowForces)};
}

Sensitivities::Rate Sensitivities::rate(const feti::TornVector& loads, const std::vector<double>& bounds,
                                        double tolerance) {
  feti::FetiSolver::Increment increment = this->increment(loads, bounds, false, tolerance, true);
  return {std::move(increment.displacement), std::move(increment.rowForces)};
}

} // namespace Harmos::sensitivity
