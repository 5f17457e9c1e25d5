// SPDX-License-Identifier: BSD-3-Clause

/// Random small quadratic programs against the enumeration of all active sets.

#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace test_solvers {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double length(const std::vector<double>& a) {
  return distance(a, std::vector<double>(a.size(), 0.0));
}

Result solve(const std::string& name, const DistributedQp& qp,
             const Teuchos::RCP<Teuchos::ParameterList>& list,
             const Teuchos::RCP<StatusTest<MultiVector>>& test = Teuchos::null) {
  const auto solver = TpetraSolverFactory().create(name, list);
  solver->setConvergenceTest(test);
  solver->setProblem(qp.problem);
  return solver->solve();
}

Teuchos::RCP<Teuchos::ParameterList> parameters(double tolerance) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  return list;
}

constexpr double condition = 100.0;
constexpr double tolerance = 1e-11;
// ‖x − x*‖ ≤ ‖g^P‖/λ_min for bounds alone (λ_min = 1, ‖b‖ ≤ 10 √8 < 30); equality residuals enter multiplied
// by at most κ ‖C⁺‖. Ten times the solver tolerance on these scales:
constexpr double accuracy = 10.0 * tolerance * 30.0 * condition;

// Records the cost at each iterate.
class CostProbe : public StatusTest<MultiVector> {
 public:
  CostProbe(const SmallQp& qp, double limit) : qp_(qp), limit_(limit) {}
  Status checkStatus(const IterationState<MultiVector>& state) override {
    costs.push_back(qp_.cost(fromVector(*state.x)));
    for (std::size_t i = 0; i < qp_.lower.size(); ++i)
      feasible =
          feasible && fromVector(*state.x)[i] >= qp_.lower[i] && fromVector(*state.x)[i] <= qp_.upper[i];
    return state.projectedGradient <= limit_ ? Status::Passed : Status::Failed;
  }
  Status getStatus() const override { return Status::Undefined; }
  void reset() override {}
  void print(std::ostream&, int) const override {}
  std::vector<double> costs;
  bool feasible = true;

 private:
  const SmallQp& qp_;
  double limit_;
};

} // namespace

TEST(Solvers, mprgp_agrees_with_enumeration) {
  std::mt19937 random(11);
  for (int k = 0; k < 60; ++k) {
    const SmallQp qp = randomQp(random, 1 + k % 7, 0, true, condition);
    for (const char* expansion : {"projected conjugate gradient", "fixed step"}) {
      const DistributedQp distributed(qp);
      const auto list = parameters(tolerance);
      list->sublist("Expert").sublist("MPRGP").set("Expansion", std::string(expansion));
      const Result result = solve("MPRGP", distributed, list);
      ASSERT_TRUE(result.converged()) << k << " " << result.explanation;
      EXPECT_LE(distance(fromVector(*distributed.solution), bruteForce(qp)), accuracy)
          << k << " " << expansion;
    }
  }
}

// The cost falls at every step of every variant, iterates stay feasible, and the steps add up to the
// applications.
TEST(Solvers, mprgp_cost_never_rises) {
  std::mt19937 random(12);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = randomQp(random, 7, 0, true, 1e4);
    for (const char* expansion : {"projected conjugate gradient", "fixed step"}) {
      const DistributedQp distributed(qp);
      const auto list = parameters(1e-10);
      list->sublist("Expert").sublist("MPRGP").set("Expansion", std::string(expansion));
      const auto probe = Teuchos::rcp(new CostProbe(qp, 1e-8));
      const Result result = solve("MPRGP", distributed, list, probe);
      ASSERT_TRUE(result.converged());
      EXPECT_TRUE(probe->feasible);
      for (std::size_t i = 1; i < probe->costs.size(); ++i)
        // Rounding in the evaluation of the cost itself: a few ε times its terms, which are below 1e5.
        EXPECT_LE(probe->costs[i], probe->costs[i - 1] + 1e-10) << k << " step " << i;
      const Counters& c = result.counters;
      EXPECT_EQ(c.cgSteps + c.expansionSteps + c.proportioningSteps,
                static_cast<int>(result.history.size()) - 1);
      // A product each, one more for an expansion, one more for a fallback or a cut of it, one for a start ≠
      // 0.
      const int expected = c.cgSteps + 2 * c.expansionSteps + c.proportioningSteps + c.fallbacks +
                           c.stepCuts + c.confirmations;
      EXPECT_GE(c.hessianApplications, expected);
      EXPECT_LE(c.hessianApplications, expected + 1);
    }
  }
}

// A norm given far too small makes the fixed step too long: it must be noticed, cut and survived.
TEST(Solvers, mprgp_corrects_a_norm_that_is_too_small) {
  std::mt19937 random(13);
  int cuts = 0;
  for (int k = 0; k < 20; ++k) {
    const SmallQp qp = randomQp(random, 7, 0, true, condition);
    const DistributedQp distributed(qp);
    distributed.problem->setHessianNorm(0.01);
    distributed.problem->setProblem();
    const auto list = parameters(tolerance);
    list->sublist("Expert").sublist("MPRGP").set("Expansion", std::string("fixed step"));
    const Result result = solve("MPRGP", distributed, list);
    ASSERT_TRUE(result.converged());
    EXPECT_LE(distance(fromVector(*distributed.solution), bruteForce(qp)), accuracy);
    cuts += result.counters.stepCuts;
  }
  // Curvatures met along the search directions correct most of the error before a fixed step is made, but not
  // all.
  EXPECT_GT(cuts, 0);
}

TEST(Solvers, smalbe_agrees_with_enumeration_in_both_rules) {
  std::mt19937 random(14);
  for (int k = 0; k < 40; ++k) {
    const int n = 3 + k % 5;
    const SmallQp qp = randomQp(random, n, 1 + k % 2, true, condition);
    std::vector<double> multipliers;
    const std::vector<double> expected = bruteForce(qp, &multipliers);
    ASSERT_FALSE(expected.empty());
    for (const char* rule : {"precision", "penalty"}) {
      const DistributedQp distributed(qp);
      const auto list = parameters(tolerance);
      list->sublist("Expert").sublist("SMALBE").set("Update rule", std::string(rule));
      const Result result = solve("SMALBE", distributed, list);
      ASSERT_TRUE(result.converged()) << k << " " << rule << " " << result.explanation;
      EXPECT_LE(distance(fromVector(*distributed.solution), expected), accuracy) << k << " " << rule;
      // With more active bounds than free entries the multipliers are not unique; then only x is compared.
      int free = 0;
      for (int i = 0; i < n; ++i)
        free += expected[static_cast<std::size_t>(i)] > qp.lower[static_cast<std::size_t>(i)] + 1e-6 &&
                expected[static_cast<std::size_t>(i)] < qp.upper[static_cast<std::size_t>(i)] - 1e-6;
      if (free > qp.c.rows)
        EXPECT_LE(distance(fromVector(*distributed.multiplier), multipliers),
                  1e-6 * (1.0 + length(multipliers)))
            << k << " " << rule;
    }
  }
}

// Algorithm 4.1: ρ grows by β only where ‖Cx − c‖ > η_k. With η₀ = ∞ (large) and α → 1 it never may.
TEST(Solvers, penalty_rule_keeps_the_penalty_while_feasibility_keeps_up) {
  std::mt19937 random(15);
  const SmallQp qp = randomQp(random, 6, 2, true, condition);
  const auto run = [&](double equalityTolerance) {
    const DistributedQp distributed(qp);
    const auto list = parameters(1e-8);
    Teuchos::ParameterList& smalbe = list->sublist("Expert").sublist("SMALBE");
    smalbe.set("Update rule", std::string("penalty"));
    smalbe.set("Parameter scaling", std::string("absolute"));
    smalbe.set("Initial penalty", 10.0);
    smalbe.set("Equality tolerance", equalityTolerance);
    smalbe.set("Tolerance factor", 0.999);
    smalbe.set("Slow iterations", 1000000); // Algorithm 4.1 and nothing else
    const Result result = solve("SMALBE", distributed, list);
    EXPECT_TRUE(result.converged());
    return result.penalty;
  };
  EXPECT_EQ(run(1e6), 10.0);
  // η far below any residual: each outer iteration but the last multiplies ρ by 10.
  EXPECT_GT(run(1e-30), 10.0);
}

TEST(Solvers, dual_penalty_error_falls_like_one_over_rho) {
  std::mt19937 random(16);
  for (int k = 0; k < 20; ++k) {
    const SmallQp qp = randomQp(random, 6, 2, true, condition);
    const std::vector<double> expected = bruteForce(qp);
    std::vector<double> residuals;
    for (double penalty : {1e2, 1e3, 1e4}) {
      const DistributedQp distributed(qp);
      // Rounding errors of the gradient are ε ρ‖A‖‖x‖ < 1e-9 at the largest penalty, a part 1e-10 of ‖b‖.
      const auto list = parameters(1e-9);
      list->sublist("Expert").sublist("Dual Penalty").set("Penalty", penalty);
      const Result result = solve("Dual Penalty", distributed, list);
      ASSERT_TRUE(result.converged()) << result.explanation;
      residuals.push_back(result.equalityNorm);
    }
    if (residuals[0] > 1e-3) { // else the equalities nearly hold by themselves, and the last one is rounding
      // ‖Cx − c‖ρ tends to a constant; at ρ = 100‖A‖ and more it is within a few per cent of it.
      EXPECT_NEAR(residuals[0] / residuals[1], 10.0, 1.0) << k;
      EXPECT_NEAR(residuals[1] / residuals[2], 10.0, 1.0) << k;
    }
  }
}

TEST(Solvers, pcpg_agrees_with_the_direct_solution) {
  std::mt19937 random(17);
  for (int k = 0; k < 40; ++k) {
    SmallQp qp = randomQp(random, 2 + k % 6, k % 2, false, condition);
    orthonormalizeRows(qp);
    std::vector<double> multipliers;
    const std::vector<double> expected = bruteForce(qp, &multipliers);
    const DistributedQp distributed(qp, EqualityStructure::Orthonormal);
    const Result result = solve("PCPG", distributed, parameters(tolerance));
    ASSERT_TRUE(result.converged()) << k << " " << result.explanation;
    EXPECT_LE(distance(fromVector(*distributed.solution), expected), accuracy) << k;
    // Finite termination up to rounding: with κ = 100 a few steps more than the dimension at most.
    EXPECT_LE(result.counters.cgSteps, 2 * qp.size() + 2);
    if (qp.c.rows > 0)
      EXPECT_LE(distance(fromVector(*distributed.multiplier), multipliers), accuracy * condition) << k;
  }
}

// Fixed: ‖A‖ of a matrix with known spectrum; the estimate lies in [‖A‖, 1.2‖A‖].
TEST(Solvers, norm_estimate_brackets_the_norm) {
  std::mt19937 random(18);
  for (int k = 0; k < 30; ++k) {
    const SmallQp qp = randomQp(random, 8, 0, true, 1000.0);
    const DistributedQp distributed(qp);
    const Result result = solve("MPRGP", distributed, parameters(1e-6));
    EXPECT_GE(result.hessianNorm, 1000.0 * (1.0 - 1e-12)) << k;
    EXPECT_LE(result.hessianNorm, 1200.0) << k;
    EXPECT_GE(result.counters.setupApplications, 1);
  }
}

TEST(Solvers, history_is_complete_and_written_with_a_header) {
  std::mt19937 random(20);
  const SmallQp qp = randomQp(random, 6, 1, true, condition);
  const DistributedQp distributed(qp);
  const Result result = solve("SMALBE", distributed, parameters(1e-8));
  ASSERT_FALSE(result.history.empty());
  EXPECT_EQ(result.history.front().step, StepKind::Start);
  EXPECT_EQ(result.history.back().outer, result.counters.outerIterations);
  for (std::size_t k = 1; k < result.history.size(); ++k)
    EXPECT_EQ(result.history[k].inner, result.history[k - 1].inner + 1);
  std::ostringstream text;
  writeHistory(text, result.history);
  EXPECT_EQ(text.str().find("outer,inner,step,projected_gradient,equality_residual,penalty,M,active,"
                            "hessian_applications,seconds\n1,0,start,"),
            0u);
}

} // namespace test_solvers
