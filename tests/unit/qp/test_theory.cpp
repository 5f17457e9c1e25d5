// SPDX-License-Identifier: BSD-3-Clause

/// What the theory promises of the solvers: the rate of MPRGP, costs that never rise, independence of units,
/// tolerances that are met or honestly not met.

#include "Harmos_InteriorPoint.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_theory {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

Teuchos::RCP<Teuchos::ParameterList> parameters(double tolerance) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  return list;
}

Result solve(const std::string& name, const DistributedQp& qp,
             const Teuchos::RCP<Teuchos::ParameterList>& list,
             const Teuchos::RCP<StatusTest<MultiVector>>& debug = Teuchos::null) {
  const auto solver = TpetraSolverFactory().create(name, list);
  solver->setDebugStatusTest(debug);
  solver->setProblem(qp.problem);
  return solver->solve();
}

// The cost at each iterate, evaluated here.
class CostProbe : public StatusTest<MultiVector> {
 public:
  explicit CostProbe(const SmallQp& qp) : qp_(qp) {}
  Status checkStatus(const IterationState<MultiVector>& state) override {
    costs.push_back(qp_.cost(fromVector(*state.x)));
    return Status::Failed;
  }
  Status getStatus() const override { return Status::Undefined; }
  void reset() override {}
  void print(std::ostream&, int) const override {}
  std::vector<double> costs;

 private:
  const SmallQp& qp_;
};

// g^P(x, μ) in the test's own terms.
double projectedGradient(const SmallQp& qp, const std::vector<double>& x, const std::vector<double>& mu) {
  const std::vector<double> g = lagrangianGradient(qp, x, mu);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool atLower = !qp.lower.empty() && x[i] <= qp.lower[i];
    const bool atUpper = !qp.upper.empty() && x[i] >= qp.upper[i];
    const double entry = atLower && atUpper ? 0.0
                         : atLower          ? std::min(g[i], 0.0)
                         : atUpper          ? std::max(g[i], 0.0)
                                            : g[i];
    sum += entry * entry;
  }
  return std::sqrt(sum);
}

} // namespace

// f(x_{k+1}) − f* ≤ η(f(x_k) − f*), η = 1 − α̂λ_min/(ϑ + ϑΓ̂²) with the true spectrum [1, κ] (Dostál & Schöberl
// 2005; Dostál 2009 for ᾱ > 1/‖A‖).
namespace {

void expectProvenDecrease(bool withDiscs) {
  std::mt19937 random(201);
  int steps = 0;
  double sharpest = 0.0; // largest part of the bound that was used up
  for (int k = 0; k < (withDiscs ? 40 : 60); ++k) {
    const double condition = k % 2 == 0 ? 10.0 : withDiscs ? 100.0 : 1000.0;
    const SmallQp qp = withDiscs ? randomFrictionQp(random, 4 + k % 5, 0, condition)
                                 : randomQp(random, 4 + k % 5, 0, true, condition);
    const double best = qp.cost(withDiscs ? interiorPoint(qp) : bruteForce(qp));
    for (double factor : {0.5, 1.0, 1.5, 1.95})
      for (double gamma : {0.5, 1.0, 2.0}) {
        const DistributedQp distributed(qp);
        distributed.problem->setHessianNorm(condition);
        distributed.problem->setProblem();
        const auto list = parameters(1e-9);
        Teuchos::ParameterList& mprgp = list->sublist("Expert").sublist("MPRGP");
        mprgp.set("Expansion", std::string("fixed step"));
        mprgp.set("Step factor", factor);
        mprgp.set("Gamma", gamma);
        const auto probe = Teuchos::rcp(new CostProbe(qp));
        const Result result = solve("MPRGP", distributed, list, probe);
        ASSERT_TRUE(result.converged());
        ASSERT_EQ(result.counters.stepCuts, 0);
        const double gammaHat = std::max(gamma, 1.0 / gamma);
        const double alphaHat = std::min(factor, 2.0 - factor) / condition,
                     theta = 2.0 * std::max(factor, 1.0);
        const double eta = 1.0 - alphaHat / (theta * (1.0 + gammaHat * gammaHat));
        for (std::size_t i = 1; i < probe->costs.size(); ++i) {
          const double before = probe->costs[i - 1] - best, after = probe->costs[i] - best;
          // Rounding errors of the costs themselves: ε times terms below 1e4.
          EXPECT_LE(after, eta * before + 1e-11) << k << " " << factor << " " << gamma << " step " << i;
          if (before > 1e-8)
            sharpest = std::max(sharpest, after / (eta * before));
          ++steps;
        }
      }
  }
  EXPECT_GT(steps, 2000);
  // The bound is not so loose that anything would pass it.
  EXPECT_GT(sharpest, 0.9);
}

} // namespace

TEST(Theory, every_step_of_mprgp_makes_the_proven_decrease) {
  expectProvenDecrease(false);
}

// The same bound: Dostál, Kozubek 2012.
TEST(Theory, so_does_every_step_on_discs) {
  expectProvenDecrease(true);
}

TEST(Theory, cost_never_rises_in_any_variant) {
  std::mt19937 random(202);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = randomQp(random, 7, 0, true, 1e4);
    for (const char* expansion : {"projected conjugate gradient", "fixed step"})
      for (const bool preconditioned : {false, true}) {
        const DistributedQp distributed(qp);
        if (preconditioned)
          distributed.precondition(jacobi(qp.a));
        const auto list = parameters(1e-9);
        list->sublist("Expert").sublist("MPRGP").set("Expansion", std::string(expansion));
        const auto probe = Teuchos::rcp(new CostProbe(qp));
        const Result result = solve("MPRGP", distributed, list, probe);
        ASSERT_TRUE(result.converged()) << result.explanation;
        for (std::size_t i = 1; i < probe->costs.size(); ++i)
          // Rounding in the evaluation of the cost: a few ε times its terms, which are below 1e5.
          EXPECT_LE(probe->costs[i], probe->costs[i - 1] + 1e-10) << k << " step " << i;
        // What the solver says of each step is what the costs say.
        double sum = 0.0;
        for (std::size_t i = 1; i < result.history.size(); ++i)
          sum += result.history[i].decrease;
        EXPECT_NEAR(sum, probe->costs.front() - probe->costs.back(), 1e-9 * (1.0 + std::abs(sum)));
      }
  }
}

// A preconditioner that is the inverse on the face makes one step of each face; one that is no preconditioner
// at all does no harm to the answer.
TEST(Theory, preconditioners_change_the_way_but_not_the_answer) {
  class FaceInverse : public TpetraFacePreconditioner {
   public:
    FaceInverse(const Dense& a, const Teuchos::RCP<const Map>& map) : a_(a), map_(map) {}
    Teuchos::RCP<const Operator> build(const MultiVector& free) override {
      const std::vector<double> mask = fromVector(free);
      const int n = a_.rows;
      Dense face(n, n), inverse(n, n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          face(i, j) = i == j && mask[static_cast<std::size_t>(i)] == 0.0
                           ? 1.0
                           : a_(i, j) * mask[static_cast<std::size_t>(i)] * mask[static_cast<std::size_t>(j)];
      for (int j = 0; j < n; ++j) {
        std::vector<double> e(static_cast<std::size_t>(n), 0.0);
        e[static_cast<std::size_t>(j)] = 1.0;
        const std::vector<double> column = solveDense(face, e);
        for (int i = 0; i < n; ++i)
          inverse(i, j) = column[static_cast<std::size_t>(i)];
      }
      ++built;
      return Teuchos::rcp(new DenseOperator(inverse, map_, map_));
    }
    int built = 0;

   private:
    Dense a_;
    Teuchos::RCP<const Map> map_;
  };
  std::mt19937 random(203);
  for (int k = 0; k < 60; ++k) {
    const int rows = k % 3;
    const SmallQp qp = randomQp(random, 8, rows, true, 1e3);
    const std::vector<double> expected = bruteForce(qp);
    for (const std::string& name : {std::string("PDAS"), std::string(rows > 0 ? "SMALBE" : "MPRGP")})
      for (int form = 0; form < 3; ++form) {
        const DistributedQp distributed(qp);
        Dense inverse = jacobi(qp.a);
        if (form == 2) // of no use, indefinite even
          for (int i = 0; i < 8; ++i)
            inverse(i, i) = i % 2 == 0 ? 1.0 : -1.0;
        const auto face = Teuchos::rcp(new FaceInverse(qp.a, distributed.map));
        if (form == 0) {
          distributed.problem->setFacePreconditioner(face);
          ASSERT_TRUE(distributed.problem->setProblem());
        } else {
          distributed.precondition(inverse);
        }
        if (form == 2 && name != "MPRGP")
          continue; // the others say that they need a positive definite one
        const Result result = solve(name, distributed, parameters(1e-10));
        const std::string what = name + " " + std::to_string(k) + " " + std::to_string(form);
        ASSERT_TRUE(result.converged()) << what << ": " << result.explanation;
        // κ times the tolerance times ‖b‖/‖A‖.
        EXPECT_LE(distance(fromVector(*distributed.solution), expected), 1e-5) << what;
        if (form == 0) {
          EXPECT_EQ(result.counters.preconditionerSetups, face->built) << what;
          EXPECT_GE(face->built, 1) << what;
        }
        if (form == 0 && name == "MPRGP") {
          // In a face: the step to its minimiser, and one more where rounding wants it.
          EXPECT_LE(result.counters.cgSteps, 2 * face->built + 1) << what;
        }
      }
  }
}

// Counts must not depend on units: A → sA, b → tb, bounds and c → t/s of them.
TEST(Theory, counts_do_not_depend_on_scales) {
  std::mt19937 random(204);
  const auto scaledQp = [](const SmallQp& qp, double s, double t) {
    SmallQp scaled = qp;
    for (double& value : scaled.a.values)
      value *= s;
    for (double& value : scaled.b)
      value *= t;
    for (auto* values : {&scaled.lower, &scaled.upper, &scaled.cRhs})
      for (double& value : *values)
        value *= t / s;
    return scaled;
  };
  for (int k = 0; k < 24; ++k) {
    const bool bounds = k % 4 != 3, equalities = k % 2 == 1, preconditioned = k % 3 == 2;
    const SmallQp qp = randomQp(random, 7, equalities ? 1 + k % 2 : 0, bounds, 100.0);
    std::vector<std::string> names = {"Auto"};
    if (bounds)
      names.insert(names.end(), {"PDAS", equalities ? "SMALBE" : "MPRGP"});
    if (bounds && equalities)
      names.push_back("Dual Penalty");
    for (const std::string& name : names) {
      const auto count = [&](double s, double t) {
        const SmallQp scaled = scaledQp(qp, s, t);
        const DistributedQp distributed(scaled);
        if (preconditioned)
          distributed.precondition(jacobi(scaled.a));
        const auto list = parameters(1e-6);
        // With the default penalty, κ = 1e6, a last bit is worth a step.
        if (name == "Dual Penalty")
          list->sublist(name).set("Penalty", 100.0);
        const Result result = solve(name, distributed, list);
        EXPECT_TRUE(result.converged()) << name << " " << k << " " << result.explanation;
        return result.counters.hessianApplications;
      };
      const int reference = count(1.0, 1.0);
      for (double s : {1.0, 1e-9, 1e9})
        for (double t : {1.0, 1e-9, 1e9})
          EXPECT_NEAR(count(s, t), reference, 1) << name << " " << k << ": " << s << ", " << t;
      // Powers of two commute with rounding: not even a last bit differs.
      for (double s : {0x1p-30, 0x1p30})
        for (double t : {0x1p-30, 0x1p30})
          EXPECT_EQ(count(s, t), reference) << name << " " << k << ": " << s << ", " << t;
    }
  }
}

// Met, by a residual computed here, or "stagnation" at the level of rounding errors: nothing in between.
TEST(Theory, tolerances_are_met_or_stagnation_is_told) {
  std::mt19937 random(205);
  constexpr double condition = 1e4, epsilon = std::numeric_limits<double>::epsilon();
  int stagnations = 0;
  for (int k = 0; k < 24; ++k) {
    const int rows = k % 3;
    const SmallQp qp = randomQp(random, 8, rows, k % 4 != 3, condition);
    const bool bounds = k % 4 != 3;
    std::vector<std::string> names = {"Auto"};
    if (bounds)
      names.insert(names.end(), {"PDAS", rows > 0 ? "SMALBE" : "MPRGP"});
    for (const std::string& name : names)
      for (double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16}) {
        const DistributedQp distributed(qp);
        const Result result = solve(name, distributed, parameters(tolerance));
        const std::string what = name + " " + std::to_string(k) + " " + std::to_string(tolerance);
        const std::vector<double> x = fromVector(*distributed.solution);
        const std::vector<double> mu = rows > 0 ? fromVector(*distributed.multiplier) : std::vector<double>();
        const double reached = projectedGradient(qp, x, mu);
        // Rounding errors of this evaluation: a few ε of its terms, the multipliers' included.
        const double level = epsilon * (condition * norm(x) + norm(qp.b) + 3.0 * norm(mu));
        if (result.converged()) {
          EXPECT_LE(reached, tolerance * norm(qp.b) + 10.0 * level) << what;
          // ‖Cx − c‖ is at most ‖C‖ times the distance from the equalities, which is at most tol‖x‖.
          EXPECT_LE(norm(equalityResidual(qp, x)), (tolerance + 10.0 * epsilon) * norm(qp.c.values) * norm(x))
              << what;
          continue;
        }
        ASSERT_EQ(result.reason, Reason::Stagnation) << what << ": " << result.explanation;
        ++stagnations;
        // Only where the tolerance is out of reach, and close to what can be reached: κε relative to ‖b‖,
        // with the penalty's thousand at most on top.
        EXPECT_LE(tolerance, 1e-10) << what;
        EXPECT_LE(reached, 1e3 * level + condition * epsilon * norm(qp.b)) << what;
        EXPECT_NE(result.explanation.find("at the level of rounding errors"), std::string::npos);
      }
  }
  EXPECT_GT(stagnations, 20);
}

// Rows scaled by any factors do not slow the solvers down; a last bit can turn a decision, hence half as much
// again.
TEST(Theory, counts_do_not_depend_on_the_scaling_of_rows) {
  std::mt19937 random(206);
  for (int k = 0; k < 20; ++k) {
    const SmallQp qp = randomQp(random, 7, 2, true, 100.0);
    SmallQp scaled = qp;
    for (int i = 0; i < 7; ++i) {
      scaled.c(0, i) *= 1e-6;
      scaled.c(1, i) *= 1e3;
    }
    scaled.cRhs[0] *= 1e-6;
    scaled.cRhs[1] *= 1e3;
    for (const char* name : {"SMALBE", "PDAS"}) {
      const auto count = [&](const SmallQp& problem) {
        const DistributedQp distributed(problem);
        // Judged by the gradient alone: the residual of the rows is measured in the rows' own units.
        const auto solver = TpetraSolverFactory().create(name, parameters(1e-8));
        solver->setConvergenceTest(
            Teuchos::rcp(new StatusTestProjectedGradient<MultiVector>(1e-8, norm(problem.b))));
        solver->setProblem(distributed.problem);
        const Result result = solver->solve();
        EXPECT_TRUE(result.converged()) << result.explanation;
        return result.counters.hessianApplications;
      };
      EXPECT_LE(count(scaled), count(qp) * 3 / 2 + 1) << name << " " << k;
    }
  }
}

} // namespace test_theory
