// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LinearComplementarity.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos {

FullPivotElimination::FullPivotElimination(DenseReal matrix, LongReal threshold)
    : original_(matrix), factors_(std::move(matrix)), threshold_(threshold) {
  const int n = factors_.rows;
  rowOrder_.resize(static_cast<std::size_t>(n));
  columnOrder_.resize(static_cast<std::size_t>(n));
  std::iota(rowOrder_.begin(), rowOrder_.end(), 0);
  std::iota(columnOrder_.begin(), columnOrder_.end(), 0);
  LongReal first = 0.0;
  for (; rank_ < n; ++rank_) {
    const int k = rank_;
    int row = k, column = k;
    LongReal largest = 0.0;
    for (int i = k; i < n; ++i)
      for (int j = k; j < n; ++j)
        if (std::abs(factors_(i, j)) > largest) {
          largest = std::abs(factors_(i, j));
          row = i;
          column = j;
        }
    first = std::max(first, largest);
    if (!(largest > threshold_ * first))
      break;
    for (int j = 0; j < n; ++j)
      std::swap(factors_(k, j), factors_(row, j));
    for (int i = 0; i < n; ++i)
      std::swap(factors_(i, k), factors_(i, column));
    std::swap(rowOrder_[static_cast<std::size_t>(k)], rowOrder_[static_cast<std::size_t>(row)]);
    std::swap(columnOrder_[static_cast<std::size_t>(k)], columnOrder_[static_cast<std::size_t>(column)]);
    for (int i = k + 1; i < n; ++i) {
      if (factors_(i, k) == 0.0L)
        continue;
      const LongReal factor = factors_(i, k) /= factors_(k, k);
      LongReal* to = &factors_(i, 0);
      const LongReal* from = &factors_(k, 0);
      for (int j = k + 1; j < n; ++j)
        to[j] -= factor * from[j];
    }
  }
}

bool FullPivotElimination::solveOnce(std::vector<LongReal>& b) const {
  const int n = factors_.rows;
  std::vector<LongReal> y;
  LongReal largest = 0.0;
  for (int i = 0; i < n; ++i) {
    y.push_back(b[static_cast<std::size_t>(rowOrder_[static_cast<std::size_t>(i)])]);
    largest = std::max(largest, std::abs(y.back()));
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < std::min(i, rank_); ++j) {
      y[static_cast<std::size_t>(i)] -= factors_(i, j) * y[static_cast<std::size_t>(j)];
      largest = std::max(largest, std::abs(y[static_cast<std::size_t>(i)]));
    }
  for (int i = rank_; i < n; ++i)
    if (std::abs(y[static_cast<std::size_t>(i)]) > 1e3L * threshold_ * largest)
      return false;
  for (int i = rank_ - 1; i >= 0; --i) {
    for (int j = i + 1; j < rank_; ++j)
      y[static_cast<std::size_t>(i)] -= factors_(i, j) * y[static_cast<std::size_t>(j)];
    y[static_cast<std::size_t>(i)] /= factors_(i, i);
  }
  std::fill(b.begin(), b.end(), 0.0);
  for (int i = 0; i < rank_; ++i)
    b[static_cast<std::size_t>(columnOrder_[static_cast<std::size_t>(i)])] = y[static_cast<std::size_t>(i)];
  return true;
}

bool FullPivotElimination::solve(std::vector<LongReal>& b) const {
  std::vector<LongReal> x = b, residual = b;
  if (!solveOnce(x))
    return false;
  const int n = factors_.rows;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      residual[static_cast<std::size_t>(i)] -= original_(i, j) * x[static_cast<std::size_t>(j)];
  // Of a singular matrix the residual is rounding errors, out of its range as well.
  if (rank_ == n && solveOnce(residual))
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += residual[i];
  b = x;
  return true;
}

std::vector<std::vector<LongReal>> FullPivotElimination::kernel() const {
  const int n = factors_.rows;
  std::vector<std::vector<LongReal>> basis;
  for (int c = rank_; c < n; ++c) {
    std::vector<LongReal> y(static_cast<std::size_t>(n), 0.0);
    y[static_cast<std::size_t>(c)] = 1.0;
    for (int i = rank_ - 1; i >= 0; --i) {
      LongReal sum = -factors_(i, c);
      for (int j = i + 1; j < rank_; ++j)
        sum -= factors_(i, j) * y[static_cast<std::size_t>(j)];
      y[static_cast<std::size_t>(i)] = sum / factors_(i, i);
    }
    std::vector<LongReal> v(static_cast<std::size_t>(n), 0.0);
    for (int i = 0; i < n; ++i)
      v[static_cast<std::size_t>(columnOrder_[static_cast<std::size_t>(i)])] = y[static_cast<std::size_t>(i)];
    basis.push_back(v);
  }
  return basis;
}

bool solveLinearComplementarity(const DenseReal& h, const std::vector<LongReal>& q,
                                std::vector<LongReal>& z) {
  const int m = h.rows;
  z.assign(static_cast<std::size_t>(m), 0.0);
  // Columns of the tableau: w, z, the artificial z₀, the right-hand side; w − Hz − z₀·1 = q.
  const int artificial = 2 * m, last = 2 * m + 1;
  DenseReal tableau(m, last + 1);
  std::vector<int> basis;
  LongReal scale = 0.0;
  int leaving = -1;
  for (int i = 0; i < m; ++i) {
    basis.push_back(i);
    tableau(i, i) = 1.0;
    tableau(i, artificial) = -1.0;
    tableau(i, last) = q[static_cast<std::size_t>(i)];
    for (int j = 0; j < m; ++j)
      tableau(i, m + j) = -h(i, j);
    scale = std::max(scale, std::abs(q[static_cast<std::size_t>(i)]));
    if (leaving < 0 || q[static_cast<std::size_t>(i)] < q[static_cast<std::size_t>(leaving)])
      leaving = i;
  }
  constexpr LongReal rounding = 1e-15L;
  if (m == 0 || tableau(leaving, last) >= -rounding * scale)
    return true;
  const auto takeSolution = [&] {
    for (int i = 0; i < m; ++i)
      if (const int b = basis[static_cast<std::size_t>(i)]; b >= m && b < artificial)
        z[static_cast<std::size_t>(b - m)] = std::max(tableau(i, last), LongReal(0.0));
  };
  int entering = artificial;
  const int most = 50 * (m + 2);
  for (int step = 0; step < most; ++step) {
    const LongReal pivot = tableau(leaving, entering);
    for (int j = 0; j <= last; ++j)
      tableau(leaving, j) /= pivot;
    for (int i = 0; i < m; ++i) {
      const LongReal factor = tableau(i, entering);
      if (i == leaving || factor == 0.0L)
        continue;
      for (int j = 0; j <= last; ++j)
        tableau(i, j) -= factor * tableau(leaving, j);
    }
    const int left = basis[static_cast<std::size_t>(leaving)];
    basis[static_cast<std::size_t>(leaving)] = entering;
    if (left == artificial) {
      takeSolution();
      return true;
    }
    entering = left < m ? left + m : left - m;
    LongReal columnSize = 0.0;
    for (int i = 0; i < m; ++i)
      columnSize = std::max(columnSize, std::abs(tableau(i, entering)));
    // Lexicographic rule: of equal ratios the one whose whole row, divided by its pivot, comes first.
    leaving = -1;
    const auto comesFirst = [&](int a, int b) {
      const LongReal pa = tableau(a, entering), pb = tableau(b, entering);
      const LongReal difference = tableau(a, last) / pa - tableau(b, last) / pb;
      const LongReal size = std::max(std::abs(tableau(a, last) / pa), std::abs(tableau(b, last) / pb));
      if (std::abs(difference) > rounding * size)
        return difference < 0.0L;
      if (basis[static_cast<std::size_t>(a)] == artificial ||
          basis[static_cast<std::size_t>(b)] == artificial)
        return basis[static_cast<std::size_t>(a)] == artificial;
      for (int j = 0; j < m; ++j) {
        const LongReal x = tableau(a, j) / pa, y = tableau(b, j) / pb;
        if (std::abs(x - y) > rounding * std::max(std::abs(x), std::abs(y)))
          return x < y;
      }
      return a < b;
    };
    for (int i = 0; i < m; ++i)
      if (tableau(i, entering) > 1e-12L * columnSize && (leaving < 0 || comesFirst(i, leaving)))
        leaving = i;
    if (leaving >= 0)
      continue;
    // A ray; or z₀ has come down to a rounding error in a basis that is degenerate (no forces at all).
    for (int i = 0; i < m; ++i)
      if (basis[static_cast<std::size_t>(i)] == artificial && tableau(i, last) <= 1e-13L * scale) {
        takeSolution();
        return true;
      }
    return false;
  }
  throw InternalError("Lemke's algorithm did not end");
}

} // namespace Harmos
