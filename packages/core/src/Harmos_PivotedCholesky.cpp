// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PivotedCholesky.hpp"

#include <Teuchos_BLAS.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos {
namespace {

std::size_t at(int i, int j, int n) {
  return static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i);
}

} // namespace

PivotedCholesky::PivotedCholesky(std::vector<double> matrix, int n, double relativeThreshold)
    : factor_(std::move(matrix)), n_(n) {
  factorise(factor_, relativeThreshold);
}

PivotedCholesky::PivotedCholesky(std::vector<long double> matrix, int n, double relativeThreshold) : n_(n) {
  factorise(matrix, relativeThreshold);
  for (long double value : matrix)
    factor_.push_back(static_cast<double>(value));
}

PivotedCholesky::PivotedCholesky(std::vector<double> triangle, std::vector<int> pivots, int rank)
    : factor_(std::move(triangle)),
      pivots_(std::move(pivots)),
      n_(static_cast<int>(pivots_.size())),
      rank_(rank) {
  double least = 1.0, most = 0.0;
  for (int k = 0; k < rank_; ++k) {
    const double pivot = factor_[at(k, k, n_)] * factor_[at(k, k, n_)];
    least = k == 0 ? pivot : std::min(least, pivot);
    most = std::max(most, pivot);
  }
  smallestRatio_ = rank_ > 0 ? least / most : 1.0;
}

template<class Real>
void PivotedCholesky::factorise(std::vector<Real>& a, double relativeThreshold) {
  const int n = n_;
  pivots_.resize(static_cast<std::size_t>(n));
  std::iota(pivots_.begin(), pivots_.end(), 0);
  Real largest = 0.0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, a[at(i, i, n)]);
  const Real zero = std::max(n * std::numeric_limits<double>::epsilon(), relativeThreshold) * largest;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (a[at(i, i, n)] > a[at(pivot, pivot, n)])
        pivot = i;
    const Real value = a[at(pivot, pivot, n)];
    if (!(value > zero))
      return;
    rank_ = k + 1;
    smallestRatio_ = std::min(smallestRatio_, static_cast<double>(value / largest));
    if (pivot != k) {
      // Symmetric interchange of the full (symmetric) remaining matrix and of the finished rows of L.
      for (int j = 0; j < n; ++j)
        std::swap(a[at(k, j, n)], a[at(pivot, j, n)]);
      for (int i = k; i < n; ++i)
        std::swap(a[at(i, k, n)], a[at(i, pivot, n)]);
      std::swap(pivots_[static_cast<std::size_t>(k)], pivots_[static_cast<std::size_t>(pivot)]);
    }
    const Real root = std::sqrt(value);
    a[at(k, k, n)] = root;
    for (int i = k + 1; i < n; ++i)
      a[at(i, k, n)] /= root;
    for (int j = k + 1; j < n; ++j) {
      const Real factor = a[at(j, k, n)];
      if (factor != 0.0)
        for (int i = k + 1; i < n; ++i)
          a[at(i, j, n)] -= a[at(i, k, n)] * factor;
    }
  }
}

std::vector<double> PivotedCholesky::solveL(const std::vector<double>& e) const {
  std::vector<double> w(static_cast<std::size_t>(rank_));
  for (std::size_t k = 0; k < w.size(); ++k)
    w[k] = e[static_cast<std::size_t>(pivots_[k])];
  if (rank_ > 0)
    Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS,
                                      Teuchos::NON_UNIT_DIAG, rank_, 1, 1.0, factor_.data(), n_, w.data(),
                                      rank_);
  return w;
}

std::vector<double> PivotedCholesky::solveLt(const std::vector<double>& w) const {
  std::vector<double> y = w;
  if (rank_ > 0)
    Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS,
                                      Teuchos::NON_UNIT_DIAG, rank_, 1, 1.0, factor_.data(), n_, y.data(),
                                      rank_);
  std::vector<double> result(static_cast<std::size_t>(n_), 0.0);
  for (std::size_t k = 0; k < y.size(); ++k)
    result[static_cast<std::size_t>(pivots_[k])] = y[k];
  return result;
}

std::vector<double> PivotedCholesky::multiplyL(const std::vector<double>& w) const {
  std::vector<double> result(static_cast<std::size_t>(n_), 0.0);
  for (int i = 0; i < rank_; ++i)
    for (int k = 0; k <= i; ++k)
      result[static_cast<std::size_t>(pivots_[static_cast<std::size_t>(i)])] +=
          factor_[at(i, k, n_)] * w[static_cast<std::size_t>(k)];
  return result;
}

std::vector<double> PivotedCholesky::multiplyLt(const std::vector<double>& v) const {
  std::vector<double> w(static_cast<std::size_t>(rank_), 0.0);
  for (int k = 0; k < rank_; ++k)
    for (int i = k; i < rank_; ++i)
      w[static_cast<std::size_t>(k)] +=
          factor_[at(i, k, n_)] * v[static_cast<std::size_t>(pivots_[static_cast<std::size_t>(i)])];
  return w;
}

} // namespace Harmos
