// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PivotedCholesky.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace test_pivoted_cholesky {

using Harmos::PivotedCholesky;

namespace {

// BBᵀ of an n × r matrix: rank r.
std::vector<double> gram(std::mt19937& random, int n, int r) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> b(static_cast<std::size_t>(n * r)), a(static_cast<std::size_t>(n * n), 0.0);
  for (double& value : b)
    value = unit(random);
  for (int k = 0; k < r; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        a[static_cast<std::size_t>(j * n + i)] +=
            b[static_cast<std::size_t>(k * n + i)] * b[static_cast<std::size_t>(k * n + j)];
  return a;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& x) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t j = 0; j < x.size(); ++j)
    for (std::size_t i = 0; i < x.size(); ++i)
      y[i] += a[j * x.size() + i] * x[j];
  return y;
}

} // namespace

TEST(PivotedCholesky, solves_consistent_systems_of_any_rank) {
  std::mt19937 random(5);
  for (int n = 1; n <= 8; ++n)
    for (int r = 0; r <= n; ++r) {
      const std::vector<double> a = gram(random, n, r);
      const PivotedCholesky factor(a, n);
      ASSERT_EQ(factor.rank(), r) << n;
      std::vector<double> x(static_cast<std::size_t>(n));
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = std::cos(static_cast<double>(i));
      const std::vector<double> e = product(a, x), back = product(a, factor.solve(e));
      // ε times the condition of the kept block, the square of the pivots' ratio at worst.
      const double accuracy = 1e-14 / factor.smallestPivotRatio();
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(back[i], e[i], accuracy) << n << " " << r;
    }
}

TEST(PivotedCholesky, threshold_leaves_weak_rows_out) {
  const std::vector<double> a = {1.0, 0.0, 0.0, 1e-6};
  EXPECT_EQ(PivotedCholesky(a, 2).rank(), 2);
  EXPECT_EQ(PivotedCholesky(a, 2, 1e-5).rank(), 1);
  EXPECT_EQ(PivotedCholesky(a, 2, 1e-5).pivots().front(), 0);
}

} // namespace test_pivoted_cholesky
