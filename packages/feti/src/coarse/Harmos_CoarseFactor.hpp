// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseModel.hpp"
#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_SparseCholesky.hpp"

#include <vector>

namespace Harmos::feti {

/// LLᵀ of a symmetric positive semidefinite matrix that every rank holds: dense with complete pivoting if it
/// is small, sparse otherwise; both reveal the rank.
class CoarseFactor {
 public:
  /// Matrices up to this order are dense.
  static constexpr int mostDense = mostDenseCoarseRows;

  CoarseFactor() = default;
  /// @param rows, columns, values the lower triangle, each place once.
  /// @param scale by which rows and columns are divided before ranks are decided: of rows whose sizes differ
  /// by orders
  ///        of magnitude, √a_ii. Empty: none. L is that of the matrix as it was given.
  /// @param like of the same rows and columns, whose order of elimination is taken; or null.
  /// @tparam Real double, or long double; see SparseCholesky.
  template<class Real>
  CoarseFactor(int n, const std::vector<int>& rows, const std::vector<int>& columns,
               const std::vector<Real>& values, double relativeThreshold = 0.0, int mostDenseRows = mostDense,
               std::vector<double> scale = {}, const CoarseFactor* like = nullptr);

  int rank() const { return isDense_ ? dense_.rank() : sparse_.rank(); }
  double smallestPivotRatio() const {
    return isDense_ ? dense_.smallestPivotRatio() : sparse_.smallestPivotRatio();
  }
  std::vector<int> dependent() const;
  bool isDense() const { return isDense_; }
  /// Entries of L.
  double entries() const;

  // See PivotedCholesky and SparseCholesky.
  std::vector<double> solveL(const std::vector<double>& e) const;
  std::vector<double> solveLt(const std::vector<double>& w) const;
  std::vector<double> multiplyL(const std::vector<double>& w) const;
  std::vector<double> multiplyLt(const std::vector<double>& v) const;

 private:
  bool isDense_ = true;
  std::vector<double> scale_;
  PivotedCholesky dense_;
  SparseCholesky sparse_;
};

} // namespace Harmos::feti
