// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseModel.hpp"

#include "Harmos_SparseCholesky.hpp"
#include "Harmos_StepCalls.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace test_coarse_model {

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

// Entries of L on a square, or with six motions a cube of subdomains.
double entriesOnGrid(int subdomains, int motions) {
  const bool isCube = motions == 6;
  const int side = static_cast<int>(std::lround(isCube ? std::cbrt(subdomains) : std::sqrt(subdomains)));
  const auto at = [&](int number, int direction) {
    return direction == 0 ? number % side : direction == 1 ? number / side % side : number / side / side;
  };
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int i = 0; i < subdomains; ++i)
    for (int j = 0; j <= i; ++j) {
      bool isNear = true;
      for (int d = 0; d < 3; ++d)
        isNear = isNear && std::abs(at(i, d) - at(j, d)) <= 1;
      for (int k = 0; isNear && k < motions * motions; ++k) {
        const int row = i * motions + k / motions, column = j * motions + k % motions;
        if (column > row)
          continue;
        rows.push_back(row);
        columns.push_back(column);
        values.push_back(row == column ? 200.0 * motions : -1.0);
      }
    }
  return SparseCholesky(subdomains * motions, rows, columns, values).entries();
}

CoarseShape solids(int ranks) {
  CoarseShape shape;
  shape.motions = 6.0;
  shape.dimension = 48.0 * ranks;
  shape.ranks = ranks;
  shape.mostOwn = 48.0;
  return shape;
}

} // namespace

// The written formulas, by hand, with 8 ranks: log₂8 = 3.
TEST(CoarseModel, formulas) {
  constexpr StepCalls whole = replicatedCalls, shared = distributedCalls;
  CoarseShape shape;
  shape.dimension = 20.0;
  shape.ranks = 8;
  shape.mostOwn = 5.0;
  shape.factorEntries = 210.0;
  shape.neighbours = 3.0;
  EXPECT_DOUBLE_EQ(replicatedCoarseSeconds(shape, ones()),
                   whole.coarseVectors * (6.0 + 320.0) + whole.coarseSolves * 210.0);
  EXPECT_DOUBLE_EQ(distributedCoarseSeconds(shape, ones()),
                   shared.coarseVectors * (3.0 + 160.0) + 8.0 * shared.reducedNumbers * 8.0 +
                       shared.coarseSolves * 800.0 + shared.coarseExchanges * 3.0);
  EXPECT_DOUBLE_EQ(coarseBytes(shape, false), 16.0 * 210.0);
  EXPECT_DOUBLE_EQ(coarseBytes(shape, true), 800.0);
  EXPECT_DOUBLE_EQ(coarseBytesOfSetup(shape, true), 8.0 * 210.0); // two ranks
  EXPECT_DOUBLE_EQ(coarseSetupSeconds(shape, false, false, 7.0, ones()), 7.0);
  EXPECT_DOUBLE_EQ(coarseSetupSeconds(shape, true, false, 7.0, ones()),
                   7.0 + 10.0 * 2.0 * 210.0 / std::sqrt(2.0));
  shape.factorEntries = 1e6; // from memory
  EXPECT_DOUBLE_EQ(replicatedCoarseSeconds(shape, ones()),
                   whole.coarseVectors * (6.0 + 320.0) + whole.coarseSolves * 1e6 / 0.5);
  shape.ranks = 1;
  EXPECT_DOUBLE_EQ(distributedCoarseSeconds(shape, ones()), shared.coarseSolves * 800.0);
}

// Where rows of the inverse are too many, groups solve: so many ranks that none needs more than 128 MiB.
TEST(CoarseModel, groups_solve_where_rows_are_too_many) {
  CoarseShape shape = solids(100000);
  shape.factorEntries = 8388608.0 * 100.0; // of 16 bytes, for a hundred ranks
  ASSERT_EQ(coarseGroup(shape), 100);
  ASSERT_TRUE(coarseSolves(shape, 100, false));
  EXPECT_DOUBLE_EQ(coarseBytes(shape, true), 128.0 * 1024.0 * 1024.0);
  EXPECT_DOUBLE_EQ(coarseSetupSeconds(shape, true, false, 7.0, ones()), 7.0);
  CoarseRates rates = ones();
  rates.latency = 0.0;
  rates.bandwidth = 1e300;
  EXPECT_DOUBLE_EQ(distributedCoarseSeconds(shape, rates),
                   distributedCalls.coarseSolves * 2.0 * shape.factorEntries / (0.5 * 10.0));
}

// Beside what SparseCholesky has on grids of subdomains, each with all its neighbours.
TEST(CoarseModel, entries_of_grids) {
  const auto entries = [](double subdomains, double motions) {
    CoarseShape shape;
    shape.motions = motions;
    shape.dimension = motions * subdomains;
    return coarseFactorEntries(shape);
  };
  EXPECT_DOUBLE_EQ(entries(100.0, 1.0), 5050.0); // dense
  struct Case {
    double subdomains, motions;
  };
  for (const Case& item :
       {Case{16 * 16, 1}, {32 * 32, 1}, {16 * 16, 3}, {32 * 32, 3}, {64, 6}, {216, 6}, {512, 6}}) {
    const double found = entriesOnGrid(static_cast<int>(item.subdomains), static_cast<int>(item.motions));
    EXPECT_NEAR(entries(item.subdomains, item.motions), found, 0.15 * found)
        << item.subdomains << " " << item.motions;
  }
}

// Few ranks have it whole, many in shares, and what a rank does in shares goes on being less.
TEST(CoarseModel, many_ranks_share) {
  EXPECT_FALSE(isDistributedCheaper(membranes(2), {}));
  EXPECT_TRUE(isDistributedCheaper(membranes(1000), {}));
  EXPECT_TRUE(isDistributedCheaper(solids(100), {})); // six times the motions
  for (int ranks = 256; ranks < 100000; ranks *= 2) {
    EXPECT_LT(distributedCoarseSeconds(membranes(ranks), {}), replicatedCoarseSeconds(membranes(ranks), {}));
    EXPECT_LT(distributedCoarseSeconds(solids(ranks), {}), replicatedCoarseSeconds(solids(ranks), {}));
  }
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

} // namespace test_coarse_model
