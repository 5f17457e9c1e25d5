// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// The lists of a deck that describe any scene: Model, Materials, Bodies, Effects.
void addSceneParameters(ParameterSpec& deck);

/// The scene of a validated deck. Mesh files are read on rank 0.
/// @throws InputError on all ranks: names that are not there (the nearest is offered), files that cannot be
///         read, materials out of range.
/// @note Collective.
scene::Scene sceneFromDeck(const DeckContext& context);

} // namespace Harmos::app
