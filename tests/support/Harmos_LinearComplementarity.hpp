// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace Harmos {

/// 64 bits of mantissa on x86.
using Real = long double;

/// A dense matrix, row after row.
struct DenseReal {
  int rows = 0;
  int columns = 0;
  std::vector<Real> values;
  DenseReal() = default;
  DenseReal(int m, int n)
      : rows(m), columns(n), values(static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 0.0) {}
  Real& operator()(int i, int j) {
    return values[static_cast<std::size_t>(i) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(j)];
  }
  Real operator()(int i, int j) const { return const_cast<DenseReal&>(*this)(i, j); }
};

/// Gaussian elimination with complete pivoting of a square matrix, which reveals its rank.
class FullPivotElimination {
 public:
  /// @param threshold pivots up to this part of the largest entry are zero.
  FullPivotElimination(DenseReal matrix, Real threshold);

  int rank() const { return rank_; }
  /// Overwrites b by a solution, refined once, zero at dependent unknowns; false, with b as it was, if there
  /// is none.
  bool solve(std::vector<Real>& b) const;
  /// A basis of the kernel.
  std::vector<std::vector<Real>> kernel() const;

 private:
  bool solveOnce(std::vector<Real>& b) const;

  DenseReal original_, factors_;
  std::vector<int> rowOrder_, columnOrder_;
  Real threshold_;
  int rank_ = 0;
};

/// z ≥ 0 with w = q + Hz ≥ 0 and wᵀz = 0, for H positive semidefinite, by Lemke's algorithm.
/// @return false if there is no solution (a ray). @throws InternalError if it does not end.
bool solveLinearComplementarity(const DenseReal& h, const std::vector<Real>& q, std::vector<Real>& z);

} // namespace Harmos
