// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace Harmos::qp {

/// SplitMix64: well mixed bits of a counter (Steele, Lea, Flood: Fast splittable pseudorandom number
/// generators, 2014).
inline std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

} // namespace Harmos::qp
