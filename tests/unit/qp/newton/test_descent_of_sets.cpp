// SPDX-License-Identifier: BSD-3-Clause

/// Active sets that descend: from whatever a face has led to, the next one begins feasible and lower.

#include "Harmos_DescentOfSets.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FaceSolver_def.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_descent_of_sets {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using Rows = EqualityRows<Scalar, MultiVector, Operator>;
using Cg = FaceSolver<Scalar, MultiVector, Operator>;
using Descent = DescentOfSets<Scalar, MultiVector, Operator>;
using Nearest = NearestFeasible<Scalar, MultiVector, Operator>;

double cost(const SmallQp& qp, const std::vector<double>& x) {
  const std::vector<double> ax = product(qp.a, x);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += x[i] * (0.5 * ax[i] - qp.b[i]);
  return sum;
}

double violation(const SmallQp& qp, const std::vector<double>& x) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!qp.lower.empty())
      largest = std::max(largest, qp.lower[i] - x[i]);
    if (!qp.upper.empty())
      largest = std::max(largest, x[i] - qp.upper[i]);
  }
  for (double r : equalityResidual(qp, x))
    largest = std::max(largest, std::abs(r));
  return largest;
}

SmallQp sample(std::mt19937& random, int n, int equalities, double condition) {
  SmallQp qp = randomQp(random, n, equalities, true, condition);
  if (equalities > 0)
    orthonormalizeRows(qp);
  return qp;
}

Result solved(const DistributedQp& distributed, int patience, double tolerance) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  // Faces are followed as far as they are to be from the start: what is left is to descend.
  list->sublist("Expert")
      .sublist("PDAS")
      .set("Active sets without progress", patience)
      .set("Inner reduction", 0.04);
  const auto solver = TpetraSolverFactory().create("PDAS", list);
  solver->setProblem(distributed.problem);
  return solver->solve();
}

} // namespace

// The definition: min ½‖x − z‖² on the feasible set, by brute force.
TEST(DescentOfSets, nearest_feasible_point_is_the_projection) {
  std::mt19937 random(11);
  for (int k = 0; k < 40; ++k) {
    SmallQp qp = sample(random, 8, k % 3, 10.0);
    qp.a = Dense(8, 8);
    for (int i = 0; i < 8; ++i)
      qp.a(i, i) = 1.0;
    const DistributedQp distributed(qp);
    ASSERT_TRUE(distributed.problem->setProblem());
    const Rows rows(*distributed.problem, 100);
    Nearest nearest(*distributed.problem, rows);
    ActiveFace set(distributed.solution->getLocalLength(), 0);
    long long active = 0;
    ASSERT_EQ(nearest.find(*distributed.problem->rhs(), 50, set, active), Nearest::Outcome::Found) << k;
    EXPECT_LE(distance(fromVector(nearest.x()), bruteForce(qp)), 1e-8 * (1.0 + norm(qp.b))) << k;
  }
}

// Each face is left at a point that no sound method would leave it at. The next one begins feasible, and not
// above the last one; where no step helps, the point is the solution.
TEST(DescentOfSets, a_safe_step_follows_a_bad_one) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> anywhere(-3.0, 3.0);
  int descents = 0;
  for (int k = 0; k < 30; ++k) {
    const SmallQp qp = sample(random, 8, k % 3, 100.0);
    const DistributedQp distributed(qp);
    ASSERT_TRUE(distributed.problem->setProblem());
    Rows rows(*distributed.problem, 100);
    Counters counters;
    Cg cg(*distributed.problem, rows, CgOptions(), counters);
    Descent descent(*distributed.problem, rows, cg);
    ActiveFace set(distributed.solution->getLocalLength(), 0);
    long long active = 0;
    ASSERT_TRUE(descent.begin(set, active)) << k;
    double last = std::numeric_limits<double>::infinity();
    for (int face = 0; face < 6; ++face) {
      ASSERT_TRUE(cg.start(set) && descent.enter(set, active)) << k << " " << face;
      const std::vector<double> x = fromVector(*distributed.solution);
      const double now = cost(qp, x);
      EXPECT_NEAR(cg.cost(), now, 1e-9 * (1.0 + std::abs(now)));
      EXPECT_LE(violation(qp, x), 1e-7) << k << " " << face;
      EXPECT_LE(now, last + 1e-12 * (1.0 + std::abs(now))) << k << " " << face;
      descents += now < last ? 1 : 0;
      last = now;
      std::vector<double> bad(x.size());
      std::generate(bad.begin(), bad.end(), [&] { return anywhere(random); });
      distributed.solution->assign(*toVector(bad, distributed.map));
      const ActiveFace before = set;
      ASSERT_TRUE(descent.leave(now - 1.0, false, before, set, active)); // "a gain of 1"
    }
    EXPECT_GE(last, cost(qp, bruteForce(qp)) - 1e-9 * (1.0 + std::abs(last)));
  }
  EXPECT_GT(descents, 90) << "the samples say something";
}

// Given up after one set, in the place of ten: the answer is that of brute force all the same, without
// another method.
TEST(DescentOfSets, the_answer_does_not_depend_on_when_it_begins) {
  std::mt19937 random(13);
  constexpr double tolerance = 1e-10, condition = 1e3;
  int begun = 0;
  for (int k = 0; k < 60; ++k) {
    const SmallQp qp = sample(random, 9, k % 3, condition);
    const DistributedQp distributed(qp);
    ASSERT_TRUE(distributed.problem->setProblem());
    const Result result = solved(distributed, 1, tolerance);
    ASSERT_TRUE(result.converged()) << k << " " << result.explanation;
    EXPECT_EQ(result.counters.safeguards, 0) << k;
    begun += result.counters.descents;
    // λ_min = 1: ‖x − x*‖ ≤ ‖g^P‖ on the feasible set, ‖A‖ times the distance from it beside.
    EXPECT_LE(distance(fromVector(*distributed.solution), bruteForce(qp)),
              10.0 * condition * tolerance * (1.0 + norm(qp.b)))
        << k;
  }
  EXPECT_GT(begun, 15) << "the samples say something";
}

} // namespace test_descent_of_sets
