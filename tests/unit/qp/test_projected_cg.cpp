// SPDX-License-Identifier: BSD-3-Clause

/// Conjugate gradients on ill-conditioned problems: full conjugation keeps the number of steps below the
/// dimension, which the short recurrence does not.

#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>

using namespace Harmos;
using namespace Harmos::qp;

namespace {

constexpr int n = 100, equalities = 5;
constexpr double condition = 1e6;
// Above rounding errors, εκ = 2e-10 relative to x, and so deep that all eigenvalues count.
constexpr double tolerance = 1e-9;

// Eigenvalues in geometric progression: extreme Ritz values converge early, which costs conjugacy.
SmallQp illConditioned(bool bounds) {
  std::mt19937 random(71);
  SmallQp qp = randomQp(random, n, equalities, false, condition);
  orthonormalizeRows(qp);
  if (bounds) {
    qp.lower.assign(n, -infinity);
    std::fill_n(qp.lower.begin(), 10, -0.1);
  }
  return qp;
}

struct Outcome {
  Result result;
  std::vector<double> x;
};

Outcome solved(const SmallQp& qp, const std::string& conjugation, int stored = 500) {
  const DistributedQp distributed(qp, EqualityStructure::Orthonormal);
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->sublist("PCPG").set("Reorthogonalisation", conjugation).set("Stored directions", stored);
  const auto solver = TpetraSolverFactory().create(qp.lower.empty() ? "PCPG" : "PDAS", list);
  solver->setProblem(distributed.problem);
  Outcome outcome{solver->solve(), fromVector(*distributed.solution)};
  EXPECT_TRUE(outcome.result.converged()) << conjugation << ": " << outcome.result.explanation;
  return outcome;
}

} // namespace

TEST(ProjectedCg, full_conjugation_stops_within_the_dimension) {
  const SmallQp qp = illConditioned(false);
  const Outcome none = solved(qp, "none"), full = solved(qp, "full"), found = solved(qp, "auto");
  EXPECT_GT(none.result.counters.cgSteps, 2 * n);
  EXPECT_LE(full.result.counters.cgSteps, n - equalities);
  // The store may have begun again once.
  EXPECT_LE(found.result.counters.cgSteps, n - equalities + 20);
  // ‖x − x'‖ ≤ ‖w − w'‖/λ_min, λ_min = 1.
  const double accuracy = 10.0 * tolerance * norm(qp.b);
  EXPECT_LE(distance(none.x, full.x), accuracy);
  EXPECT_LE(distance(found.x, full.x), accuracy);
}

// The early directions span the Ritz vectors that come back: a short store is better than none, a longer one
// better than a short one.
TEST(ProjectedCg, a_full_store_goes_on_to_be_of_use) {
  const SmallQp qp = illConditioned(false);
  const int none = solved(qp, "none").result.counters.cgSteps;
  const int few = solved(qp, "full", 20).result.counters.cgSteps,
            more = solved(qp, "full", 60).result.counters.cgSteps;
  EXPECT_LT(few, none);
  EXPECT_LT(more, few);
}

// What costs nothing where it is not needed: no step differs in a bit.
TEST(ProjectedCg, well_conditioned_problems_are_left_alone) {
  std::mt19937 random(72);
  SmallQp qp = randomQp(random, n, equalities, false, 4.0);
  orthonormalizeRows(qp);
  const Outcome none = solved(qp, "none"), found = solved(qp, "auto");
  EXPECT_EQ(none.result.counters.cgSteps, found.result.counters.cgSteps);
  EXPECT_EQ(none.x, found.x);
}

TEST(ProjectedCg, faces_of_active_sets_profit) {
  const SmallQp qp = illConditioned(true);
  const Outcome none = solved(qp, "none"), found = solved(qp, "auto");
  EXPECT_LT(2 * found.result.counters.cgSteps, none.result.counters.cgSteps);
  EXPECT_LE(distance(found.x, none.x), 10.0 * tolerance * norm(qp.b));
}
