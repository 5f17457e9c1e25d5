// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestFeti.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_recovery {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

struct Answer {
  KktAudit audit;
  TornSolution torn;
};

Answer solveModel(const TestFeti& feti, double tolerance) {
  const TestDualSolution solution = solveDual(feti.dual, feti.coarse, tolerance);
  EXPECT_TRUE(solution.result.converged()) << solution.result.explanation;
  Answer answer;
  answer.torn = recover(feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dual,
                        *solution.lambda, solution.mu);
  answer.audit = audit(feti.system, feti.constraints, answer.torn);
  return answer;
}

} // namespace

// Ten times the solver tolerance, displacements and forces being of order one.
TEST(Recovery, audit_of_a_tight_solution_is_clean) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
    for (int s : {1, 2, 3}) {
      const TestFeti feti(testModel(s, 4), form);
      const KktAudit audit = solveModel(feti, 1e-11).audit;
      EXPECT_LT(audit.equilibrium, 1e-9) << s;
      EXPECT_LT(audit.gluingJump, 1e-9) << s;
      EXPECT_LT(audit.penetration, 1e-9) << s;
      EXPECT_GE(audit.minContactMultiplier, 0.0) << s;
      EXPECT_LT(audit.complementarity, 1e-9) << s;
      EXPECT_GT(audit.largestDisplacement, 0.1) << s;
    }
}

// The same of clusters, whose averages exert forces that the dual problem does not see, and the answer
// itself.
TEST(Recovery, clusters_have_the_same_answer) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
    for (int size : {0, 2, 4}) {
      ClusterOptions clusters;
      clusters.kind = size == 0 ? ClusterOptions::Kind::Rank : ClusterOptions::Kind::Size;
      clusters.size = size;
      const TestModel model = testModel(3, 4);
      const TestFeti joined(model, form, {}, clusters), apart(model, form);
      const Answer a = solveModel(joined, 1e-11), b = solveModel(apart, 1e-11);
      EXPECT_LT(a.audit.equilibrium, 1e-9) << size;
      EXPECT_LT(a.audit.gluingJump, 1e-9) << size;
      EXPECT_LT(a.audit.penetration, 1e-9) << size;
      EXPECT_GE(a.audit.minContactMultiplier, 0.0) << size;
      EXPECT_LT(a.audit.complementarity, 1e-9) << size;
      EXPECT_LT(joined.coarse.dimension(), apart.coarse.dimension()) << size;
      for (std::size_t i = 0; i < a.torn.displacement.size(); ++i)
        for (std::size_t j = 0; j < a.torn.displacement[i].size(); ++j)
          EXPECT_NEAR(a.torn.displacement[i][j], b.torn.displacement[i][j], 1e-8);
      // Forces of gluing rows are those of averages too: the multipliers are the same, all of them.
      MultiVector difference(*a.torn.multiplier, Teuchos::Copy);
      difference.update(-1.0, *b.torn.multiplier, 1.0);
      std::vector<double> norm(1);
      difference.normInf(Teuchos::arrayViewFromVector(norm));
      EXPECT_LT(norm[0], 1e-7) << size;
    }
}

// An unloaded, floating second membrane that the first one would penetrate by δ: λ = 0 there does not fix α,
// the formula with μ does. The gap is −δ: the second membrane must move up by δ at least.
TEST(Recovery, unloaded_body_in_initial_penetration) {
  TestModel model = testModel(2, 3);
  for (Subdomain& subdomain : model.subdomains)
    changeLoad(subdomain, [](std::vector<double>& load) { std::fill(load.begin(), load.end(), 0.0); });
  for (ConstraintRow& row : model.rows)
    row.bound = -0.25; // u¹ − u² ≤ −0.25
  const TestFeti feti(model);
  const Answer answer = solveModel(feti, 1e-11);
  EXPECT_LT(answer.audit.penetration, 1e-9);
  EXPECT_LT(answer.audit.gluingJump, 1e-9);
  EXPECT_LT(answer.audit.equilibrium * answer.audit.forces, 1e-9); // absolute: f = 0
}

// Prescribed displacements that are not zero: with u = g on x = 0 everything tied is shifted by g.
TEST(Recovery, inhomogeneous_dirichlet_conditions_in_both_forms) {
  const double g = 0.75;
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    TestModel model = testModel(2, 4);
    const TestFeti zero(model, form);
    for (Subdomain& subdomain : model.subdomains)
      for (FixedDof& fixed : subdomain.fixed)
        fixed.value = g;
    const TestFeti shifted(model, form);
    const Answer a = solveModel(zero, 1e-11), b = solveModel(shifted, 1e-11);
    EXPECT_LT(b.audit.gluingJump, 1e-9);
    for (std::size_t i = 0; i < a.torn.displacement.size(); ++i)
      for (std::size_t j = 0; j < a.torn.displacement[i].size(); ++j)
        EXPECT_NEAR(b.torn.displacement[i][j] - a.torn.displacement[i][j], g, 1e-8);
  }
}

// At a loose tolerance Gλ ≠ 0: the loads are not quite in balance. The displacement must not depend on the
// choice of the fixing dofs all the same; without the projection of the loads it does, in the second digit.
TEST(Recovery, loose_solution_does_not_depend_on_the_generalised_inverse) {
  const TestModel model = testModel(2, 8);
  const TestFeti one(model, DirichletForm::Primal, implicitOptions(1)), many(model);
  const TestDualSolution solution = solveDual(one.dual, one.coarse, 1e-3);
  ASSERT_GT(solution.result.equalityNorm, 1e-6); // else the test would be empty
  // One λ and μ, recovered with either inverse; PFP and Pd do not depend on it.
  const TornSolution a =
      recover(one.system, one.constraints, one.inverses, one.coarse, one.dual, *solution.lambda, solution.mu);
  const TornSolution b = recover(many.system, many.constraints, many.inverses, many.coarse, many.dual,
                                 *solution.lambda, solution.mu);
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < a.displacement.size(); ++i)
    for (std::size_t j = 0; j < a.displacement[i].size(); ++j) {
      difference = std::max(difference, std::abs(a.displacement[i][j] - b.displacement[i][j]));
      largest = std::max(largest, std::abs(a.displacement[i][j]));
    }
  EXPECT_LT(difference, 1e-10 * std::max(largest, 1.0));
}

} // namespace test_recovery
