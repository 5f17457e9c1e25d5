// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepModel.hpp"

#include "Harmos_StepCalls.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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
  return shape;
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
  EXPECT_DOUBLE_EQ(step.sum(), step.vectors + step.exchange + step.reductions + step.coarse);
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

// Membranes and solids on 1 to 10⁵ ranks, in both forms: the same as by
// tests/performance/performance_model.py, whose table stands in docs/dual_operator.md.
TEST(StepModel, agrees_with_the_performance_model) {
  std::ifstream file(HARMOS_STEP_CASES);
  const nlohmann::json document = nlohmann::json::parse(file);
  ASSERT_GE(document.at("cases").size(), 20u);
  for (const nlohmann::json& item : document.at("cases")) {
    StepShape shape = shapeFrom(item.at("shape"));
    SCOPED_TRACE(item.at("shape").dump());
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
