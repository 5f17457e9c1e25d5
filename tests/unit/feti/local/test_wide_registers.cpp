// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_WideRegisters.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace test_wide_registers {

using namespace Harmos;

// The test stability_order_of_sums runs this with HARMOS_WIDE_REGISTERS=0 too.
TEST(WideRegisters, the_environment_switches_them_off) {
#ifdef HARMOS_HAS_WIDE_REGISTERS
  const char* told = std::getenv("HARMOS_WIDE_REGISTERS");
  const bool isOff = told != nullptr && std::string(told) == "0";
  const bool isSupported = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  EXPECT_EQ(feti::hasWideRegisters(), isSupported && !isOff);
#else
  EXPECT_FALSE(feti::hasWideRegisters());
#endif
}

} // namespace test_wide_registers
