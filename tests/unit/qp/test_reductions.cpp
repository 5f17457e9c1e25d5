// SPDX-License-Identifier: BSD-3-Clause

/// Bounds that turn out not to matter, or to hold everywhere, cost what the linear problem costs that has the
/// same solution. Products are counted exactly.

#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

namespace test_reductions {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

constexpr int n = 60, bounded = 20;

struct Outcome {
  Result result;
  std::vector<double> x;
};

Outcome solved(const SmallQp& qp, double tolerance) {
  const DistributedQp distributed(qp);
  distributed.precondition(jacobi(qp.a));
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  const auto solver = TpetraSolverFactory().create("Auto", list);
  solver->setProblem(distributed.problem);
  Outcome outcome{solver->solve(), fromVector(*distributed.solution)};
  EXPECT_TRUE(outcome.result.converged()) << outcome.result.explanation;
  return outcome;
}

// The first entries lie well above their lower bound, or are pressed onto it.
SmallQp limit(unsigned seed, double condition, double lower, double force) {
  std::mt19937 random(seed);
  SmallQp qp = randomQp(random, n, 0, false, condition);
  std::uniform_real_distribution<double> part(0.5, 1.5);
  std::vector<double> solution(n);
  for (int i = 0; i < n; ++i)
    solution[static_cast<std::size_t>(i)] = i < bounded && force > 0.0 ? lower : part(random) - 1.0;
  qp.b = product(qp.a, solution);
  for (int i = 0; i < bounded; ++i)
    qp.b[static_cast<std::size_t>(i)] -= force * part(random);
  qp.lower.assign(n, -infinity);
  std::fill_n(qp.lower.begin(), bounded, lower);
  return qp;
}

// The rows of the free entries alone.
SmallQp withoutBounded(const SmallQp& qp) {
  SmallQp rest{Dense(n - bounded, n - bounded), {}, {}, {}, Dense(0, n - bounded), {}};
  for (int i = bounded; i < n; ++i) {
    rest.b.push_back(qp.b[static_cast<std::size_t>(i)]);
    for (int j = bounded; j < n; ++j)
      rest.a(i - bounded, j - bounded) = qp.a(i, j);
  }
  return rest;
}

} // namespace

TEST(Reductions, bounds_that_do_not_matter) {
  for (double condition : {10.0, 100.0})
    for (double tolerance : {1e-4, 1e-8})
      for (unsigned seed = 1; seed <= 10; ++seed) {
        SmallQp qp = limit(seed, condition, -1.0, 0.0);
        const Outcome contact = solved(qp, tolerance);
        qp.lower.clear();
        const Outcome linear = solved(qp, tolerance);
        EXPECT_EQ(contact.result.method, "PDAS");
        EXPECT_EQ(linear.result.method, "PCPG");
        EXPECT_LE(contact.result.counters.hessianApplications,
                  1.1 * linear.result.counters.hessianApplications + 1.0)
            << condition << " " << tolerance << " " << seed;
        EXPECT_LE(distance(contact.x, linear.x), 20.0 * tolerance * norm(qp.b)); // λ_min = 1
      }
}

TEST(Reductions, bounds_that_hold_everywhere) {
  for (double condition : {10.0, 100.0})
    for (double tolerance : {1e-4, 1e-8})
      for (unsigned seed = 1; seed <= 10; ++seed) {
        const SmallQp qp = limit(seed, condition, 0.0, condition);
        const Outcome contact = solved(qp, tolerance), linear = solved(withoutBounded(qp), tolerance);
        EXPECT_LE(contact.result.counters.hessianApplications,
                  1.1 * linear.result.counters.hessianApplications + 1.0)
            << condition << " " << tolerance << " " << seed;
        std::vector<double> x(bounded, 0.0);
        x.insert(x.end(), linear.x.begin(), linear.x.end());
        EXPECT_LE(distance(contact.x, x), 20.0 * tolerance * norm(qp.b));
      }
}

} // namespace test_reductions
