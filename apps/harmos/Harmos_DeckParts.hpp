// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

namespace Harmos::app {

/// The list "Boundary parts" of a deck.
void addPartParameters(ParameterSpec& deck);

/// Its rules, for the bodies that the scene has. Local.
/// @throws InputError for bodies that are not there and conditions that are half given, naming the path.
void addBoundaryRules(const Teuchos::ParameterList& deck, scene::Scene& scene);

} // namespace Harmos::app
