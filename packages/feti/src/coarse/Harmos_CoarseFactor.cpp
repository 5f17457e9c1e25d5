// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseFactor.hpp"

namespace Harmos::feti {

namespace {

std::vector<double> divided(std::vector<double> v, const std::vector<double>& scale) {
  for (std::size_t i = 0; i < scale.size(); ++i)
    v[i] /= scale[i];
  return v;
}

std::vector<double> multiplied(std::vector<double> v, const std::vector<double>& scale) {
  for (std::size_t i = 0; i < scale.size(); ++i)
    v[i] *= scale[i];
  return v;
}

} // namespace

template<class Real>
CoarseFactor::CoarseFactor(int n, const std::vector<int>& rows, const std::vector<int>& columns,
                           const std::vector<Real>& values, double relativeThreshold, int mostDenseRows,
                           std::vector<double> scale, const CoarseFactor* like)
    : isDense_(n <= mostDenseRows), scale_(std::move(scale)) {
  std::vector<Real> scaled = values;
  if (!scale_.empty())
    for (std::size_t k = 0; k < scaled.size(); ++k)
      scaled[k] /= static_cast<Real>(scale_[static_cast<std::size_t>(rows[k])]) *
                   scale_[static_cast<std::size_t>(columns[k])];
  if (!isDense_) {
    sparse_ = SparseCholesky(n, rows, columns, scaled, relativeThreshold,
                             like != nullptr && !like->isDense_ ? &like->sparse_ : nullptr);
    return;
  }
  const auto size = static_cast<std::size_t>(n);
  std::vector<Real> matrix(size * size, 0.0);
  for (std::size_t k = 0; k < scaled.size(); ++k) {
    const auto i = static_cast<std::size_t>(rows[k]), j = static_cast<std::size_t>(columns[k]);
    matrix[j * size + i] = matrix[i * size + j] = scaled[k];
  }
  dense_ = PivotedCholesky(std::move(matrix), n, relativeThreshold);
}

template CoarseFactor::CoarseFactor(int, const std::vector<int>&, const std::vector<int>&,
                                    const std::vector<double>&, double, int, std::vector<double>,
                                    const CoarseFactor*);
template CoarseFactor::CoarseFactor(int, const std::vector<int>&, const std::vector<int>&,
                                    const std::vector<long double>&, double, int, std::vector<double>,
                                    const CoarseFactor*);

std::vector<int> CoarseFactor::dependent() const {
  if (!isDense_)
    return sparse_.dependent();
  return {dense_.pivots().begin() + dense_.rank(), dense_.pivots().end()};
}

double CoarseFactor::entries() const {
  return isDense_ ? 0.5 * dense_.size() * (dense_.size() + 1.0) : sparse_.entries();
}

std::vector<double> CoarseFactor::solveL(const std::vector<double>& e) const {
  return isDense_ ? dense_.solveL(divided(e, scale_)) : sparse_.solveL(divided(e, scale_));
}
std::vector<double> CoarseFactor::solveLt(const std::vector<double>& w) const {
  return divided(isDense_ ? dense_.solveLt(w) : sparse_.solveLt(w), scale_);
}
std::vector<double> CoarseFactor::multiplyL(const std::vector<double>& w) const {
  return multiplied(isDense_ ? dense_.multiplyL(w) : sparse_.multiplyL(w), scale_);
}
std::vector<double> CoarseFactor::multiplyLt(const std::vector<double>& v) const {
  return isDense_ ? dense_.multiplyLt(multiplied(v, scale_)) : sparse_.multiplyLt(multiplied(v, scale_));
}

} // namespace Harmos::feti
