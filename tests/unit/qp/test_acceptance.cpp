// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_acceptance {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

struct Case {
  const char* method;
  int equalities;
  bool bounds;
};

const std::vector<Case> cases = {
    {"MPRGP", 0, true}, {"SMALBE", 2, true}, {"PDAS", 0, true}, {"PDAS", 2, true}, {"PCPG", 2, false}};

double distance(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k)
    sum += (x[k] - y[k]) * (x[k] - y[k]);
  return std::sqrt(sum);
}

struct Answer {
  Result result;
  std::vector<double> x, mu;
};

// With a test of the projected gradient that the acceptance makes stricter by a hundred, `times` over.
Answer solve(const SmallQp& qp, const char* method, double tolerance, int times,
             std::vector<std::vector<double>>* asked = nullptr) {
  const DistributedQp distributed(qp);
  const auto solver = TpetraSolverFactory().create(method, Teuchos::null);
  const double scale = distance(qp.b, std::vector<double>(qp.b.size(), 0.0));
  const auto gradient = Teuchos::rcp(new StatusTestProjectedGradient<MultiVector>(tolerance, scale));
  Teuchos::RCP<StatusTest<MultiVector>> test = gradient;
  Teuchos::RCP<StatusTestEqualityDistance<MultiVector>> equality;
  if (qp.c.rows > 0) {
    equality = Teuchos::rcp(new StatusTestEqualityDistance<MultiVector>(1e-12, 0.0));
    using Combo = StatusTestCombo<MultiVector>;
    test = Teuchos::rcp(new Combo(Combo::Type::Sequence, {gradient, equality}));
  }
  solver->setConvergenceTest(test);
  double present = tolerance;
  int refusals = 0;
  solver->setAcceptance([&] {
    if (asked != nullptr)
      asked->push_back(fromVector(*distributed.solution));
    if (refusals == times)
      return true;
    ++refusals;
    present /= 100.0;
    gradient->setTolerance(present);
    return false;
  });
  solver->setProblem(distributed.problem);
  Answer run;
  run.result = solver->solve();
  run.x = fromVector(*distributed.solution);
  if (qp.c.rows > 0)
    run.mu = fromVector(*distributed.multiplier);
  return run;
}

} // namespace

// A solver whose answer is refused goes on from where it is: the answer meets the stricter test, the answers
// it was asked about on the way are nearer and nearer, and the whole costs about as much as a solve with the
// strict test from the start. What it guards against: refusals that are taken for stagnation, a face that is
// begun anew, multipliers that belong to another iterate.
TEST(Acceptance, refused_answers_are_improved) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 20; ++trial)
    for (const Case& item : cases) {
      const SmallQp qp = randomQp(random, 8, item.equalities, item.bounds, 1e4);
      std::vector<double> mu;
      const std::vector<double> exact = bruteForce(qp, &mu);
      std::vector<std::vector<double>> asked;
      const Answer run = solve(qp, item.method, 1e-2, 4, &asked);
      const std::string name = std::string(item.method) + ", trial " + std::to_string(trial);
      ASSERT_EQ(run.result.reason, Reason::Converged) << name << ": " << run.result.explanation;
      ASSERT_EQ(asked.size(), 5u) << name;
      // ‖x − x*‖ ≤ ‖g^P‖/λ_min, the tolerance at last 1e-10, and rounding errors below that.
      const double scale = distance(qp.b, std::vector<double>(qp.b.size(), 0.0));
      EXPECT_LE(distance(run.x, exact), 10.0 * 1e-10 * scale) << name;
      EXPECT_LE(distance(asked.back(), run.x), 0.0) << name;
      for (std::size_t k = 0; k < mu.size(); ++k)
        EXPECT_NEAR(run.mu[k], mu[k], 1e-6 * scale) << name;
      const Answer direct = solve(qp, item.method, 1e-10, 0);
      // A confirmation and a face more for each of the four refusals at most, in doubled products.
      EXPECT_LE(run.result.counters.hessianApplications,
                2 * direct.result.counters.hessianApplications + 4 * 2)
          << name;
    }
}

// Nothing below rounding errors is to be had: a judge that never has enough ends in stagnation, not in a
// loop.
TEST(Acceptance, endless_refusals_end_in_stagnation) {
  std::mt19937 random(12);
  for (const Case& item : cases) {
    const SmallQp qp = randomQp(random, 8, item.equalities, item.bounds, 1e4);
    const Answer run = solve(qp, item.method, 1e-2, 100);
    EXPECT_EQ(run.result.reason, Reason::Stagnation) << item.method << ": " << run.result.explanation;
  }
}

} // namespace test_acceptance
