// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepModel.hpp"

#include <gtest/gtest.h>

using namespace Harmos::feti;

namespace {

StepRates ones() {
  StepRates rates;
  rates.readBytes = rates.coarseEntries = rates.latency = rates.bandwidth = 1.0;
  rates.coarseFromMemory = 0.5;
  rates.overhead = 3.0;
  return rates;
}

} // namespace

// The written formulas, by hand, with 8 ranks: t = 2·3.
TEST(StepModel, formulas) {
  const StepSeconds step = predictStep({8, 100.0, 10.0, 5, 20.0, 210.0}, ones());
  EXPECT_DOUBLE_EQ(step.vectors, 40.0 * 800.0 + 3.0);
  EXPECT_DOUBLE_EQ(step.exchange, 4.0 * (5.0 + 80.0));
  EXPECT_DOUBLE_EQ(step.reductions, 12.0);
  EXPECT_DOUBLE_EQ(step.coarse, 4.0 * (6.0 + 320.0) + 7.0 * 210.0);
  EXPECT_DOUBLE_EQ(step.sum(), step.vectors + step.exchange + step.reductions + step.coarse);
}

// A rank alone sends nothing.
TEST(StepModel, one_rank_does_not_communicate) {
  const StepSeconds step = predictStep({1, 100.0, 10.0, 5, 20.0, 210.0}, ones());
  EXPECT_DOUBLE_EQ(step.exchange, 0.0);
  EXPECT_DOUBLE_EQ(step.reductions, 0.0);
  EXPECT_DOUBLE_EQ(step.coarse, 7.0 * 210.0);
}

// Factors that leave the cache are read at the rate of memory.
TEST(StepModel, large_coarse_factors_are_slower) {
  EXPECT_DOUBLE_EQ(predictStep({1, 0.0, 0.0, 0, 0.0, 1e6}, ones()).coarse, 7.0 * 1e6 / 0.5);
}
