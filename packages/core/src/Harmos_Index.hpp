// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace Harmos {

/// A number that is not negative, as an index of the standard containers.
inline std::size_t at(long long k) {
  return static_cast<std::size_t>(k);
}

} // namespace Harmos
