// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

namespace Harmos::scene {

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned, EffectCosts& costs) {
  ConstraintCollector collector(comm, scene, owned, costs);
  for (const auto& effect : scene.effects)
    collector.collect(*effect);
  return collector.finish();
}

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned) {
  EffectCosts costs(scene);
  return setUpContact(comm, scene, owned, costs);
}

} // namespace Harmos::scene
