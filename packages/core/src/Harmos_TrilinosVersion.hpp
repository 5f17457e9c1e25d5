// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The differences between Trilinos 13 and current Trilinos (16 and later), all of them, in one place.

#include <Trilinos_version.h>

#include <cstddef>

namespace Harmos {

/// Number of entries of the map on this rank: getNodeNumElements() was renamed in Trilinos 13.4.
template<class MapType>
std::size_t localSize(const MapType& map) {
#if TRILINOS_MAJOR_MINOR_VERSION >= 130400
  return map.getLocalNumElements();
#else
  return map.getNodeNumElements();
#endif
}

} // namespace Harmos
