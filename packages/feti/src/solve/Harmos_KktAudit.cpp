// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_KktAudit.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_RowErrors.hpp"

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

// What limited rows say. @param rows Bu − c − Cλ; what is wrong with them is left.
void auditLimits(const Constraints& constraints, const MultiVector& multiplier, MultiVector& rows,
                 const Teuchos::Comm<int>& comm, KktAudit& result) {
  keepErrors(constraints, multiplier, rows);
  double error = 0.0, excess = 0.0, limit = 0.0;
  const std::vector<double> limits = constraints.limits(multiplier);
  const auto errors = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = multiplier.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto add = [&](int row, double slip, double force) {
    const double scale = constraints.rowScale(row);
    error = largerOf(error, slip / scale);
    excess = largerOf(excess, (force - limits[static_cast<std::size_t>(row)]) * scale);
    limit = largerOf(limit, limits[static_cast<std::size_t>(row)] * scale);
  };
  for (std::size_t r = 0; r < errors.extent(0); ++r)
    if (constraints.isInterval(static_cast<int>(r)))
      add(static_cast<int>(r), std::abs(errors(r, 0)), std::abs(lambda(r, 0)));
  for (const auto& [first, second] : constraints.discs()) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    add(first, std::hypot(errors(a, 0), errors(b, 0)), std::hypot(lambda(a, 0), lambda(b, 0)));
  }
  result.slipError = globalLargest(comm, error);
  result.limitExcess = globalLargest(comm, excess);
  result.largestLimit = globalLargest(comm, limit);
}

// What B, c and λ say; the jump of prescribed values is known.
void auditRows(const Constraints& constraints, const TornSolution& solution, double fromPrescribed,
               const Teuchos::Comm<int>& comm, KktAudit& result) {
  MultiVector rows(constraints.rowMap(), 1);
  constraints.residual(solution.displacement, *solution.multiplier, rows);
  double jump = fromPrescribed, penetration = 0.0, product = 0.0, work = 0.0, largestForce = 0.0;
  double leastMultiplier = std::numeric_limits<double>::infinity(), slipWork = 0.0;
  double ofSprings = 0.0, springError = 0.0;
  {
    const auto values = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto lambda = solution.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t r = 0; r < values.extent(0); ++r) {
      const int row = static_cast<int>(r);
      const double scale = constraints.rowScale(row);
      const double excess = values(r, 0) / scale;
      work += lambda(r, 0) * scale * excess + 0.5 * constraints.compliance(row) * lambda(r, 0) * lambda(r, 0);
      const bool isSoft = constraints.isSoft(row);
      if (isSoft)
        ofSprings += 0.5 * lambda(r, 0) * constraints.giving(row, lambda(r, 0));
      if (isSoft && (constraints.rowType(row) == RowType::Limited || lambda(r, 0) < 0.0))
        springError = largerOf(springError, std::abs(excess));
      if (constraints.rowType(row) == RowType::Inequality) {
        penetration = largerOf(penetration, excess);
        if (!isSoft)
          leastMultiplier = smallerOf(leastMultiplier, lambda(r, 0) * scale);
        largestForce = largerOf(largestForce, std::abs(lambda(r, 0) * scale));
        product += lambda(r, 0) * scale * excess;
      } else if (constraints.rowType(row) == RowType::Limited) {
        slipWork += isSoft ? 0.0 : lambda(r, 0) * scale * excess;
      } else {
        jump = largerOf(jump, std::abs(excess));
      }
    }
  }
  if (constraints.limited() > 0) {
    auditLimits(constraints, *solution.multiplier, rows, comm, result);
    result.frictionWork = globalSum(comm, slipWork);
  }
  result.gluingJump = globalLargest(comm, jump);
  result.penetration = globalLargest(comm, penetration);
  leastMultiplier = -globalLargest(comm, -leastMultiplier);
  result.minContactMultiplier =
      constraints.inequalities() > 0 && !std::isinf(leastMultiplier) ? leastMultiplier : 0.0;
  result.complementarity = std::abs(globalSum(comm, product));
  result.energy = result.primalEnergy + globalSum(comm, work);
  if (constraints.hasSoft()) {
    result.springEnergy = globalSum(comm, ofSprings);
    result.springError = globalLargest(comm, springError);
    result.energy += result.springEnergy;
  }
  result.largestMultiplier = globalLargest(comm, largestForce);
  double ofGiven = 0.0;
  for (const double force : constraints.givenMultipliers(*solution.multiplier))
    ofGiven = largerOf(ofGiven, std::abs(force));
  result.largestRowForce = globalLargest(comm, ofGiven);
}

// Over subdomains.
struct BodySums {
  double residual = 0.0;     // ‖Ku − f + Bᵀλ‖²
  double load = 0.0;         // ‖f‖²
  double energy = 0.0;       // ½uᵀKu − fᵀu
  double strained = 0.0;     // ‖Ku‖²
  double rows = 0.0;         // ‖Bᵀλ‖²
  double displacement = 0.0; // ‖diag(K)u‖²
  double strainEnergy = 0.0; // uᵀKu
  double motionEnergy = 0.0; // uᵀdiag(K)u
  double trace = 0.0;        // tr K
  double loadEnergy = 0.0;   // fᵀdiag(K)⁻¹f
  double unit = 0.0;         // ‖diag(K)‖²
  double largest = 0.0;      // |u|, the largest of these three
  double fromPrescribed = 0.0;
  double byLoad = 0.0; // f/diag(K)
};

// @param force Bᵀλ of the subdomain.
void auditBody(const SubdomainSystem& system, int i, const std::vector<double>& u,
               const std::vector<double>& force, BodySums& sums) {
  const Subdomain& physical = system.subdomain(i);
  std::vector<double> image(u.size()), strained = u;
  // K times a large rigid motion is rounding errors alone; KR = 0 has been verified.
  removeKernel(system.kernel(i), strained);
  const auto addEnergy = [&] {
    for (std::size_t j = 0; j < u.size(); ++j) {
      sums.energy += 0.5 * strained[j] * image[j] - u[j] * (*physical.load)[j];
      sums.strainEnergy += strained[j] * image[j];
    }
  };
  const bool hasTrivialEquations = physical.stiffness.get() != &system.matrix(i);
  if (hasTrivialEquations) {
    physical.stiffness->multiply(strained.data(), image.data());
    addEnergy();
  }
  system.matrix(i).multiply(strained.data(), image.data());
  if (!hasTrivialEquations)
    addEnergy();
  // Trivial equations k u = k g say nothing of forces; k g, which may be large, would hide those out of
  // balance. Prescribed values are audited by themselves.
  std::vector<bool> isTrivial(u.size(), false);
  for (const FixedDof& fixed : physical.fixed) {
    const auto dof = static_cast<std::size_t>(fixed.dof);
    sums.fromPrescribed = largerOf(sums.fromPrescribed, std::abs(u[dof] - fixed.value));
    isTrivial[dof] = hasTrivialEquations;
  }
  const std::vector<double>& diagonal = system.diagonal(i);
  const std::vector<double>& load = system.rhs(i);
  for (std::size_t j = 0; j < u.size(); ++j) {
    sums.largest = largerOf(sums.largest, std::abs(u[j]));
    sums.motionEnergy += diagonal[j] * u[j] * u[j];
    sums.trace += diagonal[j];
    sums.unit += diagonal[j] * diagonal[j];
    if (isTrivial[j])
      continue;
    const double residual = image[j] - load[j] + force[j];
    sums.residual += residual * residual;
    sums.load += load[j] * load[j];
    sums.strained += image[j] * image[j];
    sums.rows += force[j] * force[j];
    sums.displacement += std::pow(diagonal[j] * u[j], 2);
    const double moved = load[j] / diagonal[j];
    sums.byLoad = largerOf(sums.byLoad, std::abs(moved));
    sums.loadEnergy += load[j] * moved;
  }
}

void reduce(const Teuchos::Comm<int>& comm, BodySums& sums) {
  double* const added[] = {&sums.residual, &sums.load,         &sums.energy,       &sums.strained,
                           &sums.rows,     &sums.displacement, &sums.strainEnergy, &sums.motionEnergy,
                           &sums.trace,    &sums.loadEnergy,   &sums.unit};
  std::vector<double> values;
  for (const double* sum : added)
    values.push_back(*sum);
  globalSum(comm, values);
  for (std::size_t k = 0; k < values.size(); ++k)
    *added[k] = values[k];
  sums.largest = globalLargest(comm, sums.largest);
  sums.byLoad = globalLargest(comm, sums.byLoad);
}

} // namespace

KktAudit audit(const SubdomainSystem& system, const Constraints& constraints, const TornSolution& solution) {
  const Teuchos::Comm<int>& comm = *system.comm();
  const std::vector<double> overlap = constraints.toOverlap(*solution.multiplier);
  BodySums sums;
  std::vector<double> force;
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double>& u = solution.displacement[static_cast<std::size_t>(i)];
    force.assign(u.size(), 0.0);
    constraints.addBt(i, overlap.data(), force.data());
    auditBody(system, i, u, force, sums);
  }
  reduce(comm, sums);
  KktAudit result;
  // Where nothing but rigid motion is left, all forces are rounding errors of stiffness times displacement.
  constexpr double least = 1e-24; // squared
  const double forces = std::max({sums.load, sums.strained, sums.rows, least * sums.displacement});
  result.equilibrium = forces > 0.0 ? std::sqrt(sums.residual / forces) : 0.0;
  result.forces = std::sqrt(forces);
  result.displacementForce = std::sqrt(sums.displacement);
  result.unitForce = std::sqrt(sums.unit);
  result.primalEnergy = sums.energy;
  result.energyNorm = std::sqrt(std::max(sums.strainEnergy, 0.0));
  result.displacementEnergy = std::sqrt(sums.motionEnergy);
  result.unitEnergy = std::sqrt(sums.trace);
  result.largestDisplacement = sums.largest;
  result.loadDisplacement = sums.byLoad;
  result.loadEnergy = std::sqrt(sums.loadEnergy);
  auditRows(constraints, solution, sums.fromPrescribed, comm, result);
  return result;
}

bool auditAgrees(const KktAudit& audit, const AuditLimits& limits) {
  // Of sums over all dofs.
  constexpr double rounding = 1e-12;
  // Bodies at rest: they move no further than bounds are known to, which makes larger forces than there are.
  const bool isAtRest = audit.forces <= limits.boundRounding * audit.unitForce &&
                        audit.largestDisplacement <= 10.0 * limits.boundRounding;
  const double length = limits.share * audit.largestDisplacement + rounding * audit.loadDisplacement;
  const double error = limits.energyShare * audit.energyNorm + limits.boundRounding * audit.unitEnergy +
                       rounding * (audit.displacementEnergy + audit.loadEnergy);
  // Three tolerances; the defect is that of a random load.
  constexpr double typical = 10.0;
  constexpr double withinLimit = 1e-9; // rounding errors of projections, as where what slips is told
  const double force = isAtRest ? audit.forces
                                : (0.03 * limits.share + typical * limits.inverseDefect) * audit.forces +
                                      0.1 * rounding * audit.displacementForce;
  return audit.gluingJump <= length + (isAtRest ? limits.boundRounding : 0.0) &&
         audit.slipError <= length + (isAtRest ? limits.boundRounding : 0.0) &&
         audit.springError <= length + limits.boundRounding &&
         audit.limitExcess <= withinLimit * audit.largestLimit + rounding * audit.forces &&
         audit.penetration <= length + limits.boundRounding && audit.equilibrium * audit.forces <= force &&
         limits.energyError <= error;
}

double auditShare(double tolerance) {
  return std::min(100.0 * tolerance, 0.1);
}

double energyErrorShare(double tolerance) {
  return std::min(30.0 * tolerance, 0.1);
}

ContactState contactState(const Constraints& constraints, const TornSolution& solution) {
  MultiVector rows(constraints.rowMap(), 1);
  constraints.residual(solution.displacement, *solution.multiplier, rows);
  const auto values = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
  ContactState state;
  for (std::size_t r = 0; r < values.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (constraints.rowType(row) != RowType::Inequality)
      continue;
    const double scale = constraints.rowScale(row);
    state.row.push_back(static_cast<long long>(constraints.rowMap()->getGlobalElement(row)));
    state.gap.push_back(-(values(r, 0) + constraints.giving(row, lambda(r, 0))) / scale);
    state.force.push_back(lambda(r, 0) * scale);
  }
  return state;
}

FrictionState frictionState(const Constraints& constraints, const TornSolution& solution) {
  MultiVector rows(constraints.rowMap(), 1);
  constraints.residual(solution.displacement, *solution.multiplier, rows);
  const auto values = rows.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto lambda = solution.multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
  FrictionState state;
  for (std::size_t r = 0; r < values.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (constraints.rowType(row) != RowType::Limited)
      continue;
    const double scale = constraints.rowScale(row);
    state.row.push_back(static_cast<long long>(constraints.rowMap()->getGlobalElement(row)) -
                        constraints.inequalities());
    state.slip.push_back((values(r, 0) + constraints.giving(row, lambda(r, 0))) / scale);
    state.force.push_back(lambda(r, 0) * scale);
  }
  return state;
}

} // namespace Harmos::feti
