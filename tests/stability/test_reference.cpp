// SPDX-License-Identifier: BSD-3-Clause

/// The solvers behind the reference solutions, against enumeration and by hand.

#include "Harmos_LinearComplementarity.hpp"
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace Harmos;

// min ½xᵀAx − bᵀx, x ≥ l: with z = x − l, w = Az + Al − b.
TEST(ReferenceSolvers, linear_complementarity_finds_what_enumeration_finds) {
  std::mt19937 random(401);
  for (int k = 0; k < 50; ++k) {
    SmallQp qp = randomQp(random, 6, 0, false, std::pow(10.0, k % 6));
    for (int i = 0; i < 6; ++i)
      qp.lower.push_back(std::uniform_real_distribution<double>(-1.0, 1.0)(random));
    const std::vector<double> expected = bruteForce(qp);
    DenseReal h(6, 6);
    std::vector<LongReal> q, z;
    for (int i = 0; i < 6; ++i) {
      q.push_back(-qp.b[static_cast<std::size_t>(i)]);
      for (int j = 0; j < 6; ++j) {
        h(i, j) = qp.a(i, j);
        q.back() += h(i, j) * qp.lower[static_cast<std::size_t>(j)];
      }
    }
    ASSERT_TRUE(solveLinearComplementarity(h, q, z)) << k;
    for (std::size_t i = 0; i < 6; ++i) // enumeration in double loses as many digits as κ has
      EXPECT_NEAR(static_cast<double>(z[i]) + qp.lower[i], expected[i], 1e-9) << k;
  }
}

TEST(ReferenceSolvers, a_ray_is_no_solution) {
  DenseReal h(2, 2); // z₁ = z₂ is free to grow, and q pulls along it
  h(0, 0) = h(1, 1) = 1.0;
  h(0, 1) = h(1, 0) = -1.0;
  std::vector<LongReal> z;
  EXPECT_FALSE(solveLinearComplementarity(h, {-1.0, 0.5}, z));
  ASSERT_TRUE(solveLinearComplementarity(h, {-1.0, 1.0}, z));
  EXPECT_NEAR(static_cast<double>(z[0] - z[1]), 1.0, 1e-15);
}

TEST(ReferenceSolvers, elimination_reveals_rank_and_kernel) {
  DenseReal a(3, 3); // a chain of two springs
  a(0, 0) = a(2, 2) = 1.0;
  a(1, 1) = 2.0;
  a(0, 1) = a(1, 0) = a(1, 2) = a(2, 1) = -1.0;
  const FullPivotElimination elimination(a, 1e-13L);
  EXPECT_EQ(elimination.rank(), 2);
  const auto kernel = elimination.kernel();
  ASSERT_EQ(kernel.size(), 1u);
  EXPECT_NEAR(static_cast<double>(kernel[0][0] / kernel[0][1]), 1.0, 1e-15);
  EXPECT_NEAR(static_cast<double>(kernel[0][2] / kernel[0][1]), 1.0, 1e-15);
  std::vector<LongReal> balanced = {1.0, 0.0, -1.0}, pulled = {1.0, 0.0, 0.0};
  EXPECT_FALSE(elimination.solve(pulled));
  ASSERT_TRUE(elimination.solve(balanced));
  EXPECT_NEAR(static_cast<double>(balanced[0] - balanced[2]), 2.0, 1e-15);
}
