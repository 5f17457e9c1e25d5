// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_InitialMotion.hpp"

namespace Harmos::scene {

InitialMotion::~InitialMotion() = default;

} // namespace Harmos::scene
