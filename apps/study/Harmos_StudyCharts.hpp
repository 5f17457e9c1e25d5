// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Log.hpp"

#include <string>

namespace Harmos::study {

/// Draws the charts of a finished study into its directory by harmos-study-plot, in a process of its own.
/// Where Python, Matplotlib or the tool is not to be found, or it fails, a sentence says so with the command
/// to draw them later; that is no failure of the study. Local.
/// @return whether they are drawn.
bool drawCharts(const std::string& directory, const Log& log);

} // namespace Harmos::study
