// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_StageTimers.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace test_stage_timers {

using namespace Harmos;

// Counters are global to the process: a second run must not report the first one's seconds.
TEST(StageTimers, a_new_object_counts_from_zero) {
  const auto comm = testComm();
  {
    const StageTimers first({"stage timer test"});
    {
      const auto scope = first.scope("stage timer test");
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_GE(first.seconds(*comm)[0], 0.019);
  }
  const StageTimers second({"stage timer test"});
  EXPECT_EQ(second.seconds(*comm)[0], 0.0);
}

TEST(StageTimers, unknown_stage_is_a_bug) {
  const StageTimers timers({"known"});
  EXPECT_THROW(timers.scope("unknown"), InternalError);
}

} // namespace test_stage_timers
