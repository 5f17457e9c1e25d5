// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"

#include <string>

namespace Harmos::effects {

// How decks say where an effect acts. Paths are those of the effect's list in the deck, for messages.

/// A boundary part of a body, by its number in the scene.
struct Part {
  int body = 0;
  std::string set;
};

/// The body that a parameter names.
/// @throws InputError if there is none, offering the nearest.
int bodyIn(const scene::Scene& scene, const Teuchos::ParameterList& list, const std::string& parameter,
           const std::string& path);

/// The part that a parameter names: "body/boundary part". Whether the body has it is seen when there are
/// meshes.
/// @throws InputError as above, and for another form.
Part partIn(const scene::Scene& scene, const Teuchos::ParameterList& list, const std::string& parameter,
            const std::string& path);

/// The same for a text.
Part partNamed(const scene::Scene& scene, const std::string& text, const std::string& place);

/// @param what is for elastic bodies alone. @throws InputError for membranes.
void requireElastic(const scene::Scene& scene, const std::string& what);

/// Three numbers.
fem::Point pointIn(const Teuchos::ParameterList& list, const std::string& parameter);

} // namespace Harmos::effects
