// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_SparseCholesky.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_sparse_cholesky {

using namespace Harmos::feti;

namespace {

// Lower triangle of BBᵀ for a sparse B without structure.
struct Gram {
  Gram(int n, int columns) : size(n) {
    std::map<std::pair<int, int>, double> entries;
    for (int c = 0; c < columns; ++c) {
      std::map<int, double> column;
      for (int k = 0; k < 3; ++k)
        column[(7 * c + 5 * k * k + c * k) % n] = std::sin(1.0 + 1.7 * c + 0.9 * k);
      for (const auto& [i, a] : column)
        for (const auto& [j, b] : column)
          if (j <= i)
            entries[{i, j}] += a * b;
    }
    for (const auto& [place, value] : entries) {
      rows.push_back(place.first);
      columnsOf.push_back(place.second);
      values.push_back(value);
    }
  }
  std::vector<double> multiply(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto i = static_cast<std::size_t>(rows[k]), j = static_cast<std::size_t>(columnsOf[k]);
      y[i] += values[k] * x[j];
      if (i != j)
        y[j] += values[k] * x[i];
    }
    return y;
  }
  int size;
  std::vector<int> rows, columnsOf;
  std::vector<double> values;
};

std::vector<double> wave(std::size_t n) {
  std::vector<double> x;
  for (std::size_t k = 0; k < n; ++k)
    x.push_back(std::cos(1.0 + 0.7 * static_cast<double>(k)));
  return x;
}

} // namespace

// LLᵀx = Ax, L⁻¹L = I, L⁻ᵀLᵀ = I, and solutions, to κε.
TEST(SparseCholesky, factors_solve_and_multiply) {
  for (int n : {1, 2, 10, 60, 300}) {
    const Gram a(n, 4 * n);
    const SparseCholesky factor(n, a.rows, a.columnsOf, a.values);
    ASSERT_EQ(factor.rank(), n);
    const std::vector<double> x = wave(static_cast<std::size_t>(n)), ax = a.multiply(x);
    const std::vector<double> llx = factor.multiplyL(factor.multiplyLt(x)),
                              solved = factor.solveLt(factor.solveL(ax));
    const std::vector<double> w = wave(static_cast<std::size_t>(n)),
                              back = factor.solveL(factor.multiplyL(w));
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_NEAR(llx[k], ax[k], 1e-12) << n;
      EXPECT_NEAR(solved[k], x[k], 1e-14 / factor.smallestPivotRatio() * n) << n;
      EXPECT_NEAR(back[k], w[k], 1e-12 / factor.smallestPivotRatio()) << n;
    }
  }
}

// Fewer columns than rows: as many rows are left out as where the matrix is dense, in fronts with rows below
// them; what is in the range is solved, in double precision and from long double, with an order of one's own
// or that of a factor of the same pattern. Rows of zeros among others are left out too, as on faces.
TEST(SparseCholesky, rows_left_out_inside_of_fronts) {
  for (const int columns : {60, 100, 140, 180}) {
    const int n = 300;
    Gram a(n, columns);
    const SparseCholesky whole(n, a.rows, a.columnsOf, a.values);
    for (const bool isFace : {false, true}) {
      if (isFace)
        for (std::size_t k = 0; k < a.values.size(); ++k)
          if (a.rows[k] % 7 == 3 || a.columnsOf[k] % 7 == 3)
            a.values[k] = 0.0;
      const auto size = static_cast<std::size_t>(n);
      std::vector<double> dense(size * size, 0.0);
      for (std::size_t k = 0; k < a.values.size(); ++k) {
        const auto i = static_cast<std::size_t>(a.rows[k]), j = static_cast<std::size_t>(a.columnsOf[k]);
        dense[i * size + j] = dense[j * size + i] = a.values[k];
      }
      // The least pivots of these ranks are 3e-6 of the largest one, and what is left of others 3e-12 at
      // most: errors of entries, 1e-16, over pivots as small as that. Of 260 columns it is 5e-7, which no
      // threshold tells.
      constexpr double threshold = 1e-9;
      const int rank = Harmos::PivotedCholesky(dense, n, threshold).rank();
      ASSERT_LT(rank, n);
      const std::vector<long double> extended(a.values.begin(), a.values.end());
      for (const SparseCholesky& factor :
           {SparseCholesky(n, a.rows, a.columnsOf, a.values, threshold),
            SparseCholesky(n, a.rows, a.columnsOf, a.values, threshold, &whole),
            SparseCholesky(n, a.rows, a.columnsOf, extended, threshold, &whole)}) {
        SCOPED_TRACE(std::to_string(columns) + (isFace ? " columns, face" : " columns"));
        EXPECT_EQ(factor.rank(), rank);
        EXPECT_EQ(factor.rank() + static_cast<int>(factor.dependent().size()), n);
        const std::vector<double> b = a.multiply(wave(size)), x = factor.solveLt(factor.solveL(b));
        const std::vector<double> image = a.multiply(x);
        for (std::size_t k = 0; k < size; ++k)
          EXPECT_NEAR(image[k], b[k], 1e-14 / factor.smallestPivotRatio() * n) << k;
        const std::vector<double> w = wave(static_cast<std::size_t>(rank)),
                                  back = factor.solveL(factor.multiplyL(w));
        for (std::size_t k = 0; k < w.size(); ++k)
          EXPECT_NEAR(back[k], w[k], 1e-12 / factor.smallestPivotRatio()) << k;
        // wᵀ(Lᵀx) = (Lw)ᵀx.
        const std::vector<double> lw = factor.multiplyL(w), ltx = factor.multiplyLt(x);
        double left = 0.0, right = 0.0;
        for (std::size_t k = 0; k < w.size(); ++k)
          left += w[k] * ltx[k];
        for (std::size_t k = 0; k < size; ++k)
          right += lw[k] * x[k];
        EXPECT_NEAR(left, right, 1e-12 * (std::abs(left) + n));
        for (int d : factor.dependent())
          EXPECT_EQ(x[static_cast<std::size_t>(d)], 0.0);
      }
    }
  }
}

// A graph Laplacian has the constants for a kernel: one row is left out, and systems in the range are solved.
TEST(SparseCholesky, rank_deficiency) {
  const int n = 40;
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int part : {0, 20})
    for (int i = 0; i < 20; ++i) {
      rows.push_back(part + i), columns.push_back(part + i), values.push_back(i == 0 || i == 19 ? 1.0 : 2.0);
      if (i > 0)
        rows.push_back(part + i), columns.push_back(part + i - 1), values.push_back(-1.0);
    }
  const SparseCholesky factor(n, rows, columns, values);
  EXPECT_EQ(factor.rank(), n - 2);
  ASSERT_EQ(factor.dependent().size(), 2u);
  EXPECT_NE(factor.dependent()[0] < 20, factor.dependent()[1] < 20); // one of each part
  std::vector<double> b(static_cast<std::size_t>(n), 0.0);
  b[3] = b[25] = 1.0;
  b[17] = b[38] = -1.0;
  const std::vector<double> x = factor.solveLt(factor.solveL(b));
  for (std::size_t i = 0; i < 40; ++i) {
    const std::size_t part = i / 20 * 20;
    double image = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto r = static_cast<std::size_t>(rows[k]), c = static_cast<std::size_t>(columns[k]);
      if (r == i)
        image += values[k] * x[c];
      if (c == i && r != c)
        image += values[k] * x[r];
    }
    EXPECT_NEAR(image, b[i], 1e-13) << part;
  }
  for (int d : factor.dependent())
    EXPECT_EQ(x[static_cast<std::size_t>(d)], 0.0);
}

} // namespace test_sparse_cholesky
