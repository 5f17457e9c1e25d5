// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Effects.hpp"

#include "Harmos_BodyForce.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_PrescribedDisplacement.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_ThermalStrain.hpp"
#include "Harmos_Tie.hpp"
#include "Harmos_Traction.hpp"

namespace Harmos::effects {

void registerEffects(scene::EffectRegistry& registry) {
  registry.add(Tie::registration());
  registry.add(Contact::registration());
  registry.add(RigidObstacle::registration());
  registry.add(BodyForce::registration());
  registry.add(Traction::registration());
  registry.add(PrescribedDisplacement::registration());
  registry.add(ThermalStrain::registration());
}

} // namespace Harmos::effects
