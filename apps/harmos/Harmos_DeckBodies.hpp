// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// The lists Materials and Bodies.
void addBodyParameters(ParameterSpec& deck);

/// Adds the bodies of a deck, in the order of their names there.
/// @throws InputError on all ranks.
/// @note Collective.
void addBodies(const DeckContext& context, scene::Scene& scene);

} // namespace Harmos::app
