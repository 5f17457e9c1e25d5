// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Motion.hpp"

#include "Harmos_CopiesOfNodes.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_InitialMotion.hpp"
#include "Harmos_Mass.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace Harmos::run {

Motion::Motion(const Teuchos::Comm<int>& comm, const scene::Scene& scene) : comm_(comm), scene_(scene) {}

GeneralisedAlpha Motion::rule() const {
  return isDamped_ ? GeneralisedAlpha::damped() : GeneralisedAlpha::of(scene_.timeline.spectralRadius());
}

// Of surfaces that inequalities act on.
std::vector<char> Motion::nodesInContact(const scene::OwnedSubdomain& subdomain) const {
  std::vector<char> result(static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes()), 0);
  for (const auto& effect : scene_.effects)
    if (effect->givesInequalities())
      for (const scene::Effect::BoundaryPart& part : effect->boundaryParts())
        if (const auto set = subdomain.mesh.sets.find(part.set);
            part.body == subdomain.body && set != subdomain.mesh.sets.end())
          for (int node : set->second)
            result[static_cast<std::size_t>(node)] = 1;
  return result;
}

void Motion::addMasses(const std::vector<scene::OwnedSubdomain>& owned,
                       std::vector<feti::Subdomain>& subdomains, double step) {
  owned_ = &owned;
  step_ = step;
  const auto components = static_cast<std::size_t>(scene_.components());
  std::map<std::tuple<const fem::Mesh*, int, std::vector<char>>, std::vector<double>> known;
  for (std::size_t i = 0; i < owned.size(); ++i) {
    const scene::Body& body = scene_.bodies[static_cast<std::size_t>(owned[i].body)];
    std::vector<char> massless = nodesInContact(owned[i]);
    const auto [place, isNew] =
        known.try_emplace({owned[i].mesh.mesh.get(), owned[i].body, massless}, std::vector<double>());
    if (isNew) {
      std::vector<double> density;
      for (const fem::Material& material : body.materials)
        density.push_back(material.density);
      for (double mass : fem::lumpedMasses(*owned[i].mesh.mesh, density, massless))
        place->second.insert(place->second.end(), components, mass);
    }
    masses_.push_back(place->second);
    stiffness_.push_back(subdomains[i].stiffness);
    isHeld_.emplace_back(masses_.back().size(), 0);
    for (const feti::FixedDof& fixed : subdomains[i].fixed)
      isHeld_.back()[static_cast<std::size_t>(fixed.dof)] = 1;
  }
  const std::vector<std::shared_ptr<const LocalMatrix>> made = matrices(stiffness_);
  for (std::size_t i = 0; i < owned.size(); ++i) {
    subdomains[i].stiffness = made[i];
    auto motions = std::make_shared<feti::Kernel>();
    motions->rows = made[i]->rows();
    kernels_.push_back(motions);
    subdomains[i].motions = kernels_.back();
  }
}

// To the diagonal of K. Of a tangent, which turns with the body, the same to all sides: where values are
// prescribed it decides nothing.
std::vector<double> Motion::addedTo(std::size_t subdomain) const {
  std::vector<double> result = masses_[subdomain];
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] *=
        isHeld_[subdomain][k] != 0 && !scene_.iterates() ? 1.0 / (step_ * step_) : rule().massFactor(step_);
  return result;
}

// Subdomains with equal ones share theirs.
std::vector<std::shared_ptr<const LocalMatrix>>
Motion::matrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness) {
  std::vector<std::shared_ptr<const LocalMatrix>> result;
  factor_ = rule().massFactor(step_);
  decltype(made_) made;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const std::vector<double> added = addedTo(i);
    std::shared_ptr<const LocalMatrix>& place = made[{stiffness[i], added}];
    if (const auto known = made_.find({stiffness[i], added}); !place && known != made_.end())
      place = known->second;
    if (!place) {
      auto matrix = std::make_shared<LocalMatrix>(*stiffness[i]);
      for (std::size_t r = 0; r < added.size(); ++r)
        for (std::size_t k = matrix->offsets[r]; k < matrix->offsets[r + 1]; ++k)
          if (matrix->columns[k] == static_cast<int>(r))
            matrix->values[k] += added[r];
      place = matrix;
    }
    result.push_back(place);
  }
  made_ = std::move(made);
  return result;
}

DeformedBodies::Tangent Motion::tangentOf(const DeformedBodies::Tangent& ofStresses) {
  return {matrices(ofStresses.matrices), kernels_};
}

void Motion::begin(const Loads& loads) {
  State& state = committed_;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    state.displacement.emplace_back(masses_[i].size(), 0.0);
    state.velocity.emplace_back(masses_[i].size(), 0.0);
    for (const auto& effect : scene_.effects)
      if (const auto* motion = dynamic_cast<const scene::InitialMotion*>(effect.get())) {
        const std::vector<int> bodies = effect->bodies();
        if (std::find(bodies.begin(), bodies.end(), (*owned_)[i].body) != bodies.end())
          motion->addVelocity(scene_, (*owned_)[i], state.velocity.back());
      }
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      if (isHeld_[i][k] != 0)
        state.velocity[i][k] = 0.0;
  }
  // a = (Σf)/(Σm) over copies.
  feti::TornVector forces, masses = masses_;
  for (const auto& load : loads)
    forces.push_back(*load);
  scene::addCopies(comm_, scene_.components(), *owned_, forces);
  scene::addCopies(comm_, scene_.components(), *owned_, masses);
  state.acceleration = forces;
  state.inertia = forces;
  for (std::size_t i = 0; i < forces.size(); ++i)
    for (std::size_t k = 0; k < forces[i].size(); ++k) {
      double& a = state.acceleration[i][k];
      a = isHeld_[i][k] == 0 && masses[i][k] > 0.0 ? forces[i][k] / masses[i][k] : 0.0;
      state.inertia[i][k] = masses_[i][k] * a;
    }
  reached_ = state;
}

std::optional<std::vector<std::shared_ptr<const LocalMatrix>>> Motion::matricesOf(double step) {
  constexpr double same = 1e-10; // rounding errors of ends of steps
  if (const double before = step_; std::abs(step - before) > same * before)
    step_ = step;
  if (rule().massFactor(step_) == factor_)
    return std::nullopt;
  return matrices(stiffness_);
}

Motion::Loads Motion::pose(const Loads& loads) {
  const GeneralisedAlpha r = rule();
  const double c2 = 1.0 / (r.beta * step_ * step_), c3 = 0.5 / r.beta - 1.0;
  const double share = (1.0 - r.alphaM) / (1.0 - r.alphaF);
  Loads result;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    auto load = std::make_shared<std::vector<double>>(*loads[i]);
    for (std::size_t k = 0; k < load->size(); ++k) {
      const double m = masses_[i][k], a = committed_.acceleration[i][k];
      if (isHeld_[i][k] != 0) {
        (*load)[k] += m * (committed_.displacement[i][k] / step_ + committed_.velocity[i][k]) / step_;
        continue;
      }
      (*load)[k] +=
          share * m * (c2 * (committed_.displacement[i][k] + step_ * committed_.velocity[i][k]) + c3 * a) -
          (r.alphaM * m * a - r.alphaF * committed_.inertia[i][k]) / (1.0 - r.alphaF);
    }
    result.push_back(load);
  }
  loads_ = loads;
  posed_ = result;
  return result;
}

Motion::Moved Motion::moved(std::size_t subdomain, std::size_t dof, double way) const {
  const GeneralisedAlpha r = rule();
  const double m = masses_[subdomain][dof], a0 = committed_.acceleration[subdomain][dof],
               v0 = committed_.velocity[subdomain][dof];
  if (isHeld_[subdomain][dof] != 0) {
    const double a1 = (way / step_ - v0) / step_;
    return {way / step_, a1, m * a1};
  }
  const double c2 = 1.0 / (r.beta * step_ * step_), c3 = 0.5 / r.beta - 1.0;
  const double a1 = m > 0.0 ? c2 * (way - step_ * v0) - c3 * a0 : 0.0;
  const double v1 = m > 0.0 ? v0 + step_ * ((1.0 - r.gamma) * a0 + r.gamma * a1) : way / step_;
  return {v1, a1,
          (m * ((1.0 - r.alphaM) * a1 + r.alphaM * a0) - r.alphaF * committed_.inertia[subdomain][dof]) /
              (1.0 - r.alphaF)};
}

feti::TornVector Motion::inertiaOf(const feti::TornVector& displacement) const {
  feti::TornVector result = displacement;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      result[i][k] = moved(i, k, displacement[i][k] - committed_.displacement[i][k]).inertia;
  return result;
}

double Motion::stiffnessAlong(const feti::TornVector& change) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const std::vector<double> added = addedTo(i);
    for (std::size_t k = 0; k < added.size(); ++k)
      sum += added[k] * change[i][k] * change[i][k];
  }
  return globalSum(comm_, sum);
}

double Motion::velocityChange(const feti::TornVector& displacement) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      if (isHeld_[i][k] == 0) {
        const double change = moved(i, k, displacement[i][k] - committed_.displacement[i][k]).velocity -
                              committed_.velocity[i][k];
        sum += masses_[i][k] * change * change;
      }
  return std::sqrt(globalSum(comm_, sum));
}

void Motion::reach(const feti::TornVector& displacement) {
  State& to = reached_;
  to.displacement = displacement;
  scene::joinCopies(comm_, scene_.components(), *owned_, to.displacement);
  to.velocity = to.acceleration = to.inertia = to.displacement;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k) {
      const Moved now = moved(i, k, to.displacement[i][k] - committed_.displacement[i][k]);
      to.velocity[i][k] = now.velocity;
      to.acceleration[i][k] = now.acceleration;
      to.inertia[i][k] = now.inertia;
    }
}

void Motion::commit() {
  committed_ = reached_;
}

double Motion::weighed(const feti::TornVector& a, const feti::TornVector& b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      sum += masses_[i][k] * a[i][k] * b[i][k];
  return globalSum(comm_, sum);
}

double Motion::lagrangian(double ofStep) const {
  double difference = 0.0;
  for (std::size_t i = 0; i < posed_.size(); ++i) {
    const std::vector<double> added = addedTo(i);
    for (std::size_t k = 0; k < added.size(); ++k) {
      const double u = reached_.displacement[i][k];
      difference += ((*posed_[i])[k] - (*loads_[i])[k]) * u - 0.5 * added[k] * u * u;
    }
  }
  return ofStep + globalSum(comm_, difference);
}

Motion::Loads Motion::loadsAndInertia() const {
  Loads result;
  for (std::size_t i = 0; i < posed_.size(); ++i) {
    const std::vector<double> added = addedTo(i);
    auto load = std::make_shared<std::vector<double>>(*posed_[i]);
    for (std::size_t k = 0; k < load->size(); ++k)
      (*load)[k] -= added[k] * reached_.displacement[i][k];
    result.push_back(load);
  }
  return result;
}

double Motion::error() const {
  const GeneralisedAlpha r = rule();
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      if (isHeld_[i][k] == 0)
        sum += masses_[i][k] * std::pow(reached_.acceleration[i][k] - committed_.acceleration[i][k], 2);
  constexpr double exact = 1.0 / 6.0;
  return (r.beta - exact) * step_ * std::sqrt(globalSum(comm_, sum));
}

double Motion::kineticEnergy() const {
  return 0.5 * weighed(reached_.velocity, reached_.velocity);
}

std::array<double, 3> Motion::momentum() const {
  std::vector<double> sums(3, 0.0);
  const auto components = static_cast<std::size_t>(scene_.components());
  for (std::size_t i = 0; i < masses_.size(); ++i)
    for (std::size_t k = 0; k < masses_[i].size(); ++k)
      sums[k % components] += masses_[i][k] * reached_.velocity[i][k];
  globalSum(comm_, sums);
  return {sums[0], sums[1], sums[2]};
}

void Motion::exchange(TornArchive& torn) {
  torn.exchange("moved", committed_.displacement);
  torn.exchange("velocities", committed_.velocity);
  torn.exchange("accelerations", committed_.acceleration);
  torn.exchange("forces of inertia", committed_.inertia);
}

} // namespace Harmos::run
