// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"

namespace Harmos::effects {

/// Registers every effect of this package, a line each. The order is that of decks' references, rows and
/// logs: constraints, loads, supports.
void registerEffects(scene::EffectRegistry& registry);

} // namespace Harmos::effects
