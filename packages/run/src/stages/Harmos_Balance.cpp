// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Balance.hpp"

#include "Harmos_Decomposition.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_MovedSubdomains.hpp"
#include "Harmos_MovingBounds.hpp"
#include "Harmos_Recovery.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace Harmos::run {

double largestOf(const Teuchos::Comm<int>& comm, const feti::TornVector& values) {
  double largest = 0.0;
  for (const std::vector<double>& part : values)
    for (const double value : part)
      largest = std::max(largest, std::abs(value));
  return globalMax(comm, largest);
}

void Balance::begin(double time, const feti::TornVector& begun) {
  time_ = time;
  begun_ = &begun;
  dead_ = run_.loads().loads(time);
}

std::vector<scene::OwnedSubdomain> Balance::movedBy(const feti::TornVector& displacement) const {
  std::vector<scene::OwnedSubdomain> result = scene::moved(run_.owned(), displacement);
  scene::measureParts(*context_.comm, context_.scene, result);
  return result;
}

// Searched on the deformed bodies; of small displacements as at rest.
scene::ContactSetup Balance::contactOf(const feti::TornVector& displacement) const {
  if (!context_.scene.isFinite()) {
    scene::ContactSetup contact = atRest_;
    bonds_.release(contact);
    return contact;
  }
  scene::EffectCosts costs(context_.scene); // those of the set-up are told
  const std::vector<scene::ContactSetup::Pairing> bound = bonds_.pairings();
  return scene::setUpMovedContact(*context_.comm, context_.scene, {run_.owned(), &bound},
                                  movedBy(displacement), costs);
}

scene::ContactSetup Balance::contactAt(const feti::TornVector& displacement) const {
  scene::ContactSetup contact = contactOf(displacement);
  MovingBounds(context_.scene, contact).move(contact.rows, time_);
  const std::vector<double> now = bodies_.products(contact.rows, displacement),
                            begun = bodies_.products(contact.rows, *begun_);
  std::set<std::size_t> isBound;
  for (const scene::ContactSetup::Bond& bond : contact.bonds)
    isBound.insert(bond.point);
  for (std::size_t k = 0; k < contact.rows.size(); ++k) {
    ConstraintRow& row = contact.rows[k];
    if (row.kind == ConstraintRow::Kind::Equality ||
        (row.kind == ConstraintRow::Kind::Inequality && isBound.count(k) == 0)) // zero of deformed bodies
      row.bound -= now[k];
    else if (row.kind == ConstraintRow::Kind::Limited) // slip since the step began
      row.bound -= now[k] - begun[k];
  }
  bonds_.hold(contact, displacement);
  if (locks_ != nullptr)
    locks_->apply(contact, contact.rows, time_);
  for (const scene::ContactSetup::Lock& lock : contact.locks)
    if (context_.comm->getRank() == 0)
      contact.rows[lock.place].bound -= now[lock.place];
  return contact;
}

Balance::Loads Balance::loadsAt(const feti::TornVector& displacement) const {
  const feti::TornVector following = bodies_.followingLoads(displacement, time_),
                         inertia = motion_ != nullptr ? motion_->inertiaOf(displacement) : feti::TornVector();
  if (following.empty() && inertia.empty())
    return dead_;
  Loads result;
  for (std::size_t i = 0; i < dead_.size(); ++i) {
    auto load = std::make_shared<std::vector<double>>(*dead_[i]);
    for (std::size_t k = 0; k < load->size(); ++k)
      (*load)[k] += (following.empty() ? 0.0 : following[i][k]) - (inertia.empty() ? 0.0 : inertia[i][k]);
    result.push_back(load);
  }
  return result;
}

DeformedBodies::Forces Balance::forcesAt(const feti::TornVector& displacement) const {
  const auto scope = context_.timers.scope("assembly");
  return bodies_.forces(displacement, time_);
}

// Bᵀλ, without frames.
feti::TornVector Balance::rowForces(const feti::Constraints& constraints,
                                    const MultiVector& multiplier) const {
  const feti::SubdomainSystem& system = run_.pipeline().system();
  const std::vector<double> overlap = constraints.toOverlap(multiplier);
  feti::TornVector result = system.zeroVector();
  for (std::size_t i = 0; i < result.size(); ++i)
    constraints.addBt(static_cast<int>(i), overlap.data(), result[i].data());
  system.leaveFrames(result);
  return result;
}

feti::TornVector Balance::at(const feti::TornVector& displacement, const CarriedForces& ofRows) const {
  const scene::ContactSetup contact = contactAt(displacement);
  const Teuchos::RCP<const feti::Constraints> constraints = run_.pipeline().constraintsOf(contact.rows);
  feti::TornVector result = rowForces(*constraints, *ofRows.on(*constraints, contact, true));
  const DeformedBodies::Forces forces = forcesAt(displacement);
  const Loads loads = loadsAt(displacement);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = 0; k < result[i].size(); ++k)
      result[i][k] = (*loads[i])[k] - forces.internal[i][k] - result[i][k];
  return result;
}

feti::KktAudit Balance::audit(const Answer& given) const {
  const feti::TornVector& answer = given.displacement;
  const DeformedBodies::Forces& forces = given.forces;
  const Loads& loads = given.loads;
  const Teuchos::Comm<int>& comm = *context_.comm;
  const feti::SubdomainSystem& system = run_.pipeline().system();
  feti::KktAudit result = feti::audit(system, *run_.pipeline().constraints(), given.change);
  const scene::ContactSetup contact = contactAt(answer);
  const Teuchos::RCP<const feti::Constraints> constraints = run_.pipeline().constraintsOf(contact.rows);
  const Teuchos::RCP<const MultiVector> multiplier = given.ofRows.on(*constraints, contact);
  const feti::TornVector allOfRows = rowForces(*constraints, *multiplier);
  std::vector<double> sums(5, 0.0); // squares: out of balance, loads, internal, of rows; work of loads
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const std::vector<double>& ofRows = allOfRows[i];
    std::vector<char> isFixed(ofRows.size(), 0);
    for (const feti::FixedDof& fixed : system.subdomain(static_cast<int>(i)).fixed)
      isFixed[static_cast<std::size_t>(fixed.dof)] = 1;
    for (std::size_t k = 0; k < ofRows.size(); ++k) {
      const double load = (*loads[i])[k], internal = forces.internal[i][k];
      sums[4] += (*dead_[i])[k] * answer[i][k];
      if (isFixed[k] != 0)
        continue;
      sums[0] += std::pow(load - internal - ofRows[k], 2);
      sums[1] += load * load;
      sums[2] += internal * internal;
      sums[3] += ofRows[k] * ofRows[k];
    }
  }
  globalSum(comm, sums);
  const double largest = std::max({sums[1], sums[2], sums[3]});
  result.equilibrium = largest > 0.0 ? std::sqrt(sums[0] / largest) : 0.0;
  result.forces = std::sqrt(largest);
  const std::vector<double> multipliers = constraints->givenMultipliers(*multiplier);
  double penetration = 0.0, product = 0.0;
  for (std::size_t k = 0; k < contact.rows.size(); ++k)
    if (const ConstraintRow& row = contact.rows[k]; row.kind == ConstraintRow::Kind::Inequality) {
      const bool pulls = row.softness && multipliers[k] < 0.0;
      const double gap = row.bound + (pulls ? *row.softness : row.compliance) * multipliers[k];
      penetration = std::max(penetration, pulls ? std::abs(gap) : -gap);
      product += multipliers[k] * gap;
    } else if (row.kind == ConstraintRow::Kind::Limited && row.softness) {
      penetration = std::max(penetration, std::abs(row.bound + *row.softness * multipliers[k]));
    }
  result.penetration = globalMax(comm, penetration);
  result.complementarity = std::abs(globalSum(comm, product));
  result.gluingJump = given.jump;
  result.largestDisplacement = largestOf(comm, answer);
  result.energyNorm = std::sqrt(2.0 * forces.energy);
  const double ofConstraints = result.energy - result.primalEnergy;
  result.primalEnergy = forces.energy - sums[4];
  result.energy = result.primalEnergy + ofConstraints;
  return result;
}

std::vector<std::vector<double>> Balance::reactions(const Answer& given) const {
  const feti::SubdomainSystem& system = run_.pipeline().system();
  std::vector<std::vector<double>> result =
      run_.pipeline().constraints()->heldForces(*given.change.multiplier);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = 0; k < result[i].size(); ++k) {
      const auto dof = static_cast<std::size_t>(system.subdomain(static_cast<int>(i)).fixed[k].dof);
      result[i][k] += given.forces.internal[i][dof] - (*given.loads[i])[dof];
    }
  return result;
}

std::string Balance::faultOf(const feti::TornVector& displacement) const {
  if (!context_.scene.isFinite())
    return {};
  try {
    return scene::faultOfMoved(*context_.comm, context_.scene, run_.owned(), movedBy(displacement));
  } catch (const InputError& error) {
    if (!error.isAgreed())
      throw;
    return {};
  }
}

} // namespace Harmos::run
