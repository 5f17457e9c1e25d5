// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// Signorini problems: the model problem of two membranes, and elastic bodies on a rigid plane.
Application signoriniApplication();

} // namespace Harmos::app
