// SPDX-License-Identifier: BSD-3-Clause

/// Problems with b = 0, least norms above all: what a gradient is measured by is the load of the point next
/// to zero that bounds and equalities allow.

#include "Harmos_RandomQp.hpp"
#include "Harmos_SolvedQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_no_load {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

constexpr double tolerance = 1e-10;

Dense unitMatrix(int n) {
  Dense a(n, n);
  for (int i = 0; i < n; ++i)
    a(i, i) = 1.0;
  return a;
}

} // namespace

TEST(NoLoad, random_problems_have_the_enumerated_solution) {
  std::mt19937 random(5050);
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  constexpr double condition = 100.0;
  for (int k = 0; k < 200; ++k) {
    const int n = 2 + k % 6, m = k % 4 == 3 ? 0 : 1 + k % std::max(1, n - 1);
    const bool bounds = k % 4 != 0;
    SmallQp qp = randomQp(random, n, std::min(m, n), bounds, condition);
    qp.b.assign(static_cast<std::size_t>(n), 0.0);
    if (qp.c.rows == 0) // zero is not to be the answer
      for (int i = 0; i < n; i += 2) {
        qp.lower[static_cast<std::size_t>(i)] = unit(random);
        qp.upper[static_cast<std::size_t>(i)] = 1.5;
      }
    const std::vector<double> expected = bruteForce(qp);
    ASSERT_FALSE(expected.empty()) << k;
    for (const std::string& name : solversFor(qp)) {
      const SolvedQp answer = solvedBy(name, qp, tolerance);
      ASSERT_TRUE(answer.result.converged()) << k << " " << name << ": " << answer.result.explanation;
      // ‖x − x*‖ ≤ tol·‖Ax_c‖/λ_min, with the equalities' own tolerance κ times.
      EXPECT_LT(distance(answer.x, expected), 10 * condition * condition * 1e-10 * norm(expected))
          << k << name;
    }
  }
}

// n equalities determine x: the gradient has nothing to do, and rounding errors are all of it.
TEST(NoLoad, equalities_that_determine_the_solution) {
  for (const std::string name : {"Auto", "PCPG", "SMALBE", "PDAS"})
    for (double infinite : {0.0, infinity}) {
      if (infinite > 0.0 && name == "PCPG")
        continue;
      SmallQp qp{unitMatrix(2), {0, 0}, {}, {}, Dense(2, 2), {2, 2}};
      qp.c(0, 0) = qp.c(0, 1) = qp.c(1, 0) = 1.0;
      qp.c(1, 1) = 1.1;
      if (infinite > 0.0) { // bounds that are none
        qp.lower.assign(2, -infinite);
        qp.upper.assign(2, infinite);
      }
      const SolvedQp answer = solvedBy(name, qp, tolerance);
      EXPECT_TRUE(answer.result.converged()) << name << infinite << ": " << answer.result.explanation;
      EXPECT_NEAR(answer.x[0], 2.0, 1e-8) << name; // κ(C) = 42
      EXPECT_NEAR(answer.x[1], 0.0, 1e-8) << name;
    }
}

// The point next to zero costs nothing: A makes rounding errors of it, or nothing at all.
TEST(NoLoad, a_motion_without_strain) {
  std::mt19937 random(3);
  for (int k = 0; k < 20; ++k) {
    const int n = 3 + k % 4;
    const Dense q = randomOrthonormal(random, n);
    SmallQp qp{withSpectrum(q, 1, 100.0),
               std::vector<double>(static_cast<std::size_t>(n), 0.0),
               {},
               {},
               Dense(1, n),
               {2.0}};
    for (int i = 0; i < n; ++i)
      qp.c(0, i) = q(i, 0); // the kernel
    if (k % 2 == 1) {
      qp.lower.assign(static_cast<std::size_t>(n), -3.0);
      qp.upper.assign(static_cast<std::size_t>(n), 3.0);
    }
    for (const std::string& name : solversFor(qp)) {
      const SolvedQp answer = solvedBy(name, qp, tolerance);
      ASSERT_TRUE(answer.result.converged()) << k << " " << name << ": " << answer.result.explanation;
      for (int i = 0; i < n; ++i)
        EXPECT_NEAR(answer.x[static_cast<std::size_t>(i)], 2.0 * q(i, 0), 1e-9) << k << " " << name;
    }
  }
}

// The answer is zero: what counts is the load of the initial guess.
TEST(NoLoad, nothing_to_do) {
  for (const char* name : {"Auto", "MPRGP", "PCPG"}) {
    SmallQp qp{unitMatrix(3), {0, 0, 0}, {}, {}, Dense(0, 3), {}};
    if (std::string(name) != "PCPG")
      qp.lower.assign(3, -1.0);
    qp.a(0, 0) = 100.0;
    const SolvedQp still = solvedBy(name, qp, tolerance),
                   moved = solvedBy(name, qp, tolerance, {1.0, 2.0, 3.0});
    ASSERT_TRUE(still.result.converged()) << name << ": " << still.result.explanation;
    ASSERT_TRUE(moved.result.converged()) << name << ": " << moved.result.explanation;
    EXPECT_EQ(norm(still.x), 0.0) << name;
    EXPECT_LT(norm(moved.x), 1e-10 * 100.0 * 10.0) << name; // tol·‖Ax₀‖/λ_min
  }
}

} // namespace test_no_load
