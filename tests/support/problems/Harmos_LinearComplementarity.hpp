// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace Harmos {

/// 64 bits of mantissa on x86.
using LongReal = long double;

/// A dense matrix, row after row.
struct DenseReal {
  int rows = 0;
  int columns = 0;
  std::vector<LongReal> values;
  DenseReal() = default;
  DenseReal(int m, int n)
      : rows(m), columns(n), values(static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 0.0) {}
  LongReal& operator()(int i, int j) {
    return values[static_cast<std::size_t>(i) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(j)];
  }
  LongReal operator()(int i, int j) const { return const_cast<DenseReal&>(*this)(i, j); }
};

/// Gaussian elimination with complete pivoting of a square matrix, which reveals its rank.
class FullPivotElimination {
 public:
  /// @param threshold pivots up to this part of the largest entry are zero.
  FullPivotElimination(DenseReal matrix, LongReal threshold);

  int rank() const { return rank_; }
  /// Overwrites b by a solution, refined once, zero at dependent unknowns; false, with b as it was, if there
  /// is none.
  bool solve(std::vector<LongReal>& b) const;
  /// A basis of the kernel.
  std::vector<std::vector<LongReal>> kernel() const;

 private:
  bool solveOnce(std::vector<LongReal>& b) const;

  DenseReal original_, factors_;
  std::vector<int> rowOrder_, columnOrder_;
  LongReal threshold_;
  int rank_ = 0;
};

/// z ≥ 0 with w = q + Hz ≥ 0 and wᵀz = 0, for H positive semidefinite, by Lemke's algorithm.
/// @return false if there is no solution (a ray). @throws InternalError if it does not end.
bool solveLinearComplementarity(const DenseReal& h, const std::vector<LongReal>& q, std::vector<LongReal>& z);

} // namespace Harmos
