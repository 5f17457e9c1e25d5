// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterChoice.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace test_cluster_choice {

using namespace Harmos::feti;

namespace {

using Kind = ClusterOptions::Kind;
using Form = CoarseOptions::Form;

// The loads of docs/dual_operator.md: 16 membranes of 128 × 128 elements a rank, 8 solids of 8 × 8 × 8.
UnjoinedRun membranes(int ranks, double subdomains = 16.0) {
  UnjoinedRun run;
  run.subdomains = subdomains * ranks;
  run.clusters.subdomains = subdomains;
  run.clusters.distinct = 1.0;
  run.clusters.boundary = 512.0;
  run.productSeconds = 4.2e-4 / 16.0 * subdomains;
  run.products = 30.0;
  run.step.ranks = ranks;
  run.step.rows = 257.0 * subdomains;
  run.step.sharedRows = 2068.0;
  run.step.neighbours = std::min(8, ranks - 1);
  run.step.coarseDimension = run.subdomains;
  run.step.ownMotions = subdomains;
  return run;
}

UnjoinedRun solids(int ranks) {
  UnjoinedRun run = membranes(ranks, 8.0);
  run.clusters.boundary = 1158.0;
  run.clusters.motions = run.step.motions = 6.0;
  run.productSeconds = 1.07e-3;
  run.step.rows = 558.0 * 8.0;
  run.step.neighbours = std::min(26, ranks - 1);
  run.step.coarseDimension = 6.0 * run.subdomains;
  run.step.ownMotions = 48.0;
  return run;
}

ClusterPrediction chosen(const UnjoinedRun& run, Form form = Form::Auto, const StepRates& rates = {}) {
  CoarseOptions coarse;
  coarse.form = form;
  coarse.rates = rates;
  return chooseClusters(run, coarse, rates);
}

} // namespace

// Whatever the model expects: a network as slow as this would be worth clusters on two ranks.
TEST(ClusterChoice, few_ranks_have_none) {
  StepRates slow;
  slow.coarseEntries = slow.coarseFromMemory = 1.0;
  for (int ranks : {1, 2, 8, fewestRanksOfClusters - 1}) {
    EXPECT_EQ(chosen(solids(ranks)).kind, Kind::None) << ranks;
    EXPECT_EQ(chosen(solids(ranks), Form::Replicated, slow).kind, Kind::None) << ranks;
    EXPECT_EQ(chosen(solids(ranks), Form::Replicated, slow).clusters, 0) << ranks;
  }
  EXPECT_NE(chosen(solids(fewestRanksOfClusters), Form::Replicated, slow).kind, Kind::None);
}

// Distributed, local work outweighs the coarse problem of some hundred ranks; at 10⁵ it is all there is.
TEST(ClusterChoice, many_ranks_have_clusters) {
  EXPECT_EQ(chosen(membranes(256)).kind, Kind::None);
  EXPECT_EQ(chosen(solids(256)).kind, Kind::None);
  for (const UnjoinedRun& run : {membranes(100000), solids(100000)}) {
    const ClusterPrediction best = chosen(run);
    ASSERT_NE(best.kind, Kind::None);
    EXPECT_GE(best.clusters, 100000);
    EXPECT_LT(best.step.coarseDimension, 0.5 * run.step.coarseDimension);
    EXPECT_GT(best.growth, 1.0);
  }
  // Replicated it takes over much earlier.
  EXPECT_NE(chosen(solids(256), Form::Replicated).kind, Kind::None);
}

// Where the guide says that it takes them: 2100 ranks of 8 solids, 7900 of 16 membranes, with a cluster a
// rank.
TEST(ClusterChoice, begins_where_the_guide_says) {
  const auto first = [](const auto& load) {
    int ranks = fewestRanksOfClusters;
    while (ranks < 1000000 && chosen(load(ranks)).kind == Kind::None)
      ranks += std::max(1, ranks / 50);
    return ranks;
  };
  const int ofSolids = first([](int ranks) { return solids(ranks); });
  EXPECT_GE(ofSolids, 1000);
  EXPECT_LE(ofSolids, 3000);
  const int ofMembranes = first([](int ranks) { return membranes(ranks); });
  EXPECT_GE(ofMembranes, 4000);
  EXPECT_LE(ofMembranes, 9000);
}

// None is left only for half of its seconds; and what is taken is among the fastest.
TEST(ClusterChoice, is_a_clear_gain) {
  int joined = 0;
  for (int ranks = 32; ranks < 200000; ranks *= 2)
    for (const UnjoinedRun& run : {membranes(ranks), membranes(ranks, 64.0), solids(ranks)})
      for (Form form : {Form::Auto, Form::Replicated, Form::Distributed}) {
        CoarseOptions coarse;
        coarse.form = form;
        const double none = predictClusters(run, Kind::None, 0, coarse, {}).seconds;
        double fastest = predictClusters(run, Kind::Rank, 0, coarse, {}).seconds;
        for (int size = 2; size < run.clusters.subdomains; size *= 2)
          fastest = std::min(fastest, predictClusters(run, Kind::Size, size, coarse, {}).seconds);
        const ClusterPrediction best = chooseClusters(run, coarse, {});
        EXPECT_EQ(best.kind == Kind::None, fastest >= 0.5 * none) << ranks;
        if (best.kind == Kind::None)
          continue;
        ++joined;
        EXPECT_LE(best.seconds, 1.1 * fastest) << ranks;
        EXPECT_LT(best.seconds, 0.5 * none) << ranks;
      }
  EXPECT_GT(joined, 10);
}

// Strips, as the shares of generated blocks are: where a cube has a cluster, a chain of eight has none, or
// shorter ones.
TEST(ClusterChoice, slender_clusters_are_dear) {
  UnjoinedRun run = solids(4096);
  run.sides = {2.0, 2.0};
  EXPECT_EQ(chosen(run).kind, Kind::Rank);
  const double growth = predictClusters(run, Kind::Rank, 0, {}, {}).growth;
  EXPECT_DOUBLE_EQ(growth, growthOfProducts(8.0, true));
  run.sides = {8.0, 1.0};
  EXPECT_GT(predictClusters(run, Kind::Rank, 0, {}, {}).growth, 3.0 * growth);
  EXPECT_EQ(chosen(run).kind, Kind::None);
}

// One subdomain a rank: nothing is there to be joined.
TEST(ClusterChoice, one_subdomain_a_rank_stays_alone) {
  EXPECT_EQ(chosen(membranes(100000, 1.0), Form::Replicated).kind, Kind::None);
}

// As asked for: numbers of clusters, and the coarse problem that is left.
TEST(ClusterChoice, predictions_of_what_is_asked_for) {
  const UnjoinedRun run = solids(1000);
  const ClusterPrediction none = predictClusters(run, Kind::None, 0, {}, {});
  EXPECT_EQ(none.clusters, 0);
  EXPECT_DOUBLE_EQ(none.step.coarseDimension, 48000.0);
  const ClusterPrediction rank = predictClusters(run, Kind::Rank, 0, {}, {});
  EXPECT_EQ(rank.clusters, 1000);
  EXPECT_DOUBLE_EQ(rank.step.coarseDimension, 6000.0);
  EXPECT_DOUBLE_EQ(rank.growth, growthOfProducts(8.0, true));
  const ClusterPrediction fours = predictClusters(run, Kind::Size, 4, {}, {});
  EXPECT_EQ(fours.clusters, 2000);
  EXPECT_DOUBLE_EQ(fours.step.coarseDimension, 12000.0);
  // About three: 8/3 is nearest to three clusters a rank.
  EXPECT_EQ(predictClusters(run, Kind::Size, 3, {}, {}).clusters, 3000);
  EXPECT_EQ(predictClusters(run, Kind::Size, 1000, {}, {}).clusters, 1000);
  EXPECT_GT(rank.setupSeconds, 0.0);
  EXPECT_NEAR(rank.seconds,
              rank.setupSeconds +
                  run.products * rank.growth * (run.productSeconds + predictStep(rank.step).sum()),
              1e-12 * rank.seconds);
}

} // namespace test_cluster_choice
