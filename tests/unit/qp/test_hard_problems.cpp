// SPDX-License-Identifier: BSD-3-Clause

/// Problems on which a QP solver may tell something wrong: each test is named after what it must not tell.

#include "Harmos_RandomQp.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace test_hard_problems {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

Dense diagonal(const std::vector<double>& entries) {
  const int n = static_cast<int>(entries.size());
  Dense a(n, n);
  for (int i = 0; i < n; ++i)
    a(i, i) = entries[static_cast<std::size_t>(i)];
  return a;
}

Dense rows(const std::vector<std::vector<double>>& entries) {
  Dense c(static_cast<int>(entries.size()), static_cast<int>(entries.front().size()));
  for (int r = 0; r < c.rows; ++r)
    for (int j = 0; j < c.columns; ++j)
      c(r, j) = entries[static_cast<std::size_t>(r)][static_cast<std::size_t>(j)];
  return c;
}

struct Answer {
  Result result;
  std::vector<double> x, mu;
};

Answer solve(const std::string& name, const SmallQp& qp, double tolerance = 1e-8,
             const std::string& rule = "", const std::vector<double>& start = {},
             const std::vector<double>& kernel = {},
             EqualityStructure structure = EqualityStructure::General) {
  const DistributedQp distributed(qp, structure);
  if (!start.empty())
    distributed.solution->assign(*toVector(start, distributed.map));
  if (!kernel.empty()) {
    distributed.problem->setNullSpace(toVector(kernel, distributed.map));
    distributed.problem->setProblem();
  }
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", 20000);
  if (!rule.empty())
    list->sublist("Expert").sublist("SMALBE").set("Update rule", rule);
  const auto solver = TpetraSolverFactory().create(name, list);
  solver->setProblem(distributed.problem);
  Answer answer{solver->solve(), {}, {}};
  answer.x = fromVector(*distributed.solution);
  if (qp.c.rows > 0)
    answer.mu = fromVector(*distributed.multiplier);
  return answer;
}

const std::vector<std::string> withEqualities = {"Auto", "SMALBE", "PDAS"};

} // namespace

// Two variables in the orthant, x₁ + x₂ = c, pressed against the origin, where the iteration so begins and
// stays for long: at x = 0 the rows cannot be met by what is at hand, which proves nothing.
TEST(HardProblems, feasible_orthant_is_not_infeasible) {
  for (double pressure : {10.0, 1.0, 1e4})
    for (double c : {1.0, 1e-3}) {
      SmallQp qp{diagonal({1, 1}), {-pressure, -pressure}, {0, 0}, {}, rows({{1, 1}}), {c}};
      for (const std::string& name : withEqualities)
        for (const char* rule : {"precision", "penalty", "both"}) {
          const Answer answer = solve(name, qp, 1e-8, rule);
          const std::string what =
              name + " " + rule + " " + std::to_string(pressure) + " " + std::to_string(c);
          ASSERT_TRUE(answer.result.converged()) << what << ": " << answer.result.explanation;
          EXPECT_NEAR(answer.x[0], c / 2, 1e-6 * c) << what;
          EXPECT_NEAR(answer.mu[0], -pressure - c / 2, 1e-6 * pressure) << what;
        }
    }
}

// Feasible by a small margin: never infeasible; with the margin turned round, always.
TEST(HardProblems, nearly_infeasible_is_not_infeasible) {
  std::mt19937 random(301);
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  for (int k = 0; k < 40; ++k) {
    const double margin = std::pow(10.0, -3.0 - k % 4);
    SmallQp qp = randomQp(random, 4, 1, false, 10.0);
    qp.lower.assign(4, -1.0);
    qp.upper.assign(4, 1.0);
    double most = 0.0;
    for (int i = 0; i < 4; ++i) {
      qp.c(0, i) = unit(random);
      most += qp.c(0, i);
    }
    for (const std::string& name : withEqualities) {
      qp.cRhs = {most - margin};
      const Answer feasible = solve(name, qp, 1e-6);
      ASSERT_NE(feasible.result.reason, Reason::Infeasible) << name << " " << k;
      qp.cRhs = {most + margin};
      const Answer infeasible = solve(name, qp, 1e-6);
      if (margin > 1e-5) // below, the tolerance itself covers the gap
        ASSERT_EQ(infeasible.result.reason, Reason::Infeasible) << name << " " << k;
    }
  }
}

// Rows that nearly depend on each other, and are met by x = (0, 1) all the same.
TEST(HardProblems, nearly_dependent_rows_are_not_contradictory) {
  for (double angle : {1e-3, 1e-6, 1e-7, 1e-8}) {
    const SmallQp qp{diagonal({1, 1}), {0.5, 0.5}, {}, {}, rows({{1, 0}, {1, angle}}), {0, angle}};
    const Answer answer = solve("PCPG", qp, 1e-6);
    EXPECT_NE(answer.result.reason, Reason::Infeasible) << angle;
    if (angle >= 1e-6)
      EXPECT_NEAR(answer.x[1], 1.0, 1e-5) << angle << " " << answer.result.explanation;
  }
}

// x = (2, 0) meets rows that differ by little; CCᵀ takes them for one. Their difference is known to ε/angle.
TEST(HardProblems, rows_that_differ_by_little_are_both_met) {
  for (double angle : {1e-6, 1e-8, 1e-9, 1e-11})
    for (const std::string name : {"Auto", "PCPG", "SMALBE", "PDAS"})
      for (int copies : {0, 2}) {
        SmallQp qp{diagonal({1, 1}), {0, 0}, {}, {}, rows({{1, 1}, {1, 1 + angle}}), {2, 2}};
        if (copies > 0) // rows that do depend on others are left out as before
          qp.c = rows({{1, 1}, {-3, -3}, {1, 1 + angle}, {2, 2 + 2 * angle}}), qp.cRhs = {2, -6, 2, 4};
        // Where CCᵀ still tells, C̄x is L⁻¹(Cx), with an error of ε/angle; of a basis it is one of ε.
        const double tolerance = angle > 1e-7 ? 1e-9 : 1e-12;
        const Answer answer = solve(name, qp, tolerance);
        const std::string what = name + " " + std::to_string(angle) + ": " + answer.result.explanation;
        ASSERT_TRUE(answer.result.converged()) << what;
        EXPECT_NEAR(answer.x[0], 2.0, 1e-15 / angle + 1e2 * tolerance) << what;
        EXPECT_NEAR(answer.x[1], 0.0, 1e-15 / angle + 1e2 * tolerance) << what;
        const std::vector<double> gradient = lagrangianGradient(qp, answer.x, answer.mu);
        // Multipliers are of the size of 1/angle, and cancel.
        EXPECT_LT(norm(gradient), 1e-14 / angle + 1e2 * tolerance) << what;
      }
}

// One orthonormalisation leaves C̄C̄ᵀ − I = ε/angle², 1e-6 here, and with it the equalities unmet; two leave ε.
TEST(HardProblems, ill_conditioned_rows_are_met) {
  for (double angle : {1e-4, 1e-5}) {
    const SmallQp qp{diagonal({1, 2, 3}), {1, 1, 1}, {}, {}, rows({{1, 1, 0}, {1, 1 + angle, 0}}),
                     {1, 1 + 2 * angle}};
    for (const char* name : {"PCPG"}) {
      const Answer answer = solve(name, qp, 1e-10);
      ASSERT_TRUE(answer.result.converged()) << name << " " << angle << " " << answer.result.explanation;
      // x₁ + x₂ = 1 and x₂ = 2, the latter through a difference of rows: ε/angle at best.
      EXPECT_NEAR(answer.x[0], -1.0, 1e-10 / angle) << name << " " << angle;
      EXPECT_NEAR(answer.x[1], 2.0, 1e-10 / angle) << name << " " << angle;
    }
  }
}

// Degenerate faces and tolerances at the level of rounding errors: an end in any case.
TEST(HardProblems, active_sets_come_to_an_end) {
  std::mt19937 random(77);
  for (int k = 0; k < 30; ++k) {
    const BuiltQp built = builtQp(random, k % 2 == 0 ? 2 : 40, k % 3, 0, true);
    for (double tolerance : {1e-13, 1e-14, 3e-15}) {
      const Answer answer = solve("PDAS", built.qp, tolerance);
      EXPECT_TRUE(answer.result.converged() || answer.result.reason == Reason::Stagnation)
          << k << " " << answer.result.explanation;
      EXPECT_LE(distance(answer.x, built.x), 1e-9 * norm(built.x)) << k;
    }
  }
}

TEST(HardProblems, numbers_that_are_not_finite_are_no_answer) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const SmallQp good{diagonal({2, 1}), {3, 1}, {0, 0}, {5, 5}, rows({{1, 1}}), {2}};
  for (const std::string& name : withEqualities) {
    EXPECT_TRUE(solve(name, good).result.converged());
    for (double bad : {nan, inf, -inf}) {
      SmallQp qp = good;
      qp.a(0, 0) = bad;
      EXPECT_EQ(solve(name, qp).result.reason, Reason::Breakdown) << name << " A " << bad;
      qp = good;
      qp.b[1] = bad;
      EXPECT_EQ(solve(name, qp).result.reason, Reason::Breakdown) << name << " b " << bad;
      qp = good;
      qp.c(0, 1) = bad;
      EXPECT_EQ(solve(name, qp).result.reason, Reason::Breakdown) << name << " C " << bad;
      qp = good;
      qp.cRhs[0] = bad;
      const Answer answer = solve(name, qp);
      EXPECT_EQ(answer.result.reason, Reason::Breakdown) << name << " c " << bad;
      EXPECT_TRUE(contains(answer.result.explanation, "the right-hand side of the equalities"));
      EXPECT_EQ(solve(name, good, 1e-8, "", {bad, 0}).result.reason, Reason::Breakdown) << name << " x";
    }
  }
  // At a bound, where the sign of the gradient is looked at alone.
  const SmallQp held{diagonal({nan, 1}), {3, 1}, {0, 1}, {5, 1}, Dense(0, 2), {}};
  for (const char* name : {"MPRGP", "PDAS", "Auto"})
    EXPECT_EQ(solve(name, held).result.reason, Reason::Breakdown) << name;
}

// Large penalties and far starts: what is called converged has the gradient it says it has.
TEST(HardProblems, converged_is_converged_with_the_multiplier_returned) {
  std::mt19937 random(302);
  int converged = 0;
  for (int k = 0; k < 60; ++k) {
    const int equalities = k % 3;
    const SmallQp qp = randomQp(random, 6, equalities, k % 4 != 3, std::pow(10.0, 2.0 + k % 5));
    for (const char* rule : {"precision", "penalty", "both"})
      for (double start : {0.0, 1e6, 1e9}) {
        const double tolerance = 1e-9;
        const Answer answer = solve("Auto", qp, tolerance, rule, std::vector<double>(6, start));
        if (!answer.result.converged())
          continue;
        ++converged;
        const std::vector<double> g = lagrangianGradient(qp, answer.x, answer.mu);
        double sum = 0.0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          const bool atLower = !qp.lower.empty() && answer.x[i] <= qp.lower[i];
          const bool atUpper = !qp.upper.empty() && answer.x[i] >= qp.upper[i];
          const double entry = atLower ? std::min(g[i], 0.0) : atUpper ? std::max(g[i], 0.0) : g[i];
          sum += entry * entry;
        }
        // And the rounding errors of this evaluation itself.
        const double scale =
            std::pow(10.0, 2.0 + k % 5) * norm(answer.x) + norm(qp.b) + 3.0 * norm(answer.mu);
        EXPECT_LE(std::sqrt(sum), 1.2 * tolerance * norm(qp.b) + 20.0 * 2.2e-16 * scale)
            << k << " " << rule << " " << start;
      }
  }
  EXPECT_GT(converged, 250);
}

// Rows in any units: the default test looks at the distance, not at the rows' own residual.
TEST(HardProblems, rows_in_small_units_are_met) {
  for (double s : {1e-12, 1e-6, 1.0, 1e6}) {
    const SmallQp qp{diagonal({1, 1}), {1, 1}, {0, 0}, {}, rows({{s, s}}), {10 * s}};
    for (const std::string& name : withEqualities) {
      const Answer answer = solve(name, qp);
      ASSERT_TRUE(answer.result.converged()) << name << " " << s;
      EXPECT_NEAR(answer.x[0], 5.0, 1e-6) << name << " " << s;
    }
  }
}

TEST(HardProblems, kernels_are_used_as_they_are) {
  // b in the kernel alone, so that Ab is rounding errors.
  const SmallQp falls{diagonal({0, 1}), {1, 0}, {}, {}, Dense(0, 2), {}};
  EXPECT_EQ(solve("PCPG", falls, 1e-8, "", {}, {1, 0}).result.reason, Reason::Unbounded);
  // A row in small units stops the fall.
  for (double s : {1.0, 1e-9}) {
    const SmallQp stopped{diagonal({1, 0}), {1, 1}, {}, {}, rows({{0, s}}), {2 * s}};
    const Answer answer = solve("PCPG", stopped, 1e-8, "", {}, {0, 1});
    ASSERT_TRUE(answer.result.converged()) << s << " " << answer.result.explanation;
    EXPECT_NEAR(answer.x[1], 2.0, 1e-7) << s;
  }
  // Nothing to fall in: x₁ + x₂ = −1 in the orthant.
  const SmallQp both{diagonal({0, 0}), {1, -1}, {0, 0}, {}, rows({{1, 1}}), {-1}};
  EXPECT_EQ(solve("SMALBE", both, 1e-8, "", {}, {1, -1}).result.reason, Reason::Infeasible);
}

TEST(HardProblems, no_load_is_no_obstacle) {
  const SmallQp qp{diagonal({1, 2}), {0, 0}, {}, {}, rows({{1, 1}}), {3}};
  const Answer answer = solve("PCPG", qp);
  ASSERT_TRUE(answer.result.converged()) << answer.result.explanation;
  EXPECT_NEAR(answer.x[0], 2.0, 1e-7);
}

// A guess of which the rows leave nothing: what is left of it in rounding errors says nothing of whether they
// can be met.
TEST(HardProblems, a_guess_in_the_range_of_the_rows_is_no_obstacle) {
  const double third = 1.0 / 3.0;
  const SmallQp qp{diagonal({1, 2, 3}), {1, 0, -1}, {}, {}, rows({{third, third, third}}), {0}};
  for (double size : {1e-20, 1e-3, 1e20}) {
    const DistributedQp distributed(qp);
    distributed.problem->solution()->putScalar(0.1 * size);
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-10);
    const auto solver = TpetraSolverFactory().create("PCPG", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    ASSERT_TRUE(result.converged()) << size << " " << result.explanation;
    EXPECT_GT(result.counters.cgSteps, 0) << size;
  }
}

// A small eigenvalue is not a vanishing one, however large the penalty beside it.
TEST(HardProblems, penalties_do_not_hide_small_curvatures) {
  for (double smallest : {1e-6, 1e-8}) {
    SmallQp qp{diagonal({1, smallest, 1}), {1, smallest, 1}, {0, 0, 0}, {}, rows({{1, 0, 1}}), {2}};
    const DistributedQp distributed(qp);
    const auto list = Teuchos::parameterList();
    list->sublist("Expert").sublist("Dual Penalty").set("Penalty", 1e6);
    list->set("Convergence Tolerance", 1e-9);
    const auto solver = TpetraSolverFactory().create("Dual Penalty", list);
    solver->setProblem(distributed.problem);
    EXPECT_NE(solver->solve().reason, Reason::Unbounded) << smallest;
  }
}

// A preconditioner that does not see an entry cannot keep it from moving.
TEST(HardProblems, singular_preconditioners_do_not_break_the_method) {
  std::mt19937 random(303);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = randomQp(random, 6, 0, true, 100.0);
    const DistributedQp distributed(qp);
    Dense inverse = jacobi(qp.a);
    inverse(0, 0) = 0.0;
    distributed.precondition(inverse);
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-8);
    const auto solver = TpetraSolverFactory().create("MPRGP", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    ASSERT_TRUE(result.converged()) << k << " " << result.explanation;
    EXPECT_LE(distance(fromVector(*distributed.solution), bruteForce(qp)), 1e-5) << k;
  }
}

TEST(HardProblems, rows_that_are_not_orthonormal_are_not_believed_to_be) {
  const SmallQp qp{diagonal({1, 1, 1}), {1, 2, 3}, {}, {}, rows({{2, 2, 2}}), {1}};
  EXPECT_TRUE(
      contains(inputErrorOf([&] { solve("PCPG", qp, 1e-8, "", {}, {}, EqualityStructure::Orthonormal); }),
               "declared orthonormal but are not"));
}

// Bounds may change in place after setProblem(), as contact gaps do from step to step.
TEST(HardProblems, bounds_changed_in_place_are_seen) {
  const SmallQp qp{diagonal({1, 1}), {1, 1}, {0, 0}, {1, 1}, Dense(0, 2), {}};
  const DistributedQp distributed(qp);
  const auto solver = TpetraSolverFactory().create("MPRGP", Teuchos::null);
  solver->setProblem(distributed.problem);
  EXPECT_TRUE(solver->solve().converged());
  Teuchos::rcp_const_cast<MultiVector>(distributed.problem->lowerBound())->putScalar(2.0);
  EXPECT_EQ(solver->solve().reason, Reason::Infeasible);
}

// Rows that are too many to be orthonormalised, in other units than x.
TEST(HardProblems, rows_used_as_they_stand_converge_in_any_units) {
  std::mt19937 random(304);
  for (double s : {1e-4, 1.0, 1e4}) {
    SmallQp qp = randomQp(random, 6, 2, true, 10.0);
    for (double& value : qp.c.values)
      value *= s;
    for (double& value : qp.cRhs)
      value *= s;
    const DistributedQp distributed(qp);
    const auto list = Teuchos::parameterList();
    list->sublist("Expert").set("Orthonormalised Rows", 0);
    list->set("Convergence Tolerance", 1e-8);
    const auto solver = TpetraSolverFactory().create("SMALBE", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    ASSERT_TRUE(result.converged()) << s << " " << result.explanation;
    EXPECT_LE(distance(fromVector(*distributed.solution), bruteForce(qp)), 1e-5) << s;
  }
}

// A test is reset when the solver begins, not when another takes over: what it remembers stays.
TEST(HardProblems, tests_go_on_through_a_change_of_solvers) {
  class Resets : public StatusTestProjectedGradient<MultiVector> {
   public:
    using StatusTestProjectedGradient<MultiVector>::StatusTestProjectedGradient;
    void reset() override {
      StatusTestProjectedGradient<MultiVector>::reset();
      ++resets;
    }
    int resets = 0;
  };
  std::mt19937 random(306);
  const SmallQp qp = randomQp(random, 7, 2, true, 1e4);
  const DistributedQp distributed(qp);
  const auto list = Teuchos::parameterList();
  list->sublist("Expert").sublist("PDAS").set("Maximum active sets", 1);
  const auto solver = TpetraSolverFactory().create("PDAS", list);
  const auto test = Teuchos::rcp(new Resets(1e-8, norm(qp.b)));
  solver->setConvergenceTest(test);
  solver->setProblem(distributed.problem);
  EXPECT_EQ(solver->solve().counters.safeguards, 1);
  EXPECT_EQ(test->resets, 1);
}

// "All inner iterations so far", also after another solver has taken over.
TEST(HardProblems, iterations_are_counted_through_a_change_of_solvers) {
  std::mt19937 random(305);
  int fallbacks = 0;
  for (int k = 0; k < 60; ++k) {
    const SmallQp qp = randomQp(random, 7, 2, true, 1e4);
    const DistributedQp distributed(qp);
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-10);
    list->sublist("Expert").sublist("PDAS").set("Maximum active sets", 1);
    const auto solver = TpetraSolverFactory().create("PDAS", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    fallbacks += result.counters.safeguards;
    for (std::size_t i = 1; i < result.history.size(); ++i)
      ASSERT_LE(std::abs(result.history[i].inner - result.history[i - 1].inner), 1) << k;
    for (std::size_t i = 1; i < result.history.size(); ++i)
      ASSERT_GE(result.history[i].inner, result.history[i - 1].inner) << k;
  }
  EXPECT_GT(fallbacks, 20);
}

} // namespace test_hard_problems
