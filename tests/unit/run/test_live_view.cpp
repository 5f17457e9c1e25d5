// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LiveView.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_live_view {

using namespace Harmos;
using namespace Harmos::run;

namespace {

qp::IterationRecord record(int inner, double gradient, double equality, double seconds) {
  return {3, inner, qp::StepKind::Projected, gradient, equality, 0.0, 0.0, 7, inner + 1, seconds, 0.0};
}

} // namespace

// Residuals that fall by a constant factor a step, half a second each: the time is known exactly.
TEST(RemainingTime, is_exact_for_a_geometric_decrease) {
  const feti::DualTargets targets{1e-6, 1e-5};
  RemainingTime remaining;
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(remaining.seconds().has_value(), k >= 5) << k;
    // ‖Gλ‖ is the further one from its target: 10⁻⁵ is reached in step 100.
    remaining.add(record(k, 1e-4 * std::pow(10.0, -0.05 * k), std::pow(10.0, -0.05 * k), 0.5 * k), targets);
  }
  // ε of the sums, times their condition, below 1e3.
  EXPECT_NEAR(*remaining.seconds(), 0.5 * (100 - 39), 1e-9);
}

TEST(RemainingTime, knows_nothing_of_residuals_that_do_not_fall) {
  RemainingTime remaining;
  for (int k = 0; k < 40; ++k)
    remaining.add(record(k, 1.0 + 0.01 * k, 0.0, 0.5 * k), {1e-6, 0.0});
  EXPECT_FALSE(remaining.seconds().has_value());
  // Neither of numbers that are none.
  RemainingTime broken;
  for (int k = 0; k < 40; ++k)
    broken.add(record(k, std::nan(""), 0.0, 0.5 * k), {1e-6, 0.0});
  EXPECT_FALSE(broken.seconds().has_value());
}

// Only the last iterations count: what was slow at first is forgotten.
TEST(RemainingTime, forgets) {
  RemainingTime remaining;
  for (int k = 0; k < 1000; ++k)
    remaining.add(record(k, 1.0, 0.0, 10.0 * k), {1e-6, 0.0});
  for (int k = 0; k < static_cast<int>(RemainingTime::window); ++k)
    remaining.add(record(1000 + k, std::pow(10.0, -0.1 * k), 0.0, 10000.0 + 0.5 * k), {1e-6, 0.0});
  EXPECT_NEAR(*remaining.seconds(), 0.5 * (60 - 49), 1e-9);
}

TEST(StatusLine, tells_times_and_residuals_against_targets) {
  const qp::IterationRecord now = record(120, 2.1e-3, 3.4e-9, 41.4);
  const std::string usual = statusLine("SMALBE", now, {1e-6, 2e-5}, 12.0);
  EXPECT_EQ(usual, "SMALBE 3/120  41 s, 12 s left  |g^P| 2.1e-03/1.0e-06  |G l| 3.4e-09/2.0e-05");
  EXPECT_LT(usual.size(), 80u);
  EXPECT_EQ(statusLine("MPRGP", now, {1e-6, 0.0}, std::nullopt), "MPRGP 3/120  41 s  |g^P| 2.1e-03/1.0e-06");
  EXPECT_EQ(statusLine("M", record(1, 1.0, 0.0, 1.25), {1.0, 0.0}, 190.0),
            "M 3/1  1.2 s, 3 min 10 s left  |g^P| 1.0e+00/1.0e+00");
  EXPECT_EQ(statusLine("M", record(1, 1.0, 0.0, 1.25), {1.0, 0.0}, 7500.0),
            "M 3/1  1.2 s, 2 h 05 min left  |g^P| 1.0e+00/1.0e+00");
}

} // namespace test_live_view
