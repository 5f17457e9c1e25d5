// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

namespace Harmos::scene {

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned, EffectCosts& costs) {
  ConstraintCollector collector(comm, scene, owned, costs);
  // What nodes ties hold is known before contacts beside them ask.
  for (const bool areTies : {true, false})
    for (const auto& effect : scene.effects)
      if (effect->tiesSurfaces() == areTies)
        collector.collect(*effect);
  return collector.finish();
}

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned) {
  EffectCosts costs(scene);
  return setUpContact(comm, scene, owned, costs);
}

} // namespace Harmos::scene
