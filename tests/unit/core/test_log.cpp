// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Log.hpp"
#include "Harmos_Version.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace test_log {

using namespace Harmos;

TEST(Log, quiet_hides_progress_but_never_errors) {
  std::ostringstream out, err;
  const Log log(out, err, Log::Verbosity::Quiet, true);
  log.info("progress");
  log.error("broken");
  EXPECT_EQ(out.str(), "");
  EXPECT_EQ(err.str(), "error: broken\n");
}

TEST(Log, inactive_ranks_are_silent) {
  std::ostringstream out, err;
  const Log log(out, err, Log::Verbosity::Detailed, false);
  log.info("progress");
  log.error("broken");
  EXPECT_EQ(out.str() + err.str(), "");
  EXPECT_FALSE(log.writesInfo());
}

TEST(Log, default_is_silent) {
  const Log log;
  EXPECT_NO_THROW(log.error("nobody hears"));
}

TEST(Log, details_need_detailed) {
  std::ostringstream out, err;
  Log(out, err, Log::Verbosity::Normal, true).detail("a");
  Log(out, err, Log::Verbosity::Detailed, true).detail("b");
  EXPECT_EQ(out.str(), "b\n");
}

TEST(Version, has_three_numbers_and_a_hash) {
  const std::string text = version();
  EXPECT_EQ(std::count(text.begin(), text.end(), '.'), 2);
  EXPECT_FALSE(gitHash().empty());
}

} // namespace test_log
