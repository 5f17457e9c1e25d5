// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainEffects.hpp"

#include <set>

namespace Harmos::scene {

SubdomainEffects::SubdomainEffects(const Scene& scene, EffectCosts& costs)
    : scene_(scene), costs_(costs), time_(scene.timeline.ends().front()), ofBody_(scene.bodies.size()) {
  for (const auto& effect : scene.effects)
    for (int body : effect->bodies())
      ofBody_.at(static_cast<std::size_t>(body)).push_back(effect.get());
}

void SubdomainEffects::addPrescribed(const Effect& effect, const OwnedSubdomain& subdomain, double time,
                                     std::vector<feti::FixedDof>& fixed) const {
  const std::size_t before = fixed.size();
  effect.addPrescribed(scene_, subdomain, fixed);
  if (fixed.size() == before)
    return;
  if (const double factor = scene_.timeline.factor(effect, time); factor != 1.0)
    for (std::size_t k = before; k < fixed.size(); ++k)
      fixed[k].value *= factor;
}

std::vector<feti::FixedDof> SubdomainEffects::prescribed(const OwnedSubdomain& subdomain, double time) const {
  std::vector<feti::FixedDof> fixed;
  for (const Effect* effect : ofBody_[static_cast<std::size_t>(subdomain.body)])
    addPrescribed(*effect, subdomain, time, fixed);
  return fixed;
}

std::vector<feti::FixedDof> SubdomainEffects::prescribed(const OwnedSubdomain& subdomain) const {
  return prescribed(subdomain, time_);
}

std::vector<feti::FixedDof> SubdomainEffects::countedPrescribed(const OwnedSubdomain& subdomain) {
  std::vector<feti::FixedDof> fixed;
  std::set<int> dofs; // one that two effects prescribe is that of the first
  for (const Effect* effect : ofBody_[static_cast<std::size_t>(subdomain.body)]) {
    const std::size_t before = fixed.size(), known = dofs.size();
    {
      const auto scope = costs_.scope(*effect);
      addPrescribed(*effect, subdomain, time_, fixed);
    }
    if (fixed.size() == before)
      continue;
    for (std::size_t k = before; k < fixed.size(); ++k)
      dofs.insert(fixed[k].dof);
    costs_.addPrescribed(effect->kind(), static_cast<long long>(dofs.size() - known));
    costs_.addBytes(effect->kind(), (fixed.size() - before) * sizeof(feti::FixedDof));
  }
  return fixed;
}

SubdomainEffects::Acting SubdomainEffects::acting(const OwnedSubdomain& subdomain, KeyOf keyOf,
                                                  const std::function<bool(const Effect&)>& takes) const {
  Acting acting{{subdomain.mesh.mesh.get(), subdomain.body, {}}, {}};
  std::vector<double>& keys = std::get<2>(acting.place);
  const std::vector<const Effect*>& effects = ofBody_[static_cast<std::size_t>(subdomain.body)];
  for (std::size_t k = 0; k < effects.size(); ++k) {
    if (takes && !takes(*effects[k]))
      continue;
    const auto scope = costs_.scope(*effects[k]);
    if (const auto key = (effects[k]->*keyOf)(scene_, subdomain)) {
      // Which effect, and where its key ends: no two sequences of keys look the same.
      keys.push_back(static_cast<double>(k));
      keys.push_back(static_cast<double>(key->size()));
      keys.insert(keys.end(), key->begin(), key->end());
      acting.effects.push_back(effects[k]);
    }
  }
  return acting;
}

void SubdomainEffects::addLoad(const Effect& effect, const OwnedSubdomain& subdomain,
                               std::vector<double>& load) const {
  const double factor = scene_.timeline.factor(effect, time_);
  if (factor == 1.0)
    return effect.addLoad(scene_, subdomain, load);
  std::vector<double> whole(load.size(), 0.0);
  effect.addLoad(scene_, subdomain, whole);
  for (std::size_t k = 0; k < load.size(); ++k)
    load[k] += factor * whole[k];
}

std::shared_ptr<const std::vector<double>> SubdomainEffects::load(const OwnedSubdomain& subdomain) {
  const auto dofs = static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes()) *
                    static_cast<std::size_t>(scene_.components());
  const Acting acts = acting(subdomain, &Effect::loadKey);
  std::shared_ptr<const std::vector<double>>& shared =
      acts.effects.empty() ? zeros_[dofs] : loads_[acts.place];
  if (shared)
    return shared;
  const auto load = std::make_shared<std::vector<double>>(dofs, 0.0);
  for (const Effect* effect : acts.effects) {
    const auto scope = costs_.scope(*effect);
    addLoad(*effect, subdomain, *load);
  }
  if (!acts.effects.empty()) // the vector is one, whatever the number of effects in it
    costs_.addBytes(acts.effects.front()->kind(), dofs * sizeof(double));
  shared = load;
  return shared;
}

std::shared_ptr<const std::vector<double>>
SubdomainEffects::wholeLoad(const OwnedSubdomain& subdomain,
                            const std::function<bool(const Effect&)>& takes) {
  const Acting acts = acting(subdomain, &Effect::loadKey, takes);
  if (acts.effects.empty())
    return nullptr;
  std::shared_ptr<const std::vector<double>>& shared = wholeLoads_[acts.place];
  if (shared)
    return shared;
  const auto load = std::make_shared<std::vector<double>>(
      static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes() * scene_.components()), 0.0);
  for (const Effect* effect : acts.effects) {
    const auto scope = costs_.scope(*effect);
    effect->addLoad(scene_, subdomain, *load);
  }
  costs_.addBytes(acts.effects.front()->kind(), load->size() * sizeof(double));
  shared = load;
  return shared;
}

SubdomainEffects::Stiffness SubdomainEffects::stiffness(const OwnedSubdomain& subdomain,
                                                        const Stiffness& elastic) {
  const Acting acts = acting(subdomain, &Effect::stiffnessKey);
  if (acts.effects.empty())
    return elastic;
  Stiffness& shared = stiffness_[acts.place];
  if (shared.matrix)
    return shared;
  std::vector<MatrixEntry> entries;
  for (const Effect* effect : acts.effects) {
    const auto scope = costs_.scope(*effect);
    effect->addStiffness(scene_, subdomain, entries);
  }
  const auto scope = costs_.scope(*acts.effects.front());
  const LocalMatrix addition = makeLocalMatrix(elastic.matrix->rows(), std::move(entries));
  shared.matrix = std::make_shared<LocalMatrix>(sum(*elastic.matrix, addition));
  shared.motions = std::make_shared<feti::Kernel>(feti::keptKernel(*elastic.motions, addition));
  costs_.addBytes(acts.effects.front()->kind(), shared.matrix->entries() * (sizeof(double) + sizeof(int)) +
                                                    shared.matrix->offsets.size() * sizeof(std::size_t));
  return shared;
}

} // namespace Harmos::scene
