// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Deflation.hpp"

#include "Harmos_SubdomainSum.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

// XᵀY, column after column.
std::vector<double> innerProducts(const MultiVector& x, const MultiVector& y) {
  const int m = static_cast<int>(x.getNumVectors()), n = static_cast<int>(y.getNumVectors());
  std::vector<double> result(static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 0.0);
  const auto left = x.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto right = y.getLocalViewHost(Tpetra::Access::ReadOnly);
  const int rows = static_cast<int>(left.extent(0));
  const Teuchos::BLAS<int, double> blas;
  const int stride = static_cast<int>(x.getStride());
  if (rows > 0 && n == 1)
    blas.GEMV(Teuchos::TRANS, rows, m, 1.0, left.data(), stride, right.data(), 1, 0.0, result.data(), 1);
  else if (rows > 0)
    blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, m, n, rows, 1.0, left.data(), stride, right.data(),
              static_cast<int>(y.getStride()), 0.0, result.data(), m);
  globalSum(*x.getMap()->getComm(), result);
  return result;
}

// X ← XC, C n × m.
Teuchos::RCP<MultiVector> combined(const MultiVector& x, const std::vector<double>& c, int m) {
  const auto result = Teuchos::rcp(new MultiVector(x.getMap(), static_cast<std::size_t>(m)));
  const int n = static_cast<int>(x.getNumVectors());
  const auto in = x.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto out = result->getLocalViewHost(Tpetra::Access::OverwriteAll);
  const int rows = static_cast<int>(in.extent(0));
  if (rows > 0)
    Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, rows, m, n, 1.0, in.data(),
                                      static_cast<int>(x.getStride()), c.data(), n, 0.0, out.data(),
                                      static_cast<int>(result->getStride()));
  return result;
}

} // namespace

Deflation::Deflation(const SubdomainSum& dual, const CoarseSpace& coarse,
                     const Teuchos::RCP<MultiVector>& vectors, const std::function<void(MultiVector&)>& admit)
    : u_(vectors) {
  // Columns that almost depend on each other leave rounding errors in what is combined of them: once more
  // for these, with products of what came of it.
  for (int pass = 0; pass < 2; ++pass) {
    admit(*u_);
    const std::size_t n = u_->getNumVectors();
    w_ = Teuchos::rcp(new MultiVector(u_->getMap(), n));
    dual.apply(*u_, *w_);
    dual.rethrowFailure();
    coarse.project(*w_);
    std::vector<double> gram = innerProducts(*u_, *w_);
    // The same to the last bit on all ranks: they decide by it which depend on others.
    Teuchos::broadcast<int, double>(*u_->getMap()->getComm(), 0, static_cast<int>(gram.size()), gram.data());
    std::vector<double> scale(n);
    for (std::size_t k = 0; k < n; ++k)
      scale[k] = gram[k * n + k] > 0.0 ? 1.0 / std::sqrt(gram[k * n + k]) : 0.0;
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i)
        gram[j * n + i] *= scale[i] * scale[j];
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < j; ++i)
        gram[j * n + i] = gram[i * n + j] = 0.5 * (gram[j * n + i] + gram[i * n + j]);
    constexpr double dependent = 1e-10; // of squares
    const PivotedCholesky factor(gram, static_cast<int>(n), dependent);
    std::vector<double> c;
    for (int k = 0; k < factor.rank(); ++k) {
      std::vector<double> unit(static_cast<std::size_t>(factor.rank()), 0.0);
      unit[static_cast<std::size_t>(k)] = 1.0;
      const std::vector<double> column = factor.solveLt(unit);
      for (std::size_t i = 0; i < n; ++i)
        c.push_back(scale[i] * column[i]);
    }
    dimension_ = factor.rank();
    if (dimension_ == 0)
      return;
    u_ = combined(*u_, c, dimension_);
    w_ = combined(*w_, c, dimension_);
  }
}

double Deflation::bytes() const {
  return 16.0 * static_cast<double>(dimension_) * static_cast<double>(u_->getLocalLength());
}

void Deflation::add(double factor, const MultiVector& of, const std::vector<double>& w,
                    MultiVector& y) const {
  const auto in = of.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto out = y.getLocalViewHost(Tpetra::Access::ReadWrite);
  const int rows = static_cast<int>(in.extent(0)), columns = static_cast<int>(y.getNumVectors());
  const Teuchos::BLAS<int, double> blas;
  const int stride = static_cast<int>(of.getStride());
  if (rows > 0 && columns == 1)
    blas.GEMV(Teuchos::NO_TRANS, rows, dimension_, factor, in.data(), stride, w.data(), 1, 1.0, out.data(),
              1);
  else if (rows > 0)
    blas.GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, rows, columns, dimension_, factor, in.data(), stride,
              w.data(), dimension_, 1.0, out.data(), static_cast<int>(y.getStride()));
}

void Deflation::removeSpan(MultiVector& lambda) const {
  add(-1.0, *u_, innerProducts(*w_, lambda), lambda);
}

void Deflation::removeFromLoad(MultiVector& d) const {
  add(-1.0, *w_, innerProducts(*u_, d), d);
}

void Deflation::complete(const MultiVector& d, MultiVector& lambda) const {
  std::vector<double> alpha = innerProducts(*u_, d);
  const std::vector<double> has = innerProducts(*w_, lambda);
  for (std::size_t k = 0; k < alpha.size(); ++k)
    alpha[k] -= has[k];
  add(1.0, *u_, alpha, lambda);
}

} // namespace Harmos::feti
