// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryOperator.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_PackedSymmetric.hpp"

#include <Teuchos_BLAS.hpp>

#include <algorithm>

namespace Harmos::feti {
namespace {

// Below this number of vectors a packed matrix is faster: a matrix-matrix product of few columns reads the
// whole matrix, packed ones half of it for each vector.
constexpr int leastColumnsForWhole = 3;
// From this number on it is worth its while to unpack one for them.
constexpr int leastColumnsForUnpacking = 16;

// Terms of a sum in single precision before it is added up in double.
constexpr int singleTerms = 128;

} // namespace

LocalMatrix couplingOf(const LocalMatrix& matrix, const std::vector<int>& boundary) {
  std::vector<bool> isBoundary(static_cast<std::size_t>(matrix.rows()), false);
  for (int row : boundary)
    isBoundary[static_cast<std::size_t>(row)] = true;
  LocalMatrix result;
  for (int row : boundary) {
    const auto r = static_cast<std::size_t>(row);
    for (std::size_t k = matrix.offsets[r]; k < matrix.offsets[r + 1]; ++k)
      if (!isBoundary[static_cast<std::size_t>(matrix.columns[k])]) {
        result.columns.push_back(matrix.columns[k]);
        result.values.push_back(matrix.values[k]);
      }
    result.offsets.push_back(result.columns.size());
  }
  return result;
}

std::vector<double> BoundaryOperator::matrix() const {
  const auto n = static_cast<std::size_t>(size());
  std::vector<double> unit(n * n, 0.0), result(n * n);
  for (std::size_t k = 0; k < n; ++k)
    unit[k * n + k] = 1.0;
  apply(unit.data(), result.data(), size());
  return result;
}

DenseOperator::DenseOperator(std::vector<double> matrix, int n, Precision precision, int columns)
    : n_(n), packed_(columns < leastColumnsForWhole) {
  HARMOS_REQUIRE(matrix.size() == static_cast<std::size_t>(n) * static_cast<std::size_t>(n),
                 "a dense operator needs a square matrix");
  if (packed_ && precision == Precision::Double)
    double_ = PackedSymmetric::pack<double>(matrix, n);
  else if (packed_)
    single_ = PackedSymmetric::pack<float>(matrix, n);
  else if (precision == Precision::Double)
    double_ = std::move(matrix);
  else
    single_.assign(matrix.begin(), matrix.end());
}

void DenseOperator::roundIfPacked() {
  if (!packed_ || double_.empty())
    return;
  single_.assign(double_.begin(), double_.end());
  double_ = std::vector<double>();
}

double DenseOperator::bytes() const {
  return 8.0 * static_cast<double>(double_.size()) + 4.0 * static_cast<double>(single_.size());
}

double DenseOperator::bytesRead(int count) const {
  return packed_ ? bytes() * count : bytes();
}

std::vector<double> DenseOperator::matrix() const {
  if (packed_)
    return single_.empty() ? PackedSymmetric::unpack(double_, n_) : PackedSymmetric::unpack(single_, n_);
  return single_.empty() ? double_ : std::vector<double>(single_.begin(), single_.end());
}

template<class T>
void DenseOperator::applyWhole(const std::vector<T>& matrix, const double* t, double* u, int count) const {
  if constexpr (std::is_same_v<T, double>) {
    Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, n_, count, n_, 1.0, matrix.data(),
                                      n_, t, n_, 0.0, u, n_);
  } else {
    const std::size_t length = static_cast<std::size_t>(n_) * static_cast<std::size_t>(count);
    operand_.assign(t, t + length);
    product_.resize(length);
    std::fill(u, u + length, 0.0);
    for (int begin = 0; begin < n_; begin += singleTerms) {
      const int terms = std::min(singleTerms, n_ - begin);
      const float* block = matrix.data() + static_cast<std::size_t>(begin) * static_cast<std::size_t>(n_);
      Teuchos::BLAS<int, float>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, n_, count, terms, 1.0F, block,
                                       n_, operand_.data() + begin, n_, 0.0F, product_.data(), n_);
      for (std::size_t k = 0; k < length; ++k)
        u[k] += static_cast<double>(product_[k]);
    }
  }
}

void DenseOperator::apply(const double* t, double* u, int count) const {
  if (n_ == 0 || count == 0)
    return;
  if (packed_ && count >= leastColumnsForUnpacking)
    return applyWhole(matrix(), t, u, count);
  if (!packed_)
    return single_.empty() ? applyWhole(double_, t, u, count) : applyWhole(single_, t, u, count);
  const auto n = static_cast<std::size_t>(n_);
  const auto padded = static_cast<std::size_t>(PackedSymmetric::paddedLength(n_));
  operandColumn_.resize(padded, 0.0); // zero beyond n
  productColumn_.resize(padded);
  for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c) {
    std::copy(t + c * n, t + (c + 1) * n, operandColumn_.begin());
    if (single_.empty())
      PackedSymmetric::multiply(double_.data(), n_, operandColumn_.data(), productColumn_.data());
    else
      PackedSymmetric::multiply(single_.data(), n_, operandColumn_.data(), productColumn_.data());
    std::copy(productColumn_.begin(), productColumn_.begin() + n_, u + c * n);
  }
}

SparseOperator::SparseOperator(const LocalMatrix& matrix, const std::vector<int>& boundary) {
  std::vector<int> place(static_cast<std::size_t>(matrix.rows()), -1);
  for (std::size_t k = 0; k < boundary.size(); ++k)
    place[static_cast<std::size_t>(boundary[k])] = static_cast<int>(k);
  for (int row : boundary) {
    const auto i = static_cast<std::size_t>(row);
    for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
      if (const int column = place[static_cast<std::size_t>(matrix.columns[k])]; column >= 0) {
        block_.columns.push_back(column);
        block_.values.push_back(matrix.values[k]);
      }
    block_.offsets.push_back(block_.columns.size());
  }
}

void SparseOperator::apply(const double* t, double* u, int count) const {
  const auto n = static_cast<std::size_t>(size());
  for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
    block_.multiply(t + c * n, u + c * n);
}

} // namespace Harmos::feti
