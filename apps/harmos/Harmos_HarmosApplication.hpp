// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// Any scene that a deck describes: bodies from mesh files or generators, materials, effects, output, by
/// name.
Application harmosApplication();

} // namespace Harmos::app
