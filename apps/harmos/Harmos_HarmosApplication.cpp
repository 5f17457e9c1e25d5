// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_HarmosApplication.hpp"

#include "Harmos_DeckScene.hpp"

namespace Harmos::app {

Application harmosApplication() {
  return {"harmos", "contact of elastic bodies, from a deck alone", addSceneParameters, sceneFromDeck,
          nullptr};
}

} // namespace Harmos::app
