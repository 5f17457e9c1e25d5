// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"

namespace Harmos::effects {

/// Registers every effect of this package, in the order of Harmos_EffectList.inc.
void registerEffects(scene::EffectRegistry& registry);

} // namespace Harmos::effects
