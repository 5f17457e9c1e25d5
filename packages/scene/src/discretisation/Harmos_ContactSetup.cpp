// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

namespace Harmos::scene {
namespace {

ContactSetup collectAll(const Scene& scene, ConstraintCollector collector) {
  // What nodes ties hold is known before contacts beside them ask.
  for (const bool areTies : {true, false})
    for (const auto& effect : scene.effects)
      if (effect->tiesSurfaces() == areTies)
        collector.collect(*effect);
  return collector.finish();
}

} // namespace

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned, EffectCosts& costs) {
  return collectAll(scene, {comm, scene, owned, costs});
}

ContactSetup setUpMovedContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                               const ConstraintCollector::AtRest& atRest,
                               const std::vector<OwnedSubdomain>& moved, EffectCosts& costs) {
  return collectAll(scene, {comm, scene, moved, costs, atRest});
}

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned) {
  EffectCosts costs(scene);
  return setUpContact(comm, scene, owned, costs);
}

std::string faultOfMoved(const Teuchos::Comm<int>& comm, const Scene& scene,
                         const std::vector<OwnedSubdomain>& atRest,
                         const std::vector<OwnedSubdomain>& moved) {
  EffectCosts costs(scene);
  ConstraintCollector collector(comm, scene, moved, costs, {atRest});
  for (const auto& effect : scene.effects)
    if (std::string fault = collector.faultOf(*effect); !fault.empty())
      return fault;
  return {};
}

} // namespace Harmos::scene
