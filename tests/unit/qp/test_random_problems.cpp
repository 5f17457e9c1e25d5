// SPDX-License-Identifier: BSD-3-Clause

/// Seeded random quadratic programs up to n = 8 against answers that share nothing with the solvers: the
/// enumeration of all active sets, or a solution that the problem was built around.

#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_random_problems {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

constexpr double condition = 100.0;
// ‖x − x*‖ ≤ κ-like factors (here below 1e3) times the tolerance times ‖b‖/λ_min (below 30): 1e-11 leaves
// 1e-8.
constexpr double tolerance = 1e-11;

struct Method {
  std::string name;
  std::string rule; // of SMALBE
};

// Every solver that admits the structure.
std::vector<Method> methods(const SmallQp& qp) {
  const bool bounds = !qp.lower.empty() || !qp.upper.empty();
  std::vector<Method> result = {{"Auto", ""}};
  if (!bounds) {
    result.push_back({"PCPG", ""});
    return result;
  }
  result.push_back({"PDAS", ""});
  if (qp.c.rows == 0) {
    result.push_back({"MPRGP", ""});
    return result;
  }
  for (const char* rule : {"precision", "penalty", "both"})
    result.push_back({"SMALBE", rule});
  return result;
}

struct Outcome {
  Result result;
  std::vector<double> x, mu;
};

Outcome solve(const Method& method, const SmallQp& qp, double accuracy = tolerance) {
  const DistributedQp distributed(qp);
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", accuracy);
  if (!method.rule.empty())
    list->sublist("Expert").sublist("SMALBE").set("Update rule", method.rule);
  const auto solver = TpetraSolverFactory().create(method.name, list);
  solver->setProblem(distributed.problem);
  Outcome run;
  run.result = solver->solve();
  run.x = fromVector(*distributed.solution);
  if (qp.c.rows > 0)
    run.mu = fromVector(*distributed.multiplier);
  return run;
}

std::string label(const Method& method, int k) {
  return method.name + (method.rule.empty() ? "" : " " + method.rule) + ", problem " + std::to_string(k);
}

// The KKT conditions, evaluated here: stationarity with multipliers of the right sign, bounds, equalities.
void expectKkt(const SmallQp& qp, const Outcome& run, const std::string& what) {
  const double scale = 1e-8 * (1.0 + norm(qp.b) + norm(run.mu));
  const std::vector<double> g = lagrangianGradient(qp, run.x, run.mu);
  for (std::size_t i = 0; i < run.x.size(); ++i) {
    const double l = qp.lower.empty() ? -infinity : qp.lower[i],
                 u = qp.upper.empty() ? infinity : qp.upper[i];
    EXPECT_GE(run.x[i], l) << what;
    EXPECT_LE(run.x[i], u) << what;
    if (run.x[i] > l)
      EXPECT_LE(g[i], scale) << what << " entry " << i; // only a lower bound may hold a positive multiplier
    if (run.x[i] < u)
      EXPECT_GE(g[i], -scale) << what << " entry " << i;
  }
  EXPECT_LE(norm(equalityResidual(qp, run.x)), 1e-8 * (1.0 + norm(qp.cRhs) + norm(run.x))) << what;
}

void expectSolved(const SmallQp& qp, const std::vector<double>& expected, int k) {
  for (const Method& method : methods(qp)) {
    const Outcome run = solve(method, qp);
    const std::string what = label(method, k);
    ASSERT_EQ(run.result.reason, Reason::Converged) << what << ": " << run.result.explanation;
    EXPECT_LE(distance(run.x, expected), 1e-8 * norm(expected)) << what;
    expectKkt(qp, run, what);
  }
}

} // namespace

TEST(RandomProblems, strictly_convex) {
  std::mt19937 random(101);
  for (int k = 0; k < 1000; ++k) {
    const bool bounds = k % 8 != 7;
    const int n = 1 + k % 8, rows = std::min(n - 1, k / 8 % 3);
    const SmallQp qp = randomQp(random, n, rows, bounds, condition);
    std::vector<double> multipliers;
    const std::vector<double> expected = bruteForce(qp, &multipliers);
    ASSERT_FALSE(expected.empty()) << k;
    expectSolved(qp, expected, k);
    if (HasFatalFailure())
      return;
  }
}

// The penalty method leaves ‖Cx − c‖ ≤ ‖μ*‖/ρ: with L(x_ρ) ≤ L(x*), ρ‖r‖² ≤ −μ*ᵀr (orthonormal rows, in which
// the penalty acts).
TEST(RandomProblems, dual_penalty_within_its_bound) {
  std::mt19937 random(102);
  for (int k = 0; k < 200; ++k) {
    SmallQp qp = randomQp(random, 3 + k % 6, 1 + k % 2, true, condition);
    orthonormalizeRows(qp);
    std::vector<double> multipliers;
    const std::vector<double> expected = bruteForce(qp, &multipliers);
    for (double relative : {1e2, 1e4}) {
      const DistributedQp distributed(qp);
      const auto list = Teuchos::parameterList();
      list->set("Convergence Tolerance", 1e-10);
      list->sublist("Expert").sublist("Dual Penalty").set("Penalty", relative);
      const auto solver = TpetraSolverFactory().create("Dual Penalty", list);
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_EQ(result.reason, Reason::Converged) << k << ": " << result.explanation;
      // The inner residual, 1e-10‖b‖ with ‖b‖ < 30, moves r by as much over λ_min = 1.
      EXPECT_LE(result.equalityNorm, norm(multipliers) / result.penalty + 3e-9) << k << " " << relative;
      // And x follows: strong convexity gives λ_min‖x − x*‖² ≤ ‖μ*‖‖r‖.
      EXPECT_LE(distance(fromVector(*distributed.solution), expected),
                std::sqrt(norm(multipliers) * (norm(multipliers) / result.penalty + 3e-9)) + 3e-8)
          << k;
    }
  }
}

// Entries that touch their bound with a zero multiplier.
TEST(RandomProblems, degenerate) {
  std::mt19937 random(103);
  for (int k = 0; k < 200; ++k) {
    const BuiltQp built = builtQp(random, 2 + k % 7, std::min(k % 3, 1 + k % 2), 0, /*degenerate*/ true);
    expectSolved(built.qp, built.x, k);
    if (HasFatalFailure())
      return;
  }
}

// Rows that repeat, combine or scale others.
TEST(RandomProblems, dependent_equality_rows) {
  std::mt19937 random(104);
  for (int k = 0; k < 200; ++k) {
    SmallQp qp = randomQp(random, 3 + k % 6, 1 + k % 2, k % 4 != 3, condition);
    const std::vector<double> expected = bruteForce(qp);
    addDependentRows(random, qp, 1 + k % 3);
    expectSolved(qp, expected, k);
    if (HasFatalFailure())
      return;
  }
}

// A has a kernel; the problem was built around a solution, which need not be the only one: the minimal cost
// is.
TEST(RandomProblems, semidefinite) {
  std::mt19937 random(105);
  for (int k = 0; k < 200; ++k) {
    const BuiltQp built = builtQp(random, 3 + k % 6, k % 3, 1 + k % 2, k % 5 == 0);
    const double expected = built.qp.cost(built.x);
    for (const Method& method : methods(built.qp)) {
      const Outcome run = solve(method, built.qp, 1e-10);
      const std::string what = label(method, k);
      ASSERT_EQ(run.result.reason, Reason::Converged) << what << ": " << run.result.explanation;
      EXPECT_NEAR(built.qp.cost(run.x), expected, 1e-8 * (1.0 + std::abs(expected))) << what;
      expectKkt(built.qp, run, what);
    }
  }
}

TEST(RandomProblems, infeasible_ones_are_named_and_proven) {
  std::mt19937 random(106);
  for (int k = 0; k < 100; ++k) {
    const SmallQp qp = infeasibleQp(random, 3 + k % 6, k % 4);
    for (const Method& method : methods(qp)) {
      const std::string what = label(method, k);
      const DistributedQp distributed(qp);
      const auto list = Teuchos::parameterList();
      if (!method.rule.empty())
        list->sublist("Expert").sublist("SMALBE").set("Update rule", method.rule);
      const auto solver = TpetraSolverFactory().create(method.name, list);
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_EQ(result.reason, Reason::Infeasible) << what << ": " << toString(result.reason);
      EXPECT_GT(result.certificate.gap, 0.0) << what;
      if (result.certificate.entry >= 0) {
        const auto i = static_cast<std::size_t>(result.certificate.entry);
        EXPECT_GT(qp.lower[i], qp.upper[i]) << what;
        continue;
      }
      // The proof, evaluated here: inf yᵀ(Cx − c) over the box, entries without a bound counted to ‖x‖ =
      // 1000.
      ASSERT_FALSE(solver->certificate().is_null()) << what;
      const std::vector<double> y = fromVector(*solver->certificate());
      EXPECT_NEAR(norm(y), 1.0, 1e-12) << what;
      EXPECT_GT(farkasInfimum(qp, y, 1000.0), 0.0) << what;
    }
  }
}

TEST(RandomProblems, unbounded_ones_are_named_and_proven) {
  std::mt19937 random(107);
  for (int k = 0; k < 100; ++k) {
    const SmallQp qp = unboundedQp(random, 3 + k % 6, k % 3, k % 4 != 3);
    for (const Method& method : methods(qp)) {
      const std::string what = label(method, k);
      const DistributedQp distributed(qp);
      const auto list = Teuchos::parameterList();
      if (!method.rule.empty())
        list->sublist("Expert").sublist("SMALBE").set("Update rule", method.rule);
      const auto solver = TpetraSolverFactory().create(method.name, list);
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_EQ(result.reason, Reason::Unbounded)
          << what << ": " << toString(result.reason) << ", " << result.explanation;
      ASSERT_FALSE(solver->certificate().is_null()) << what;
      const std::vector<double> d = fromVector(*solver->certificate());
      EXPECT_NEAR(norm(d), 1.0, 1e-12) << what;
      double gain = 0.0;
      for (std::size_t i = 0; i < d.size(); ++i) {
        gain += qp.b[i] * d[i];
        if (!qp.lower.empty() && qp.lower[i] > -infinity)
          EXPECT_GE(d[i], 0.0) << what;
        if (!qp.upper.empty() && qp.upper[i] < infinity)
          EXPECT_LE(d[i], 0.0) << what;
      }
      EXPECT_NEAR(gain, result.certificate.gap, 1e-12 * norm(qp.b)) << what;
      EXPECT_GT(gain, 1e-3) << what;
      // Flat to what the curvature test can tell, √(100 ε κ), here with ‖A‖ = κ = 100.
      EXPECT_LE(norm(product(qp.a, d)), 1e-5 * condition) << what;
      EXPECT_LE(norm(product(qp.c, d)), 1e-5) << what;
    }
  }
}

} // namespace test_random_problems
