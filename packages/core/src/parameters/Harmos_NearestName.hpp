// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace Harmos {

/// The candidate with the least edit distance to the name (letters' case ignored), or that begins with it; ""
/// if none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

/// The end of a sentence about a name that is not known: "; did you mean …?", and the names there are.
std::string offer(const std::string& name, const std::vector<std::string>& known);

} // namespace Harmos
