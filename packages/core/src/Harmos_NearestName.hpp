// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace Harmos {

/// The candidate with the least edit distance to the name (letters' case ignored), or that begins with it; ""
/// if none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

} // namespace Harmos
