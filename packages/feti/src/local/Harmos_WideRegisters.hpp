// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Kernels whose source is compiled twice, for the default registers and for wider ones, ask here when the
/// program runs which to call. Not by target_clones: GCC takes vectors apart before it makes the clones.
/// The environment variable HARMOS_WIDE_REGISTERS=0 takes the default ones: sums have another order then, as
/// on a processor without wide registers. Guarded by tests/unit/feti/local/test_wide_registers.cpp.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define HARMOS_HAS_WIDE_REGISTERS 1
#endif

#include <cstdlib>
#include <string_view>

namespace Harmos::feti {

/// Whether this processor has AVX2 with fused multiplication, there are kernels for it, and nobody has
/// switched them off.
inline bool hasWideRegisters() {
#ifdef HARMOS_HAS_WIDE_REGISTERS
  static const bool result = [] {
    const char* told = std::getenv("HARMOS_WIDE_REGISTERS");
    const bool isOff = told != nullptr && std::string_view(told) == "0";
    return !isOff && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  }();
  return result;
#else
  return false;
#endif
}

} // namespace Harmos::feti
