// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseFactor.hpp"

namespace Harmos::feti {

CoarseFactor::CoarseFactor(int n, const std::vector<int>& rows, const std::vector<int>& columns,
                           const std::vector<double>& values, double relativeThreshold, int mostDenseRows)
    : isDense_(n <= mostDenseRows) {
  if (!isDense_) {
    sparse_ = SparseCholesky(n, rows, columns, values, relativeThreshold);
    return;
  }
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> matrix(size * size, 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto i = static_cast<std::size_t>(rows[k]), j = static_cast<std::size_t>(columns[k]);
    matrix[j * size + i] = matrix[i * size + j] = values[k];
  }
  dense_ = PivotedCholesky(std::move(matrix), n, relativeThreshold);
}

std::vector<int> CoarseFactor::dependent() const {
  if (!isDense_)
    return sparse_.dependent();
  return {dense_.pivots().begin() + dense_.rank(), dense_.pivots().end()};
}

double CoarseFactor::entries() const {
  return isDense_ ? 0.5 * dense_.size() * (dense_.size() + 1.0) : sparse_.entries();
}

std::vector<double> CoarseFactor::solveL(const std::vector<double>& e) const {
  return isDense_ ? dense_.solveL(e) : sparse_.solveL(e);
}
std::vector<double> CoarseFactor::solveLt(const std::vector<double>& w) const {
  return isDense_ ? dense_.solveLt(w) : sparse_.solveLt(w);
}
std::vector<double> CoarseFactor::multiplyL(const std::vector<double>& w) const {
  return isDense_ ? dense_.multiplyL(w) : sparse_.multiplyL(w);
}
std::vector<double> CoarseFactor::multiplyLt(const std::vector<double>& v) const {
  return isDense_ ? dense_.multiplyLt(v) : sparse_.multiplyLt(v);
}

} // namespace Harmos::feti
