// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseSpace.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Teuchos_BLAS.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace Harmos::feti {
namespace {

struct CoarseEntry {
  long long row;
  double value;
  int column;
};

std::size_t at(int i, int j, int n) {
  return static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i);
}

// Cholesky factorisation with complete pivoting, PᵀAP = LLᵀ, stopped where the pivots are rounding errors; as
// LAPACK's dpstrf, which Teuchos does not wrap. Returns the rank.
int pivotedCholesky(std::vector<double>& a, int n, std::vector<int>& pivots, double& smallestRatio) {
  pivots.resize(static_cast<std::size_t>(n));
  std::iota(pivots.begin(), pivots.end(), 0);
  double largest = 0.0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, a[at(i, i, n)]);
  // dpstrf's own threshold, nε max diag.
  const double zero = n * std::numeric_limits<double>::epsilon() * largest;
  smallestRatio = 1.0;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (a[at(i, i, n)] > a[at(pivot, pivot, n)])
        pivot = i;
    const double value = a[at(pivot, pivot, n)];
    if (!(value > zero))
      return k;
    smallestRatio = std::min(smallestRatio, value / largest);
    if (pivot != k) {
      // Symmetric interchange of the full (symmetric) remaining matrix and of the finished rows of L.
      for (int j = 0; j < n; ++j)
        std::swap(a[at(k, j, n)], a[at(pivot, j, n)]);
      for (int i = k; i < n; ++i)
        std::swap(a[at(i, k, n)], a[at(i, pivot, n)]);
      std::swap(pivots[static_cast<std::size_t>(k)], pivots[static_cast<std::size_t>(pivot)]);
    }
    const double root = std::sqrt(value);
    a[at(k, k, n)] = root;
    for (int i = k + 1; i < n; ++i)
      a[at(i, k, n)] /= root;
    for (int j = k + 1; j < n; ++j) {
      const double factor = a[at(j, k, n)];
      if (factor != 0.0)
        for (int i = k + 1; i < n; ++i)
          a[at(i, j, n)] -= a[at(i, k, n)] * factor;
    }
  }
  return n;
}

} // namespace

CoarseSpace::CoarseSpace(const SubdomainSystem& system, const Constraints& constraints)
    : comm_(system.comm()), kernelDimension_(system.kernelDimension()) {
  // Each subdomain makes its rows of G̃; the entries go to the ranks that own the dual rows.
  std::vector<std::vector<CoarseEntry>> sends(static_cast<std::size_t>(comm_->getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Kernel& kernel = system.kernel(i);
    const std::vector<Constraints::Entry>& entries = constraints.entries(i);
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].row == entries[begin].row)
        ++end;
      for (int k = 0; k < kernel.columns; ++k) {
        double value = 0.0;
        for (std::size_t e = begin; e < end; ++e)
          value += entries[e].value * kernel.column(k)[entries[e].dof];
        if (value != 0.0)
          sends[static_cast<std::size_t>(constraints.overlapOwner(entries[begin].row))].push_back(
              {static_cast<long long>(constraints.overlapMap()->getGlobalElement(entries[begin].row)), value,
               system.kernelOffset(i) + k});
      }
      begin = end;
    }
  }
  rows_.resize(localSize(*constraints.rowMap()));
  for (const std::vector<CoarseEntry>& part : exchangeItems(*comm_, sends))
    for (const CoarseEntry& entry : part)
      rows_[static_cast<std::size_t>(
                constraints.rowMap()->getLocalElement(static_cast<GlobalOrdinal>(entry.row)))]
          .emplace_back(entry.column, entry.value);
  for (auto& row : rows_)
    std::sort(row.begin(), row.end());

  const int n = kernelDimension_;
  factor_.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0.0);
  for (const auto& row : rows_)
    for (const auto& [i, left] : row)
      for (const auto& [j, right] : row)
        factor_[at(i, j, n)] += left * right;
  globalSum(*comm_, factor_);
  dimension_ = pivotedCholesky(factor_, n, pivots_, smallestPivotRatio_);
  coarseMap_ = Teuchos::rcp(
      new Map(static_cast<Tpetra::global_size_t>(dimension_), 0, comm_, Tpetra::LocallyReplicated));
}

std::vector<int> CoarseSpace::dependentColumns() const {
  return {pivots_.begin() + dimension_, pivots_.end()};
}

std::vector<double> CoarseSpace::applyUnscaled(const MultiVector& lambda, std::size_t column) const {
  std::vector<double> w(static_cast<std::size_t>(kernelDimension_), 0.0);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    for (const auto& [k, value] : rows_[r])
      w[static_cast<std::size_t>(k)] += value * view(r, column);
  globalSum(*comm_, w);
  return w;
}

std::vector<double> CoarseSpace::solveL(const std::vector<double>& e) const {
  std::vector<double> w(static_cast<std::size_t>(dimension_));
  for (std::size_t k = 0; k < w.size(); ++k)
    w[k] = e[static_cast<std::size_t>(pivots_[k])];
  if (dimension_ > 0)
    Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS,
                                      Teuchos::NON_UNIT_DIAG, dimension_, 1, 1.0, factor_.data(),
                                      kernelDimension_, w.data(), dimension_);
  return w;
}

std::vector<double> CoarseSpace::solveLt(const std::vector<double>& w) const {
  std::vector<double> t = w;
  if (dimension_ > 0)
    Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS,
                                      Teuchos::NON_UNIT_DIAG, dimension_, 1, 1.0, factor_.data(),
                                      kernelDimension_, t.data(), dimension_);
  std::vector<double> result(static_cast<std::size_t>(kernelDimension_), 0.0);
  for (std::size_t k = 0; k < t.size(); ++k)
    result[static_cast<std::size_t>(pivots_[k])] = t[k];
  return result;
}

std::vector<double> CoarseSpace::applyG(const MultiVector& lambda, std::size_t column) const {
  return solveL(applyUnscaled(lambda, column));
}

void CoarseSpace::addGt(double factor, const std::vector<double>& w, MultiVector& lambda,
                        std::size_t column) const {
  const std::vector<double> s = solveLt(w);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    double sum = 0.0;
    for (const auto& [k, value] : rows_[r])
      sum += value * s[static_cast<std::size_t>(k)];
    view(r, column) += factor * sum;
  }
}

void CoarseSpace::project(MultiVector& v) const {
  if (dimension_ == 0)
    return;
  for (std::size_t c = 0; c < v.getNumVectors(); ++c)
    addGt(-1.0, applyG(v, c), v, c);
}

void CoarseOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                           Scalar beta) const {
  if (beta == 0.0)
    Y.putScalar(0.0);
  else
    Y.scale(beta);
  for (std::size_t c = 0; c < X.getNumVectors(); ++c) {
    if (mode == Teuchos::NO_TRANS) {
      const std::vector<double> w = coarse_.applyG(X, c);
      const auto view = Y.getLocalViewHost(Tpetra::Access::ReadWrite);
      for (std::size_t k = 0; k < w.size(); ++k)
        view(k, c) += alpha * w[k];
    } else {
      const auto view = X.getLocalViewHost(Tpetra::Access::ReadOnly);
      std::vector<double> w(static_cast<std::size_t>(coarse_.dimension()));
      for (std::size_t k = 0; k < w.size(); ++k)
        w[k] = view(k, c);
      coarse_.addGt(alpha, w, Y, c);
    }
  }
}

void ProjectedOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                              Scalar beta) const {
  MultiVector projected(X, Teuchos::Copy);
  coarse_.project(projected);
  MultiVector image(Y.getMap(), X.getNumVectors());
  inner_.apply(projected, image);
  coarse_.project(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

} // namespace Harmos::feti
