// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_PackedSymmetric.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_boundary_operator {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// A symmetric matrix without structure, entries in (−1, 1).
std::vector<double> symmetric(int n) {
  std::vector<double> a(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      a[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)] =
          std::sin(1.0 + 3.7 * std::min(i, j) + 1.3 * std::max(i, j));
  return a;
}

std::vector<double> operand(int n, int count) {
  std::vector<double> t;
  for (int k = 0; k < n * count; ++k)
    t.push_back(std::cos(0.3 + 2.1 * k));
  return t;
}

// In long double, as an independent answer.
std::vector<double> product(const std::vector<double>& a, const std::vector<double>& t, int n, int count) {
  std::vector<double> u;
  for (int c = 0; c < count; ++c)
    for (int i = 0; i < n; ++i) {
      long double sum = 0.0L;
      for (int j = 0; j < n; ++j)
        sum += static_cast<long double>(a[static_cast<std::size_t>(j * n + i)]) *
               static_cast<long double>(t[static_cast<std::size_t>(c * n + j)]);
      u.push_back(static_cast<double>(sum));
    }
  return u;
}

} // namespace

// Both storages and precisions, at all remainders of the tile width. |sum| ≤ n; errors of a sum are nε in
// double; in single precision entries are rounded to 2^-24 each, and sums of 128 terms add 128 · 2^-24 at
// most.
TEST(DenseOperator, product_of_each_storage_and_precision) {
  for (int n : {1, 2, 3, 4, 5, 7, 8, 9, 31, 64, 130, 257})
    for (int count : {1, 2, 3, 5, 40})
      for (Precision precision : {Precision::Double, Precision::Single}) {
        const std::vector<double> a = symmetric(n), t = operand(n, count), expected = product(a, t, n, count);
        const feti::DenseOperator op(a, n, precision, count);
        std::vector<double> u(t.size(), std::nan(""));
        op.apply(t.data(), u.data(), count);
        const double tolerance =
            precision == Precision::Double ? 2.3e-16 * n * 2 : 6e-8 * (2.0 * n + std::min(n, 128));
        double largest = 0.0;
        for (std::size_t k = 0; k < u.size(); ++k) {
          EXPECT_NEAR(u[k], expected[k], tolerance) << n << " " << count;
          largest = std::max(largest, std::abs(u[k] - expected[k]));
        }
        if (precision == Precision::Single && n > 30)
          EXPECT_GT(largest, 1e-9); // it is in single precision
      }
}

// Memory: a packed triangle takes half, single precision half of that.
TEST(DenseOperator, memory) {
  const int n = 256;
  const double whole = 8.0 * n * n;
  EXPECT_EQ(feti::DenseOperator(symmetric(n), n, Precision::Double, 10).bytes(), whole);
  EXPECT_EQ(feti::DenseOperator(symmetric(n), n, Precision::Single, 10).bytes(), 0.5 * whole);
  EXPECT_NEAR(feti::DenseOperator(symmetric(n), n, Precision::Double, 1).bytes(), 0.5 * whole, 0.02 * whole);
  EXPECT_NEAR(feti::DenseOperator(symmetric(n), n, Precision::Single, 1).bytes(), 0.25 * whole, 0.02 * whole);
}

TEST(SparseOperator, is_the_block_of_the_matrix) {
  const LocalMatrix matrix = makeLocalMatrix(
      4, {{0, 0, 2}, {0, 1, -1}, {1, 0, -1}, {1, 1, 3}, {1, 3, 5}, {3, 1, 5}, {3, 3, 7}, {2, 2, 1}});
  const SparseOperator op(matrix, {1, 3});
  const std::vector<double> t = {1.0, 10.0};
  std::vector<double> u(2);
  op.apply(t.data(), u.data(), 1);
  EXPECT_EQ(u, (std::vector<double>{53.0, 75.0}));
}

} // namespace test_boundary_operator
