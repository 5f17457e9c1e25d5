// SPDX-License-Identifier: BSD-3-Clause

/// Any scene that a deck describes: bodies from mesh files or generators, materials, effects, output, by
/// name.

#include "Harmos_DeckScene.hpp"

int main(int argc, char** argv) {
  using namespace Harmos;
  return app::main(argc, argv,
                   {"harmos", "contact of elastic bodies, from a deck alone", app::addSceneParameters,
                    app::sceneFromDeck, nullptr});
}
