// SPDX-License-Identifier: BSD-3-Clause

/// Any scene that a deck describes: bodies from mesh files or generators, materials, effects, output, by
/// name.

#include "Harmos_DeckScene.hpp"
#include "Harmos_Effects.hpp"

int main(int argc, char** argv) {
  using namespace Harmos;
  scene::EffectRegistry registry;
  effects::registerEffects(registry);
  app::Application application;
  application.name = "harmos";
  application.description = "contact of elastic bodies, from a deck alone";
  application.addParameters = [&](ParameterSpec& deck) { app::addSceneParameters(deck, registry); };
  application.makeScene = [&](const app::DeckContext& context) {
    return app::sceneFromDeck(context, registry);
  };
  return app::main(argc, argv, application);
}
