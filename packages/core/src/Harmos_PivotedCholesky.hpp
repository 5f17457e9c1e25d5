// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace Harmos {

/// Cholesky factorisation with complete pivoting of a dense symmetric positive semidefinite matrix,
/// PᵀAP = LLᵀ, stopped where the pivots are rounding errors: it reveals the rank.
///
/// As LAPACK's dpstrf, which Teuchos does not wrap, with its threshold nε max diag unless one is given. Cost
/// n·rank² flops. The pivots kept select linearly independent rows of A.
///
/// Guarded by tests/unit/core/test_pivoted_cholesky.cpp.
class PivotedCholesky {
 public:
  PivotedCholesky() = default;

  /// @param matrix n × n, column after column; both triangles are read.
  /// @param relativeThreshold pivots up to this part of the largest diagonal entry count as zero.
  PivotedCholesky(std::vector<double> matrix, int n, double relativeThreshold = 0.0);
  /// The same of a matrix that is badly conditioned: it is factored in the precision that it is given in. L
  /// is rounded after that, which changes LᵀA⁻¹L by ε times the condition of L, not of A.
  PivotedCholesky(std::vector<long double> matrix, int n, double relativeThreshold = 0.0);

  /// A factor that is known already, of a matrix with this rank. @param triangle L, n × n, column after
  /// column, rows in the order of the pivots.
  PivotedCholesky(std::vector<double> triangle, std::vector<int> pivots, int rank);

  int size() const { return n_; }
  int rank() const { return rank_; }
  /// Smallest over largest pivot among those kept; 1 for rank 0.
  double smallestPivotRatio() const { return smallestRatio_; }
  /// Rows in the order of the factorisation; those from rank() on depend on the ones before.
  const std::vector<int>& pivots() const { return pivots_; }

  /// L⁻¹ of the pivot rows' entries of a vector of size(); the result has rank() entries.
  std::vector<double> solveL(const std::vector<double>& e) const;
  /// L⁻ᵀ of a vector of rank() entries, scattered to size() entries; zero at dependent rows.
  std::vector<double> solveLt(const std::vector<double>& w) const;
  /// Lw, scattered to size() entries; zero at dependent rows.
  std::vector<double> multiplyL(const std::vector<double>& w) const;
  /// Lᵀ of the pivot rows' entries of a vector of size(); rank() entries.
  std::vector<double> multiplyLt(const std::vector<double>& v) const;
  /// A⁻ of a vector of size(): a solution of Ax = e if there is one.
  std::vector<double> solve(const std::vector<double>& e) const { return solveLt(solveL(e)); }

 private:
  template<class Real>
  void factorise(std::vector<Real>& a, double relativeThreshold);

  std::vector<double> factor_;
  std::vector<int> pivots_;
  int n_ = 0;
  int rank_ = 0;
  double smallestRatio_ = 1.0;
};

} // namespace Harmos
