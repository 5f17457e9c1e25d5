// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Scene.hpp"

#include <memory>
#include <string>

namespace Harmos::effects {

/// Whether surfaces may touch by an effect: a Contact or a RigidObstacle.
bool isContact(const scene::Effect& effect);

/// For messages.
struct ActsOnContact {
  std::string notThat; ///< what an effect that is no contact does instead: "does not slip"
  std::string rule;    ///< "friction acts on a contact or an obstacle"
};

/// The contact or obstacle of a scene that a deck names: by its name, or by "Contact/name" where an obstacle
/// has the same.
/// @param path of the parameter. @throws InputError where there is none, offering the nearest, or two, and
/// for an effect of another kind.
std::shared_ptr<const scene::Effect> contactByName(const scene::Scene& scene, const std::string& name,
                                                   const std::string& path, const ActsOnContact& words);

} // namespace Harmos::effects
