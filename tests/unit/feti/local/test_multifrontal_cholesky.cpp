// SPDX-License-Identifier: BSD-3-Clause
// The multifrontal factorisation against matrices, dense elimination and MUMPS.
#include "Harmos_Errors.hpp"
#include "Harmos_MultifrontalCholesky.hpp"
#include "Harmos_Mumps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::feti {
namespace {

// Couplings of a grid of cells³ or cells² nodes with `components` dofs each, positive definite: an M-matrix
// plus a small shift, components coupled.
LocalMatrix grid(int cells, int dimension, int components) {
  const int layers = dimension == 3 ? cells : 1;
  const auto number = [&](int i, int j, int k) { return (k * cells + j) * cells + i; };
  std::vector<MatrixEntry> entries;
  const auto couple = [&](int a, int b, double value) {
    for (int p = 0; p < components; ++p)
      for (int q = 0; q < components; ++q) {
        const double weight = value * (p == q ? 1.0 : 0.3);
        entries.push_back({a * components + p, a * components + q, weight});
        entries.push_back({b * components + p, b * components + q, weight});
        entries.push_back({a * components + p, b * components + q, -weight});
        entries.push_back({b * components + q, a * components + p, -weight});
      }
  };
  const int nodes = cells * cells * layers;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        const int a = number(i, j, k);
        if (i + 1 < cells)
          couple(a, number(i + 1, j, k), 1.0 + 0.1 * std::sin(a));
        if (j + 1 < cells)
          couple(a, number(i, j + 1, k), 1.0);
        if (k + 1 < layers)
          couple(a, number(i, j, k + 1), 2.0);
      }
  for (int r = 0; r < nodes * components; ++r)
    entries.push_back({r, r, 0.01});
  return makeLocalMatrix(nodes * components, entries);
}

// Without structure: a dense one of more than two panels, one whose rows are not coupled, one of a single
// row.
std::vector<LocalMatrix> matrices() {
  std::vector<LocalMatrix> result = {grid(7, 2, 1), grid(12, 2, 2), grid(6, 3, 3), grid(1, 2, 1)};
  std::vector<MatrixEntry> dense, diagonal;
  constexpr int n = 2 * FrontTree::panelColumns + 7;
  for (int i = 0; i < n; ++i) {
    diagonal.push_back({i, i, 1.0 + i});
    for (int j = 0; j < n; ++j)
      dense.push_back({i, j, i == j ? n : std::cos(1.0 * (i + j))});
  }
  result.push_back(makeLocalMatrix(n, dense));
  result.push_back(makeLocalMatrix(n, diagonal));
  return result;
}

// Rows of one part: every third, and a stretch at the end.
std::vector<int> someRows(const LocalMatrix& matrix) {
  std::vector<int> rows;
  for (int i = 0; i < matrix.rows(); ++i)
    if (i % 3 == 1 || i > 0.8 * matrix.rows())
      rows.push_back(i);
  return rows;
}

std::vector<double> wave(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i)
    x.push_back(std::sin(1.0 + 1.3 * i));
  return x;
}

double largest(const std::vector<double>& x) {
  double result = 0.0;
  for (double value : x)
    result = std::max(result, std::abs(value));
  return result;
}

// ‖A‖_∞ ‖x‖_∞ 10 n ε: what Cholesky's backward error allows a residual.
double allowed(const LocalMatrix& matrix, const std::vector<double>& x) {
  return 10.0 * matrix.rows() * std::numeric_limits<double>::epsilon() * matrix.infinityNorm() * largest(x);
}

MultifrontalCholesky factored(const LocalMatrix& matrix, const std::vector<int>& rest, FrontTree::Rest use,
                              Precision precision = Precision::Double) {
  FrontWorkspace workspace;
  return MultifrontalCholesky(matrix, std::make_shared<FrontTree>(matrix, rest, use), precision, workspace);
}

} // namespace

TEST(MultifrontalCholesky, solves) {
  for (const LocalMatrix& matrix : matrices())
    for (Precision precision : {Precision::Double, Precision::Single}) {
      const std::size_t n = static_cast<std::size_t>(matrix.rows());
      const MultifrontalCholesky factor = factored(matrix, {}, FrontTree::Rest::Stays, precision);
      std::vector<double> b = wave(matrix.rows()), x = b;
      b.insert(b.end(), b.rbegin(), b.rend());
      x = b;
      factor.solve(x.data(), 2);
      std::vector<double> image(n);
      for (std::size_t c = 0; c < 2; ++c) {
        matrix.multiply(x.data() + c * n, image.data());
        const double unit = precision == Precision::Double ? 1.0 : 6e-8 / 2.2e-16;
        for (std::size_t i = 0; i < n; ++i)
          EXPECT_NEAR(image[i], b[c * n + i], unit * allowed(matrix, x));
      }
    }
}

// Many vectors at once are those one by one, but for rounding: more than are taken together, and a rest.
TEST(MultifrontalCholesky, solves_for_many_vectors) {
  for (const LocalMatrix& matrix : matrices()) {
    const std::vector<int> held = someRows(matrix);
    const std::size_t n = static_cast<std::size_t>(matrix.rows());
    for (const std::vector<int>& rest : {std::vector<int>(), held}) {
      const MultifrontalCholesky factor = factored(matrix, rest, FrontTree::Rest::Absent);
      for (int count : {4, 31, 34, 37}) {
        std::vector<double> b;
        for (int c = 0; c < count; ++c)
          for (double value : wave(matrix.rows()))
            b.push_back(std::cos(value + 0.1 * c));
        for (int row : rest)
          for (int c = 0; c < count; ++c)
            b[static_cast<std::size_t>(c) * n + static_cast<std::size_t>(row)] = 0.0;
        std::vector<double> together = b, single = b;
        factor.solve(together.data(), count);
        for (int c = 0; c < count; ++c)
          factor.solve(single.data() + static_cast<std::size_t>(c) * n, 1);
        for (std::size_t i = 0; i < single.size(); ++i)
          EXPECT_NEAR(together[i], single[i], 1e4 * allowed(matrix, single)); // κ below 1e4
      }
    }
  }
}

// S by the definition of the Schur complement, S x_b = (A x)_b where (A x)_i = 0, and by MUMPS; A_ii⁻¹ beside
// it.
TEST(MultifrontalCholesky, condenses) {
  for (const LocalMatrix& matrix : matrices()) {
    const std::vector<int> b = someRows(matrix);
    if (b.empty())
      continue;
    MultifrontalCholesky factor = factored(matrix, b, FrontTree::Rest::Stays);
    const std::vector<double> s = factor.takeSchurComplement();
    const std::size_t m = b.size();
    ASSERT_EQ(s.size(), m * m);
    Triplets triplets = lowerTriangle(matrix, 1);
    Mumps mumps(MPI_COMM_SELF);
    mumps.analyse(matrix.rows(), triplets.rows, triplets.columns, b);
    mumps.factorize(triplets.values);
    const std::vector<double> other = mumps.schurComplement();
    for (std::size_t k = 0; k < s.size(); ++k)
      EXPECT_NEAR(s[k], other[k], 1e-12 * matrix.infinityNorm());

    std::vector<double> x(static_cast<std::size_t>(matrix.rows()), 0.0), image(x.size()), boundary;
    for (int row : b)
      x[static_cast<std::size_t>(row)] = std::cos(row);
    for (int row : b)
      boundary.push_back(x[static_cast<std::size_t>(row)]);
    matrix.multiply(x.data(), image.data());
    factor.solve(image.data(), 1); // A_ii⁻¹A_ib x_b at i
    for (int row : b)
      image[static_cast<std::size_t>(row)] = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] -= image[i];
    matrix.multiply(x.data(), image.data());
    for (std::size_t r = 0; r < m; ++r) {
      double sum = 0.0;
      for (std::size_t c = 0; c < m; ++c)
        sum += s[c * m + r] * boundary[c];
      EXPECT_NEAR(image[static_cast<std::size_t>(b[r])], sum, allowed(matrix, x));
    }
  }
}

// A part of the matrix: rows that are absent are as if they were held.
TEST(MultifrontalCholesky, factors_a_part) {
  for (const LocalMatrix& matrix : matrices()) {
    const std::vector<int> absent = someRows(matrix);
    const MultifrontalCholesky factor = factored(matrix, absent, FrontTree::Rest::Absent);
    EXPECT_EQ(factor.tree().size() + static_cast<int>(absent.size()), matrix.rows());
    std::vector<double> b = wave(matrix.rows());
    for (int row : absent)
      b[static_cast<std::size_t>(row)] = 0.0;
    std::vector<double> x = b, image(x.size());
    factor.solve(x.data(), 1);
    for (int row : absent)
      EXPECT_EQ(x[static_cast<std::size_t>(row)], 0.0);
    matrix.multiply(x.data(), image.data());
    for (int row : absent)
      image[static_cast<std::size_t>(row)] = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(image[i], b[i], allowed(matrix, x));
  }
}

// In the order of another tree: of all rows for a part of them, and of a part for another one that differs by
// few. Fill is that of an order of its own but for a quarter; where much was not eliminated there, it is
// such.
TEST(FrontTree, takes_the_order_of_another) {
  const LocalMatrix matrix = grid(24, 2, 2);
  std::vector<int> edge, longer, half;
  for (int r = 0; r < 48; ++r)
    edge.push_back(r);
  longer = edge;
  for (int r = 48; r < 56; ++r)
    longer.push_back(r);
  for (int r = 0; r < matrix.rows() / 2; ++r)
    half.push_back(r);
  const FrontTree whole(matrix, {}), inside(matrix, longer), part(matrix, half);
  for (const auto& [rest, like] :
       {std::make_pair(edge, &whole), {edge, &inside}, {edge, &part}, {{}, &whole}, {longer, &inside}}) {
    FrontWorkspace workspace;
    const auto tree = std::make_shared<FrontTree>(matrix, rest, FrontTree::Rest::Absent, like);
    const FrontTree own(matrix, rest, FrontTree::Rest::Absent);
    EXPECT_LE(4 * tree->factorEntries, 5 * own.factorEntries);
    EXPECT_EQ(tree->order == own.order, like == &part || rest.size() == longer.size() || rest.empty());
    const MultifrontalCholesky factor(matrix, tree, Precision::Double, workspace),
        expected = factored(matrix, rest, FrontTree::Rest::Absent);
    std::vector<double> x = wave(matrix.rows());
    for (int row : rest)
      x[static_cast<std::size_t>(row)] = 0.0;
    std::vector<double> y = x;
    factor.solve(x.data(), 1);
    expected.solve(y.data(), 1);
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(x[i], y[i], 1e4 * allowed(matrix, y)); // κ below 1e4
  }
}

// Loads on some rows, solutions asked for there: less is read, and the answer is the same to the last bit.
TEST(MultifrontalCholesky, reaches_what_it_must) {
  const LocalMatrix matrix = grid(30, 2, 1);
  std::vector<int> ends;
  for (int i = 0; i < 30; ++i)
    ends.push_back(i);
  const MultifrontalCholesky factor = factored(matrix, {}, FrontTree::Rest::Stays);
  std::vector<double> x(static_cast<std::size_t>(matrix.rows()), 0.0);
  for (int row : ends)
    x[static_cast<std::size_t>(row)] = 1.0 + row;
  std::vector<double> whole = x;
  const std::vector<char> reached = factor.tree().reachedFrom(ends);
  const double all = factor.tree().entriesOf(std::vector<char>(reached.size(), 1));
  EXPECT_LT(factor.tree().entriesOf(reached), 0.7 * all);
  factor.solve(whole.data(), 1);
  factor.solveReached(x.data(), 1, reached);
  for (int row : ends)
    EXPECT_EQ(x[static_cast<std::size_t>(row)], whole[static_cast<std::size_t>(row)]);
}

TEST(MultifrontalCholesky, factors_other_values_with_the_same_analysis) {
  LocalMatrix matrix = grid(5, 3, 3);
  FrontWorkspace workspace;
  const auto tree = std::make_shared<FrontTree>(matrix, std::vector<int>());
  MultifrontalCholesky factor(matrix, tree, Precision::Double, workspace);
  for (double& value : matrix.values)
    value *= 4.0;
  factor.refactor(matrix, workspace);
  std::vector<double> x = wave(matrix.rows()), image(x.size());
  factor.solve(x.data(), 1);
  matrix.multiply(x.data(), image.data());
  const std::vector<double> b = wave(matrix.rows());
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(image[i], b[i], allowed(matrix, x));
  EXPECT_THROW(factor.refactor(grid(4, 3, 3), workspace), InternalError);
}

TEST(MultifrontalCholesky, names_the_row_without_a_pivot) {
  LocalMatrix matrix = grid(6, 2, 1);
  for (std::size_t k = matrix.offsets[17]; k < matrix.offsets[18]; ++k)
    if (matrix.columns[k] == 17)
      matrix.values[k] = -1.0;
  try {
    factored(matrix, {}, FrontTree::Rest::Stays);
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("row 17 of 36"), std::string::npos) << error.what();
  }
}

// Nested dissection: a factor of a cube's matrix is far from dense, fronts cover all rows once, and parents
// come after their children.
TEST(FrontTree, is_a_tree_of_all_rows) {
  const LocalMatrix matrix = grid(10, 3, 3);
  const FrontTree tree(matrix, {});
  int next = 0;
  double entries = 0.0;
  for (std::size_t f = 0; f < tree.fronts.size(); ++f) {
    const FrontTree::Front& front = tree.fronts[f];
    EXPECT_EQ(front.first, next);
    next += front.columns;
    if (front.parent >= 0)
      EXPECT_GT(front.parent, static_cast<int>(f));
    else
      EXPECT_EQ(front.below, 0);
    EXPECT_TRUE(std::is_sorted(tree.rows.begin() + static_cast<std::ptrdiff_t>(front.rows),
                               tree.rows.begin() + static_cast<std::ptrdiff_t>(front.rows) + front.below));
    entries += 0.5 * front.columns * (front.columns + 1.0) + static_cast<double>(front.columns) * front.inner;
  }
  EXPECT_EQ(next, 3000);
  EXPECT_EQ(entries, tree.entriesOf(std::vector<char>(tree.fronts.size(), 1)));
  EXPECT_LT(entries, 0.2 * 0.5 * 3000.0 * 3001.0);
  std::vector<int> sorted = tree.order, all(3000);
  std::iota(all.begin(), all.end(), 0);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, all);
}

} // namespace Harmos::feti
