// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Version.hpp"

#include "Harmos_GitHash.hpp"

namespace Harmos {

std::string version() {
  return HARMOS_VERSION;
}

std::string gitHash() {
  return HARMOS_GIT_HASH;
}

} // namespace Harmos
