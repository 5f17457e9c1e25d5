// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Kernels whose source is compiled twice, for the default registers and for wider ones, ask here when the
/// program runs which to call. Not by target_clones: GCC takes vectors apart before it makes the clones.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define HARMOS_HAS_WIDE_REGISTERS 1
#endif

namespace Harmos::feti {

/// Whether this processor has AVX2 with fused multiplication, and there are kernels for it.
inline bool hasWideRegisters() {
#ifdef HARMOS_HAS_WIDE_REGISTERS
  static const bool result = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return result;
#else
  return false;
#endif
}

} // namespace Harmos::feti
