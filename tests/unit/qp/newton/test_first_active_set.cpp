// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FirstActiveSet.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_first_active_set {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using Rows = EqualityRows<Scalar, MultiVector, Operator>;
using First = FirstActiveSet<Scalar, MultiVector, Operator>;

// The guess, entry by entry on all ranks, from a set without active entries.
std::vector<double> guessOf(const SmallQp& qp, bool* found = nullptr) {
  const DistributedQp distributed(qp);
  distributed.precondition(jacobi(qp.a));
  const Rows rows(*distributed.problem, 100);
  Counters counters;
  ActiveFace set(distributed.solution->getLocalLength(), 0);
  long long active = 0;
  const bool has = First(*distributed.problem, rows, counters).find(set, active);
  if (found != nullptr)
    *found = has;
  else
    EXPECT_TRUE(has);
  EXPECT_EQ(counters.hessianApplications, 0);
  MultiVector states(distributed.map, 1);
  for (std::size_t i = 0; i < set.size(); ++i)
    states.replaceLocalValue(static_cast<LocalOrdinal>(i), 0, set[i]);
  const std::vector<double> result = fromVector(states);
  EXPECT_EQ(active, std::count_if(result.begin(), result.end(), [](double side) { return side != 0.0; }));
  return result;
}

// A = s I: the guess is the answer, and a brute force knows that.
SmallQp springs(std::mt19937& random, int n, int equalities, double s) {
  SmallQp qp = randomQp(random, n, equalities, true);
  qp.a = Dense(n, n);
  for (int i = 0; i < n; ++i)
    qp.a(i, i) = s;
  if (equalities > 0)
    orthonormalizeRows(qp);
  return qp;
}

} // namespace

TEST(FirstActiveSet, is_that_of_the_problem_with_a_number_in_the_place_of_the_hessian) {
  std::mt19937 random(7);
  int withActive = 0;
  for (int sample = 0; sample < 60; ++sample) {
    const int equalities = sample % 3;
    const SmallQp qp = springs(random, 8, equalities, sample % 2 == 0 ? 1.0 : 50.0);
    const std::vector<double> x = bruteForce(qp), set = guessOf(qp);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool atLower = !qp.lower.empty() && x[i] - qp.lower[i] <= 1e-12 * (1.0 + std::abs(x[i]));
      const bool atUpper = !qp.upper.empty() && qp.upper[i] - x[i] <= 1e-12 * (1.0 + std::abs(x[i]));
      EXPECT_EQ(set[i], atLower ? -1.0 : atUpper ? 1.0 : 0.0) << sample << " " << i;
      withActive += atLower || atUpper ? 1 : 0;
    }
  }
  EXPECT_GT(withActive, 60) << "the samples say something";
}

// A rigid body of unit weight over supports with gaps, which it reaches by sinking: Σx = 1, x ≥ 0. The
// supports near it carry, those far below do not, however many there are.
TEST(FirstActiveSet, a_floating_body_sinks_onto_the_nearest_supports) {
  constexpr int n = 40, near = 4;
  SmallQp qp{Dense(n, n), std::vector<double>(n), std::vector<double>(n, 0.0), {},
             Dense(1, n), {1.0 / std::sqrt(n)}};
  for (int i = 0; i < n; ++i) {
    qp.a(i, i) = 1.0;
    qp.b[static_cast<std::size_t>(i)] = i < near ? 0.0 : -10.0 - i; // b = −gap
    qp.c(0, i) = 1.0 / std::sqrt(n);
  }
  const std::vector<double> set = guessOf(qp);
  for (int i = 0; i < n; ++i)
    EXPECT_EQ(set[static_cast<std::size_t>(i)], i < near ? 0.0 : -1.0) << i;
}

TEST(FirstActiveSet, there_is_none_without_a_preconditioner) {
  std::mt19937 random(3);
  const SmallQp qp = springs(random, 6, 1, 1.0);
  const DistributedQp distributed(qp);
  ASSERT_TRUE(distributed.problem->setProblem());
  const Rows rows(*distributed.problem, 100);
  Counters counters;
  ActiveFace set(distributed.solution->getLocalLength(), 0);
  long long active = 0;
  EXPECT_FALSE(First(*distributed.problem, rows, counters).find(set, active));
}

} // namespace test_first_active_set
