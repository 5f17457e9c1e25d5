// SPDX-License-Identifier: BSD-3-Clause

/// Whole runs with the plain serial type against Tpetra with its fused kernels: the same steps, the same
/// answer. The two share the solvers but no line of vector code.

#include "Harmos_SerialQp.hpp"
#include "Harmos_SolverFactory_def.hpp"
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

namespace test_serial_reference {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using SerialProblem = Problem<double, SerialVector, SerialOperator>;
using SerialFactory = SolverFactory<double, SerialVector, SerialOperator>;

Teuchos::RCP<SerialVector> serial(const std::vector<double>& values) {
  return Teuchos::rcp(new SerialVector(values));
}

struct SerialRun {
  Result result;
  std::vector<double> x, mu;
};

SerialRun solveSerially(const std::string& name, const SmallQp& qp,
                        const Teuchos::RCP<Teuchos::ParameterList>& list, bool preconditioned) {
  const auto problem = Teuchos::rcp(
      new SerialProblem(Teuchos::rcp(new SerialOperator{qp.a}),
                        serial(std::vector<double>(static_cast<std::size_t>(qp.size()), 0.0)), serial(qp.b)));
  if (!qp.lower.empty())
    problem->setLowerBound(serial(qp.lower));
  if (!qp.upper.empty())
    problem->setUpperBound(serial(qp.upper));
  if (!qp.discs.empty())
    problem->setDiscs(std::make_shared<LocalDiscs>(qp.discs, static_cast<std::size_t>(qp.size())));
  const auto mu = serial(std::vector<double>(qp.cRhs.size(), 0.0));
  if (qp.c.rows > 0)
    problem->setEquality(Teuchos::rcp(new SerialOperator{qp.c}), serial(qp.cRhs), mu);
  if (preconditioned)
    problem->setPreconditioner(Teuchos::rcp(new SerialOperator{jacobi(qp.a)}));
  EXPECT_TRUE(problem->setProblem());
  const auto solver = SerialFactory().create(name, list);
  solver->setProblem(problem);
  return {solver->solve(), (*problem->solution())(), (*mu)()};
}

} // namespace

namespace {

void compareSteps(bool withDiscs) {
  std::mt19937 random(31);
  int runs = 0, same = 0;
  for (int k = 0; k < 60; ++k) {
    const bool equalities = k % 2 == 1, bounds = withDiscs || k % 5 != 4, preconditioned = k % 3 == 2;
    const int rows = equalities ? 1 + k % 2 : 0;
    const SmallQp qp = withDiscs ? randomFrictionQp(random, 3 + k % 5, rows, 50.0)
                                 : randomQp(random, 3 + k % 5, rows, bounds, 50.0);
    std::vector<std::string> names = {"Auto"};
    if (bounds) {
      names.push_back("PDAS");
      names.push_back(equalities ? "SMALBE" : "MPRGP");
    } else {
      names.push_back("PCPG");
    }
    if (bounds && equalities && !withDiscs) // thousands of steps with discs
      names.push_back("Dual Penalty");
    for (const std::string& name : names) {
      const auto list = Teuchos::parameterList();
      list->set("Convergence Tolerance", 1e-8);
      const SerialRun reference = solveSerially(name, qp, list, preconditioned);
      DistributedQp distributed(qp);
      if (preconditioned) {
        distributed.precondition(jacobi(qp.a));
      }
      const auto solver = TpetraSolverFactory().create(name, list);
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      const std::string what = name + " " + std::to_string(k);
      ASSERT_EQ(reference.result.reason, Reason::Converged) << what;
      ASSERT_EQ(result.reason, Reason::Converged) << what << result.explanation;
      EXPECT_EQ(result.method, reference.result.method);
      const Counters &mine = result.counters, &theirs = reference.result.counters;
      ++runs;
      same += mine.hessianApplications == theirs.hessianApplications && mine.cgSteps == theirs.cgSteps &&
              mine.expansionSteps == theirs.expansionSteps &&
              mine.proportioningSteps == theirs.proportioningSteps && mine.faces == theirs.faces &&
              mine.activeSetUpdates == theirs.activeSetUpdates;
      // At the end of a face, where conjugate gradients stop of themselves, the residual is rounding errors,
      // and these decide whether another step or a confirmation is made.
      // Sets that wander on rims end a set earlier or later.
      const double most = withDiscs ? 2.0 + 0.1 * theirs.hessianApplications : 2.0;
      EXPECT_NEAR(mine.hessianApplications, theirs.hessianApplications, most) << what;
      // The same steps, summed in another order: rounding errors, amplified by κ = 50 and a dozen steps.
      const std::vector<double> x = fromVector(*distributed.solution);
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(x[i], reference.x[i], 1e-10) << what;
      if (equalities) {
        const std::vector<double> mu = fromVector(*distributed.multiplier);
        for (std::size_t i = 0; i < mu.size(); ++i)
          EXPECT_NEAR(mu[i], reference.mu[i], 1e-7 * (1.0 + std::abs(reference.mu[i]))) << what;
      }
    }
  }
  EXPECT_GT(runs, withDiscs ? 100 : 150);
  EXPECT_GT(10 * same, 9 * runs) << same << " of " << runs;
}

} // namespace

TEST(SerialReference, every_solver_makes_the_same_steps) {
  compareSteps(false);
}

TEST(SerialReference, with_discs_too) {
  compareSteps(true);
}

} // namespace test_serial_reference
