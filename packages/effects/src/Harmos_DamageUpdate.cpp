// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DamageUpdate.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {
namespace {

CohesiveLaw::Opening openingOf(const Stretch& q) {
  CohesiveLaw::Opening opening;
  const double slip2 = q[1] * q[1] + q[2] * q[2], all2 = q[0] * q[0] + slip2;
  opening.size = std::sqrt(all2);
  opening.share = all2 > 0.0 ? slip2 / all2 : 0.0;
  return opening;
}

double damageAt(const CohesiveLaw& law, double before, const CohesiveLaw::Opening& opening) {
  return std::max(before, law.damage(opening));
}

} // namespace

DamageState::Spring DamageState::spring() const {
  const double left = 1.0 - damage;
  Spring spring = {{left, left, left}, {}};
  if (stiffness[0] == 0.0 || left == 0.0)
    return spring;
  for (std::size_t d = 0; d < 3; ++d) {
    spring.stiffness[d] = stiffness[d];
    spring.unstretched[d] = place[d] * (1.0 - left / stiffness[d]);
  }
  return spring;
}

std::optional<Stretch> DamageState::brokenAt() const {
  return begun == 1.0 || damage < 1.0 ? std::nullopt : std::optional<Stretch>(place);
}

void DamageUpdate::beginStep() {
  for (std::size_t k = 0; k < states_.points(); ++k) {
    DamageState state = states_.get<DamageState>(k);
    state.stiffness = {};
    state.begun = state.damage;
    state.lostBefore = state.lost;
    states_.set(k, state);
  }
}

// Of a point that breaks, as it was then.
void DamageUpdate::keepMode(DamageState& state, const Stretch& stretch) const {
  if (const CohesiveLaw::Opening opening = openingOf(stretch); state.damage < 1.0 && opening.size > 0.0)
    state.mode = opening.share;
}

bool DamageUpdate::breakWorst(const std::vector<Point>& points, double tolerance,
                              const scene::InterfaceLaw::Largest& largest) {
  constexpr double nearly = 0.9;
  std::vector<double> strains;
  for (std::size_t k = 0; k < states_.points(); ++k) {
    DamageState state = states_.get<DamageState>(k);
    keepMode(state, points[k].stretch);
    states_.set(k, state);
    const CohesiveLaw::Opening opening = openingOf(points[k].stretch);
    strains.push_back(state.damage < 1.0 ? opening.size / law_.onset(opening.share) : 0.0);
  }
  double worst = 0.0;
  for (const double strain : strains)
    worst = std::max(worst, strain);
  worst = largest(worst);
  const bool breaks = worst > 1.0 + tolerance;
  for (std::size_t k = 0; k < strains.size(); ++k) {
    DamageState state = states_.get<DamageState>(k);
    if (breaks && strains[k] > 1.0 && strains[k] >= nearly * worst)
      state.damage = 1.0;
    account(state, points[k].area);
    states_.set(k, state);
  }
  return breaks;
}

Stretch DamageUpdate::traction(const CohesiveLaw& law, const DamageState& state, const Stretch& stretch) {
  const double left = 1.0 - damageAt(law, state.begun, openingOf(stretch));
  return {left * stretch[0], left * stretch[1], left * stretch[2]};
}

double DamageUpdate::misfit(const CohesiveLaw& law, const scene::PointStates& states,
                            const std::vector<Point>& answer) {
  double worst = 0.0;
  for (std::size_t k = 0; k < answer.size(); ++k) {
    const DamageState state = states.get<DamageState>(k);
    const Stretch& stretch = answer[k].stretch;
    const DamageState::Spring its = state.damage < 1.0 ? state.spring() : DamageState::Spring{};
    const Stretch byLaw = traction(law, state, stretch);
    double sum = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      double found = its.stiffness[d] * (stretch[d] - its.unstretched[d]);
      if (d == 0)
        found = std::max(found, 0.0); // closed ones press
      sum += std::pow(found - byLaw[d], 2);
    }
    worst = std::max(worst, std::sqrt(sum) / law.onset(openingOf(stretch).share));
    // However little it still bears.
    if (state.damage < 1.0 && law.damage(openingOf(stretch)) == 1.0)
      worst = std::max(worst, 1.0);
  }
  return worst;
}

bool DamageUpdate::staysBroken(const DamageState& state, const Stretch& stretch, double known) const {
  const CohesiveLaw::Opening opening = openingOf(stretch);
  return state.damage == 1.0 && state.begun < 1.0 &&
         (1.0 - law_.damage(opening)) * opening.size <= known * law_.onset(opening.share);
}

bool DamageUpdate::follow(const std::vector<Point>& points, std::optional<double> steepness, double known) {
  bool softens = false;
  for (std::size_t k = 0; k < states_.points(); ++k) {
    const Stretch& stretch = points[k].stretch;
    DamageState state = states_.get<DamageState>(k);
    keepMode(state, stretch);
    state.stiffness = {};
    if (staysBroken(state, stretch, known)) {
      softens = true;
    } else {
      const CohesiveLaw::Opening opening = openingOf(stretch);
      state.damage = damageAt(law_, state.begun, opening);
      // Of one that breaks: straight on it was there when it did.
      const double share = state.damage == 1.0 && state.begun < 1.0
                               ? std::min(1.0, law_.end(opening.share) / opening.size)
                               : 1.0;
      for (std::size_t d = 0; d < 3; ++d)
        state.place[d] = share * stretch[d];
      const bool doesIt = state.damage > state.begun;
      softens = softens || doesIt;
      if (steepness && doesIt && state.damage < 1.0)
        linearise(state, *steepness);
    }
    account(state, points[k].area);
    states_.set(k, state);
  }
  return softens;
}

// Through where it is.
void DamageUpdate::linearise(DamageState& state, double steepness) const {
  const double left = 1.0 - state.damage;
  const CohesiveLaw::Opening opening = openingOf(state.place);
  const double first = law_.onset(opening.share), last = law_.end(opening.share);
  const double softening = steepness * first / (last - first);
  if (softening >= left)
    return;
  // Across the way in which it opens a traction turns with it: (1 − d)k.
  for (std::size_t d = 0; d < 3; ++d) {
    const double along2 = std::pow(state.place[d] / opening.size, 2);
    state.stiffness[d] = along2 * softening + (1.0 - along2) * left;
  }
}

// What the law dissipates on the way from the beginning of the step.
void DamageUpdate::account(DamageState& state, double area) const {
  state.lost = state.lostBefore;
  if (state.damage != state.begun)
    state.lost +=
        area * (law_.dissipated(state.damage, state.mode) - law_.dissipated(state.begun, state.mode));
}

scene::InterfaceLaw::Broken DamageUpdate::broken(const CohesiveLaw& law, const scene::PointStates& states,
                                                 const std::vector<Point>& points) {
  scene::InterfaceLaw::Broken result;
  for (std::size_t k = 0; k < states.points(); ++k) {
    const DamageState state = states.get<DamageState>(k);
    result.dissipated += state.lost;
    result.area += points[k].area;
    if (state.damage != state.begun)
      result.share += (state.lost - state.lostBefore) / law.fractureEnergy(state.mode);
  }
  return result;
}

} // namespace Harmos::effects
