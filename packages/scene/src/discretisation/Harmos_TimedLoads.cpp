// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TimedLoads.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_SubdomainEffects.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::scene {
namespace {

// A strain is a load whose body has a temperature of its own by that effect.
bool isStrain(const Effect& effect) {
  const std::vector<int> bodies = effect.bodies();
  return std::any_of(bodies.begin(), bodies.end(), [&](int body) {
    return effect.temperatureRise(body) != 0.0 || !effect.temperatureField(body).empty();
  });
}

} // namespace

TimedLoads::TimedLoads(const Scene& scene, const std::vector<OwnedSubdomain>& owned, EffectCosts& costs)
    : scene_(scene), owned_(owned), loads_(owned.size()) {
  for (const auto& effect : scene.effects)
    caseOf(*effect, isStrain(*effect));
  SubdomainEffects effects(scene, costs);
  for (std::size_t c = 0; c < cases_.size(); ++c)
    for (std::size_t i = 0; i < owned.size(); ++i)
      loads_[i].push_back(effects.wholeLoad(
          owned[i], [&](const Effect& effect) { return caseOf(effect, isStrain(effect)) == c; }));
  for (const OwnedSubdomain& subdomain : owned)
    collectPrescribed(subdomain);
}

std::size_t TimedLoads::caseOf(const Effect& effect, bool strain) {
  const std::string history = scene_.timeline.historyOf(effect);
  const auto found = std::find_if(cases_.begin(), cases_.end(), [&](const Case& c) {
    return c.history == history && c.isStrain == strain;
  });
  if (found == cases_.end())
    cases_.push_back({history, strain});
  return static_cast<std::size_t>(found - cases_.begin());
}

// In the order of SubdomainEffects::prescribed().
void TimedLoads::collectPrescribed(const OwnedSubdomain& subdomain) {
  std::vector<Prescribed>& all = prescribed_.emplace_back();
  std::map<int, std::size_t> firstOf;
  for (const auto& effect : scene_.effects) {
    const std::vector<int> bodies = effect->bodies();
    if (std::find(bodies.begin(), bodies.end(), subdomain.body) == bodies.end())
      continue;
    std::vector<feti::FixedDof> part;
    effect->addPrescribed(scene_, subdomain, part);
    for (const feti::FixedDof& fixed : part) {
      const std::size_t first = firstOf.emplace(fixed.dof, all.size()).first->second;
      all.push_back({fixed.dof, fixed.value, caseOf(*effect, false), effect.get(), first});
      prescribesMotion_ = prescribesMotion_ || fixed.value != 0.0;
    }
  }
}

std::vector<double> TimedLoads::factors(double time) const {
  std::vector<double> result;
  for (const Case& c : cases_)
    result.push_back(scene_.timeline.factor(c.history, time));
  return result;
}

std::vector<std::shared_ptr<const std::vector<double>>> TimedLoads::loads(double time) const {
  const std::vector<double> factor = factors(time);
  std::map<std::pair<std::size_t, std::vector<Vector>>, Vector> shared; // of unloaded ones by length
  std::vector<Vector> result;
  for (std::size_t i = 0; i < owned_.size(); ++i) {
    const auto dofs = static_cast<std::size_t>(owned_[i].mesh.mesh->numberOfNodes()) *
                      static_cast<std::size_t>(scene_.components());
    Vector& sum = shared[{dofs, loads_[i]}];
    if (!sum) {
      const auto fresh = std::make_shared<std::vector<double>>(dofs, 0.0);
      for (std::size_t c = 0; c < factor.size(); ++c)
        if (loads_[i][c] && factor[c] != 0.0)
          for (std::size_t k = 0; k < dofs; ++k)
            (*fresh)[k] += factor[c] * (*loads_[i][c])[k];
      sum = fresh;
    }
    result.push_back(sum);
  }
  return result;
}

std::vector<std::vector<double>> TimedLoads::prescribed(double time) const {
  const std::vector<double> factor = factors(time);
  std::vector<std::vector<double>> result;
  for (const std::vector<Prescribed>& all : prescribed_) {
    std::vector<double>& values = result.emplace_back();
    for (const Prescribed& own : all) {
      const Prescribed& first = all[own.first];
      values.push_back(factor[first.which] * first.value);
    }
  }
  return result;
}

TimedLoads::Products TimedLoads::products(const Teuchos::Comm<int>& comm,
                                          const feti::TornVector& displacement,
                                          const std::vector<std::vector<double>>& reactions) const {
  const std::size_t count = cases_.size();
  std::vector<double> sums(2 * count, 0.0);
  for (std::size_t i = 0; i < owned_.size(); ++i) {
    for (std::size_t c = 0; c < count; ++c)
      if (loads_[i][c])
        for (std::size_t k = 0; k < displacement[i].size(); ++k)
          sums[c] += (*loads_[i][c])[k] * displacement[i][k];
    for (std::size_t k = 0; k < prescribed_[i].size(); ++k)
      if (prescribed_[i][k].first == k)
        sums[count + prescribed_[i][k].which] += reactions[i][k] * prescribed_[i][k].value;
  }
  globalSum(comm, sums);
  const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(count);
  return {{sums.begin(), middle}, {middle, sums.end()}};
}

void TimedLoads::requireConsistent() const {
  // Of values that come from decks.
  constexpr double rounding = 1e-12;
  for (double time : scene_.timeline.corners()) {
    const std::vector<double> factor = factors(time);
    for (std::size_t i = 0; i < owned_.size(); ++i)
      for (const Prescribed& own : prescribed_[i]) {
        const Prescribed& first = prescribed_[i][own.first];
        const double value = factor[own.which] * own.value, other = factor[first.which] * first.value;
        if (std::abs(value - other) <= rounding * std::max(std::abs(value), std::abs(other)))
          continue;
        const Body& body = scene_.bodies[static_cast<std::size_t>(owned_[i].body)];
        throw InputError(
            first.effect->label() + " and " + own.effect->label() + " contradict each other at time " +
                scientific(time) + ": different prescribed values, " + scientific(other) + " and " +
                scientific(value) + ", for component " + std::to_string(own.dof % scene_.components()) +
                " of a node of body \"" + body.name +
                "\" that both prescribe; use equal histories and values there or release one",
            {{"body", body.name}});
      }
  }
}

double freeStrainEnergy(const Teuchos::Comm<int>& comm, const Scene& scene,
                        const std::vector<OwnedSubdomain>& owned, double time) {
  if (scene.iterates()) // there it is part of the energy
    return 0.0;
  const std::vector<double> rises = scene.temperatureRises(time);
  std::map<std::pair<const fem::Mesh*, int>, double> known; // of one degree
  double sum = 0.0;
  for (const OwnedSubdomain& item : owned) {
    const double rise = rises[static_cast<std::size_t>(item.body)];
    if (const auto nodal = scene.nodalRises(item, time)) {
      std::vector<double> all = *nodal;
      for (double& value : all)
        value += rise;
      sum += fem::thermalEnergy(*item.mesh.mesh,
                                elasticityOf(scene, scene.bodies[static_cast<std::size_t>(item.body)]), all);
      continue;
    }
    if (rise == 0.0)
      continue;
    const auto [place, isNew] = known.try_emplace({item.mesh.mesh.get(), item.body}, 0.0);
    if (isNew)
      place->second = fem::thermalEnergy(
          *item.mesh.mesh, elasticityOf(scene, scene.bodies[static_cast<std::size_t>(item.body)]));
    sum += rise * rise * place->second;
  }
  return globalSum(comm, sum);
}

} // namespace Harmos::scene
