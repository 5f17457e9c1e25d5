// SPDX-License-Identifier: BSD-3-Clause

/// F and d̃ from different generalised inverses: the solver converges, to a wrong answer. Only the audit on
/// the primal side, which knows K, f, B, u and λ alone, sees it. This is why all stages take one
/// LocalInverses object.

#include "Harmos_TestFeti.hpp"

#include <gtest/gtest.h>

namespace test_mixed_inverses {

using namespace Harmos;
using namespace Harmos::feti;

TEST(MixedInverses, the_solver_believes_and_the_audit_objects) {
  const TestModel model = testModel(2, 4);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  const LocalInverses forF = makeLocalInverses(system, constraints, implicitOptions(1)),
                      forD = makeLocalInverses(system, constraints);
  const DualOperator dualOperator(constraints, forF);
  const ReplicatedCoarse coarse(system, constraints);
  const double tolerance = 1e-9;

  for (bool mixed : {false, true}) {
    const LocalInverses& other = mixed ? forD : forF;
    const DualProblem dual(system, constraints, other, dualOperator, coarse);
    const TestDualSolution solution = solveDual(dual, coarse, tolerance);
    // By the solver's own residuals all is well in either case.
    ASSERT_TRUE(solution.result.converged());
    const TornSolution torn = recover(system, constraints, forF, coarse, dual, *solution.lambda, solution.mu);
    const KktAudit result = audit(system, constraints, torn);
    if (mixed) {
      EXPECT_GT(std::max({result.gluingJump, result.penetration, result.complementarity}), 1e-4);
    } else {
      EXPECT_LT(result.gluingJump, 1e-7);
      EXPECT_LT(result.penetration, 1e-7);
    }
  }
}

} // namespace test_mixed_inverses
