// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Effects.hpp"

namespace Harmos::effects {

// What their headers declare, so that a new effect is a line in the list alone.
#define HARMOS_EFFECT(Class) scene::EffectKind kindOf##Class();
#include "Harmos_EffectList.inc"
#undef HARMOS_EFFECT

void registerEffects(scene::EffectRegistry& registry) {
#define HARMOS_EFFECT(Class) registry.add(kindOf##Class());
#include "Harmos_EffectList.inc"
#undef HARMOS_EFFECT
}

} // namespace Harmos::effects
