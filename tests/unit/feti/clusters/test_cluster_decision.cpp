// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterChoice.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <gtest/gtest.h>

namespace test_cluster_decision {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

using Kind = ClusterOptions::Kind;

// 32 membranes of 8 × 8 elements, of which those of the left side are held.
struct Decision {
  TestModel model = testModel(4, 8, true);
  SubdomainSystem system;
  Constraints constraints;
  LocalInverseOptions inverses;

  explicit Decision(DirichletForm form)
      : system(testComm(), model.subdomains, form), constraints(system, model.rows) {}

  ClusterOptions of(Kind kind, int size = 0) const {
    ClusterOptions options;
    options.kind = kind;
    options.size = size;
    options.joins = ClusterOptions::Joins::All;
    Rates slow; // everything speaks for clusters
    slow.step.coarseEntries = slow.step.coarseFromMemory = 1.0;
    CoarseOptions coarse;
    coarse.form = CoarseOptions::Form::Replicated;
    coarse.rates = slow.step;
    return decideClusters(system, constraints, options, inverses, PreconditionerKind::Dirichlet, coarse, slow,
                          30, Log());
  }
};

} // namespace

// No test has as many ranks as clusters begin with: nothing changes on those that there are.
TEST(ClusterDecision, few_ranks_have_none_unless_asked) {
  const Decision decision(DirichletForm::Dual);
  EXPECT_EQ(decision.of(Kind::Auto).kind, Kind::None);
  EXPECT_EQ(decision.of(Kind::None).kind, Kind::None);
  EXPECT_EQ(decision.of(Kind::Rank).kind, Kind::Rank);
  EXPECT_EQ(decision.of(Kind::Size, 3).kind, Kind::Size);
  EXPECT_EQ(decision.of(Kind::Size, 3).size, 3);
  EXPECT_EQ(decision.of(Kind::Auto).joins, ClusterOptions::Joins::All);
}

// What the model goes by is what there is.
TEST(ClusterDecision, numbers_of_a_run) {
  const Decision decision(DirichletForm::Dual);
  const Teuchos::Comm<int>& comm = *testComm();
  const UnjoinedRun run = unjoinedRun(decision.system, decision.constraints, decision.inverses,
                                      {DualForm::Condensed, PreconditionerKind::Dirichlet}, {}, 30);
  EXPECT_EQ(run.subdomains, 32.0);
  EXPECT_EQ(run.step.ranks, comm.getSize());
  EXPECT_EQ(run.step.coarseDimension, 32.0);
  EXPECT_EQ(run.step.ownMotions, 32.0 / comm.getSize());
  EXPECT_EQ(run.clusters.subdomains, 32.0 / comm.getSize());
  EXPECT_EQ(run.clusters.motions, 1.0);
  EXPECT_EQ(run.clusters.distinct, 1.0); // alike, and all of them float
  EXPECT_EQ(run.clusters.boundary, 32.0);
  EXPECT_EQ(run.products, 30.0);
  // Both squares side by side, one of them, half of one.
  EXPECT_NEAR(run.sides.longest, comm.getSize() == 1 ? 8.0 : 4.0, 1e-9);
  EXPECT_NEAR(run.sides.shortest, comm.getSize() < 4 ? 4.0 : 2.0, 1e-9);
  EXPECT_GT(run.productSeconds, 0.0);
  EXPECT_GE(run.step.rows * comm.getSize(), static_cast<double>(decision.constraints.dualDimension()));
  EXPECT_EQ(run.step.sharedRows > 0.0, comm.getSize() > 1);
  // Held ones have no motions; a cluster's are those of a subdomain that floats all the same.
  const Decision primal(DirichletForm::Primal);
  const UnjoinedRun held = unjoinedRun(primal.system, primal.constraints, primal.inverses,
                                       {DualForm::Condensed, PreconditionerKind::Dirichlet}, {}, 30);
  EXPECT_LT(held.step.coarseDimension, 32.0);
  EXPECT_EQ(held.step.motions, held.step.coarseDimension / 32.0);
  EXPECT_EQ(held.clusters.motions, 1.0);
}

} // namespace test_cluster_decision
