// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// The list Effects: one sublist a kind of effect, in which each effect has a name of its own.
void addEffectParameters(ParameterSpec& deck);

/// Adds the effects of a deck to a scene that has its bodies.
/// @throws InputError for bodies that are not there and settings that make no sense. Local.
void addEffects(const Teuchos::ParameterList& deck, scene::Scene& scene);

} // namespace Harmos::app
