// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterModel.hpp"

#include "Harmos_StepCalls.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace test_step_model {

using namespace Harmos::feti;

namespace {

StepRates ones() {
  StepRates rates;
  rates.readBytes = rates.coarseEntries = rates.latency = rates.bandwidth = 1.0;
  rates.coarseFromMemory = 0.5;
  rates.overhead = 3.0;
  return rates;
}

StepShape shapeFrom(const nlohmann::json& json) {
  StepShape shape;
  shape.ranks = json.at("ranks");
  shape.rows = json.at("rows");
  shape.sharedRows = json.at("shared_rows");
  shape.neighbours = json.at("neighbours");
  shape.coarseDimension = json.at("coarse_dimension");
  shape.coarseEntries = json.at("coarse_entries");
  shape.ownMotions = json.at("own_motions");
  shape.motions = json.at("motions");
  shape.sharedMotions = json.at("shared_motions");
  shape.clusterSize = json.at("cluster_size");
  shape.joinBytes = json.at("join_bytes");
  shape.joinEntries = json.at("join_entries");
  return shape;
}

ClusterShape clustersFrom(const nlohmann::json& json) {
  ClusterShape clusters;
  clusters.size = json.at("size");
  clusters.share = json.at("share");
  clusters.subdomains = json.at("subdomains");
  clusters.distinct = json.at("distinct");
  clusters.boundary = json.at("boundary");
  clusters.motions = json.at("motions");
  clusters.aspect = json.at("aspect");
  return clusters;
}

void expectNear(double value, const nlohmann::json& expected) {
  EXPECT_NEAR(value, expected.get<double>(), 1e-12 * std::abs(expected.get<double>()));
}

} // namespace

// The written formulas, by hand, with 8 ranks: t = 2·3.
TEST(StepModel, formulas) {
  constexpr StepCalls calls = replicatedCalls;
  StepShape shape{8, 100.0, 10.0, 5, 20.0, 210.0};
  StepSeconds step = predictStep(shape, ones());
  EXPECT_DOUBLE_EQ(step.vectors, 40.0 * 800.0 + 3.0);
  EXPECT_DOUBLE_EQ(step.exchange, calls.exchanges * (5.0 + 80.0));
  EXPECT_DOUBLE_EQ(step.reductions, calls.reductions * 6.0);
  EXPECT_DOUBLE_EQ(step.coarse, calls.coarseVectors * (6.0 + 320.0) + calls.coarseSolves * 210.0);
  EXPECT_DOUBLE_EQ(step.joins, 0.0);
  shape.joinBytes = 7.0;
  shape.joinEntries = 4.0;
  step = predictStep(shape, ones());
  EXPECT_DOUBLE_EQ(step.joins, 11.0);
  EXPECT_DOUBLE_EQ(step.sum(), step.vectors + step.exchange + step.reductions + step.coarse + step.joins);
  shape.isCoarseDistributed = true;
  shape.ownMotions = 4.0;
  step = predictStep(shape, ones());
  constexpr StepCalls shared = distributedCalls;
  EXPECT_DOUBLE_EQ(step.coarse, shared.coarseVectors * (3.0 + 160.0) + 8.0 * shared.reducedNumbers * 8.0 +
                                    shared.coarseSolves * 640.0 + shared.coarseExchanges * 5.0);
}

// A rank alone sends nothing.
TEST(StepModel, one_rank_does_not_communicate) {
  const StepShape shape{1, 100.0, 10.0, 5, 20.0, 210.0};
  const StepSeconds step = predictStep(shape, ones());
  EXPECT_DOUBLE_EQ(step.exchange, 0.0);
  EXPECT_DOUBLE_EQ(step.reductions, 0.0);
  EXPECT_DOUBLE_EQ(step.coarse, replicatedCalls.coarseSolves * 210.0);
  const StepCounts counts = predictCounts(shape);
  EXPECT_EQ(counts.messages + counts.messageBytes + counts.reductions + counts.gathers, 0.0);
  EXPECT_EQ(counts.collectiveBytes, 0.0);
}

// Factors that leave the cache are read at the rate of memory.
TEST(StepModel, large_coarse_factors_are_slower) {
  EXPECT_DOUBLE_EQ(predictStep({1, 0.0, 0.0, 0, 0.0, 1e6}, ones()).coarse,
                   replicatedCalls.coarseSolves * 1e6 / 0.5);
}

// 2 × 2 × 2 solids with boundaries of 10 dofs: 12 faces with 6 averages each, in W as many columns as six
// faces have where operators are shared, and else as three; F₀ of 72 rows is dense.
TEST(StepModel, joins_of_a_cube) {
  ClusterShape cube{8.0, 0.125, 16.0, 16.0, 10.0, 6.0};
  JoinCosts costs = joinCosts(cube);
  const double f0 = 36.0 * 73.0, s0 = 4.0 * 48.0 * 49.0;
  EXPECT_NEAR(costs.averages, 72.0, 1e-9);
  EXPECT_NEAR(costs.bytesRead, 16.0 * 10.0 * (2.0 * 18.0 + 6.0) * 16.0 + 2.0 * s0, 1e-6);
  EXPECT_NEAR(costs.entries, 6.0 * 2.0 * f0, 1e-6);
  EXPECT_NEAR(costs.bytesHeld, 8.0 * 10.0 * 42.0 * 16.0 + 2.0 * (32.0 * f0 + s0), 1e-6);
  cube.distinct = 1.0;
  costs = joinCosts(cube);
  EXPECT_NEAR(costs.bytesRead, 16.0 * 10.0 * (2.0 * 36.0 + 6.0) * (16.0 / 6.0) + 2.0 * s0, 1e-6);
  cube.size = 1.0;
  EXPECT_EQ(joinCosts(cube).bytesRead + joinCosts(cube).entries + joinCosts(cube).bytesHeld, 0.0);
}

// Two clusters of 2 × 2 membranes a rank: a row of two has 12 neighbours less what is its own.
TEST(StepModel, motions_are_those_of_clusters) {
  StepShape alone{9, 100.0, 10.0, 8, 72.0, 500.0};
  alone.ownMotions = 8.0;
  alone.sharedMotions = 20.0;
  const StepShape joined = withClusters(alone, {4.0, 0.25, 8.0, 8.0, 10.0, 1.0});
  EXPECT_DOUBLE_EQ(joined.coarseDimension, 18.0);
  EXPECT_DOUBLE_EQ(joined.coarseEntries, 0.0); // not those of the larger one
  EXPECT_DOUBLE_EQ(joined.ownMotions, 2.0);
  EXPECT_NEAR(joined.sharedMotions, std::pow(std::sqrt(2.0) + 2.0, 2.0) - 2.0, 1e-12);
  EXPECT_DOUBLE_EQ(joined.sharedRows, alone.sharedRows);
  EXPECT_EQ(withClusters(alone, {1.0, 1.0, 8.0, 8.0, 10.0, 1.0}).coarseEntries, 500.0);
}

TEST(StepModel, products_grow_with_the_side_of_a_cluster) {
  EXPECT_DOUBLE_EQ(growthOfProducts(1.0, false), 1.0);
  EXPECT_DOUBLE_EQ(growthOfProducts(16.0, false), 1.0 + 2.0 * ProductGrowth::plane);
  EXPECT_NEAR(growthOfProducts(27.0, true), 1.0 + std::log2(3.0) * ProductGrowth::space, 1e-14);
  EXPECT_DOUBLE_EQ(growthOfProducts(8.0, true, 8.0),
                   1.0 + ProductGrowth::space + 7.0 * ProductGrowth::slenderInSpace);
  EXPECT_DOUBLE_EQ(growthOfProducts(16.0, false, 3.0),
                   1.0 + 2.0 * ProductGrowth::plane + 2.0 * ProductGrowth::slenderInPlane);
}

// Bricks of cells of any size, whose centres say how many there are along a side.
TEST(StepModel, sides_of_shares) {
  struct Case {
    int x, y, z;
    bool isInSpace;
    double longest, shortest;
  };
  for (const Case& item : {Case{4, 4, 1, false, 4, 4}, Case{8, 2, 1, false, 8, 2}, Case{1, 8, 1, false, 8, 1},
                           Case{2, 2, 2, true, 2, 2}, Case{1, 1, 8, true, 8, 1}, Case{2, 6, 3, true, 6, 2},
                           Case{1, 1, 1, true, 1, 1}}) {
    std::vector<std::array<double, 3>> centres;
    for (int k = 0; k < item.x * item.y * item.z; ++k)
      centres.push_back({7.0 + 0.3 * (k % item.x), 0.3 * (k / item.x % item.y), 0.3 * (k / item.x / item.y)});
    const ShareSides sides = sidesOf(centres, item.isInSpace);
    EXPECT_NEAR(sides.longest, item.longest, 1e-9) << item.x << item.y << item.z;
    EXPECT_NEAR(sides.shortest, item.shortest, 1e-9) << item.x << item.y << item.z;
  }
  EXPECT_DOUBLE_EQ(aspectOfClusters({8.0, 1.0}, 8.0, 1.0, true), 8.0);
  EXPECT_DOUBLE_EQ(aspectOfClusters({8.0, 1.0}, 8.0, 2.0, true), 4.0);
  EXPECT_DOUBLE_EQ(aspectOfClusters({8.0, 1.0}, 8.0, 8.0, true), 1.0);
  EXPECT_DOUBLE_EQ(aspectOfClusters({8.0, 2.0}, 16.0, 4.0, false), 1.0);
  EXPECT_DOUBLE_EQ(aspectOfClusters({6.0, 2.0}, 36.0, 1.0, true), 3.0);
}

// Membranes and solids on 1 to 10⁵ ranks, in both forms: the same as by
// tests/performance/performance_model.py, whose table stands in docs/dual_operator.md.
TEST(StepModel, agrees_with_the_performance_model) {
  std::ifstream file(HARMOS_STEP_CASES);
  const nlohmann::json document = nlohmann::json::parse(file);
  ASSERT_GE(document.at("cases").size(), 20u);
  for (const nlohmann::json& item : document.at("cases")) {
    StepShape shape = shapeFrom(item.at("shape"));
    SCOPED_TRACE(item.at("shape").dump());
    if (item.contains("clusters")) {
      const ClusterShape clusters = clustersFrom(item.at("clusters"));
      const StepShape joined = withClusters(shapeFrom(item.at("alone")), clusters);
      for (const auto& [mine, theirs] :
           {std::pair(joined.coarseDimension, shape.coarseDimension),
            std::pair(joined.ownMotions, shape.ownMotions),
            std::pair(joined.sharedMotions, shape.sharedMotions),
            std::pair(joined.joinBytes, shape.joinBytes), std::pair(joined.joinEntries, shape.joinEntries)})
        EXPECT_NEAR(mine, theirs, 1e-12 * theirs);
      const JoinCosts costs = joinCosts(clusters);
      expectNear(costs.averages, item.at("clusters").at("averages"));
      expectNear(costs.bytesHeld, item.at("clusters").at("bytes_held"));
      expectNear(growthOfProducts(clusters.size, clusters.isInSpace(), clusters.aspect), item.at("growth"));
    }
    EXPECT_EQ(isDistributedCheaper(shape.coarse(), {}), item.at("distributed_by_auto").get<bool>());
    for (const char* form : {"replicated", "distributed"}) {
      SCOPED_TRACE(form);
      shape.isCoarseDistributed = std::string(form) == "distributed";
      const nlohmann::json& expected = item.at(form);
      const StepSeconds step = predictStep(shape);
      expectNear(step.vectors, expected.at("vectors"));
      expectNear(step.exchange, expected.at("exchange"));
      expectNear(step.reductions, expected.at("scalars"));
      expectNear(step.coarse, expected.at("coarse"));
      expectNear(step.joins, expected.at("joins"));
      const StepCounts counts = predictCounts(shape);
      expectNear(counts.messages, expected.at("messages"));
      expectNear(counts.messageBytes, expected.at("message_bytes"));
      expectNear(counts.reductions, expected.at("reductions"));
      expectNear(counts.gathers, expected.at("gathers"));
      expectNear(counts.collectiveBytes, expected.at("collective_bytes"));
      expectNear(coarseBytes(shape.coarse(), shape.isCoarseDistributed), expected.at("coarse_bytes"));
    }
  }
}

} // namespace test_step_model
