// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"
#include "Harmos_EffectRegistry.hpp"
#include "Harmos_HarmosApplication.hpp"

namespace Harmos::app {

/// The lists of a deck that describe any scene: Model, Materials, Bodies, Effects of the registered kinds.
/// @param kinematics whether displacements may be finite.
void addSceneParameters(ParameterSpec& deck, const scene::EffectRegistry& registry,
                        KinematicsChoice kinematics);

/// The scene of a validated deck. Mesh files are read on rank 0.
/// @throws InputError on all ranks: names that are not there (the nearest is offered), files that cannot be
///         read, materials out of range.
/// @note Collective.
scene::Scene sceneFromDeck(const DeckContext& context, const scene::EffectRegistry& registry);

} // namespace Harmos::app
