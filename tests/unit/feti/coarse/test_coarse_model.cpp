// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseModel.hpp"

#include <gtest/gtest.h>

using namespace Harmos::feti;

namespace {

CoarseRates ones() {
  CoarseRates rates;
  rates.readBytes = rates.coarseEntries = rates.latency = rates.bandwidth = 1.0;
  rates.coarseFromMemory = 0.5;
  return rates;
}

CoarseShape membranes(int ranks) {
  CoarseShape shape;
  shape.dimension = 16.0 * ranks;
  shape.ranks = ranks;
  shape.mostOwn = 16.0;
  return shape;
}

} // namespace

// The written formulas, by hand, with 8 ranks: log₂8 = 3.
TEST(CoarseModel, formulas) {
  CoarseShape shape;
  shape.dimension = 20.0;
  shape.ranks = 8;
  shape.mostOwn = 5.0;
  shape.factorEntries = 210.0;
  EXPECT_DOUBLE_EQ(replicatedCoarseSeconds(shape, ones()), 4.0 * (6.0 + 320.0) + 7.0 * 210.0);
  EXPECT_DOUBLE_EQ(distributedCoarseSeconds(shape, ones()), 4.0 * (3.0 + 160.0 + 800.0 + 4.0));
  shape.factorEntries = 1e6; // from memory
  EXPECT_DOUBLE_EQ(replicatedCoarseSeconds(shape, ones()), 4.0 * (6.0 + 320.0) + 7.0 * 1e6 / 0.5);
  shape.ranks = 1;
  EXPECT_DOUBLE_EQ(distributedCoarseSeconds(shape, ones()), 4.0 * 800.0);
}

// Few ranks have it whole, many in shares, and what a rank does in shares goes on being less.
TEST(CoarseModel, many_ranks_share) {
  EXPECT_FALSE(isDistributedCheaper(membranes(2), {}));
  EXPECT_TRUE(isDistributedCheaper(membranes(1000), {}));
  for (int ranks = 256; ranks < 100000; ranks *= 2)
    EXPECT_LT(distributedCoarseSeconds(membranes(ranks), {}), replicatedCoarseSeconds(membranes(ranks), {}));
}

// Groups grow with the factor, from two ranks to all.
TEST(CoarseModel, groups) {
  EXPECT_EQ(coarseGroup(membranes(1)), 1);
  EXPECT_EQ(coarseGroup(membranes(64)), 2);
  EXPECT_GT(coarseGroup(membranes(100000)), 4);
  CoarseShape huge = membranes(4);
  huge.dimension = 1e8;
  EXPECT_EQ(coarseGroup(huge), 4);
}
