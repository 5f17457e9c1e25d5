// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace Harmos {

/// "major.minor.patch".
std::string version();

/// Short hash of the commit that was built, "-dirty" behind it if the tree had changes, or "unknown".
std::string gitHash();

} // namespace Harmos
