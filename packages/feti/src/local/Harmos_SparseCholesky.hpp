// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FrontTree.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace Harmos::feti {

/// A = LLᵀ of a sparse symmetric positive semidefinite matrix, with rows left out whose pivot is a rounding
/// error: it reveals the rank like PivotedCholesky, which it replaces where the matrix is too large to be
/// dense. Unlike the solvers behind Amesos2 it gives L⁻¹ and L⁻ᵀ apart.
///
/// Multifrontal, in dense pieces (FrontTree); rows are left out in the order of elimination. Guarded by
/// tests/unit/feti/coarse/test_sparse_cholesky.cpp.
class SparseCholesky {
 public:
  SparseCholesky() = default;

  /// @param rows, columns, values the lower triangle, entry by entry, each place once.
  /// @param relativeThreshold pivots up to this part of the largest diagonal entry count as zero; nε at
  /// least.
  /// @param like of the same rows and columns, whose order of elimination is taken; or null.
  /// @tparam Real double; or long double for matrices that are badly conditioned, of which L is rounded to
  /// double after it was made; see PivotedCholesky.
  template<class Real>
  SparseCholesky(int n, const std::vector<int>& rows, const std::vector<int>& columns,
                 const std::vector<Real>& values, double relativeThreshold = 0.0,
                 const SparseCholesky* like = nullptr);

  int size() const { return static_cast<int>(isKept_.size()); }
  int rank() const { return static_cast<int>(kept_.size()); }
  /// Rows left out, in no special order.
  const std::vector<int>& dependent() const { return dependent_; }
  /// Smallest over largest pivot among those kept; 1 for rank 0.
  double smallestPivotRatio() const { return smallestRatio_; }
  /// Entries of L.
  double entries() const;

  /// L⁻¹ of the kept rows' entries of a vector of size(); the result has rank() entries.
  std::vector<double> solveL(const std::vector<double>& e) const;
  /// L⁻ᵀ of a vector of rank() entries, scattered to size() entries; zero at rows left out.
  std::vector<double> solveLt(const std::vector<double>& w) const;
  /// Lw, scattered to size() entries; zero at rows left out.
  std::vector<double> multiplyL(const std::vector<double>& w) const;
  /// Lᵀ of the kept rows' entries of a vector of size(); rank() entries.
  std::vector<double> multiplyLt(const std::vector<double>& v) const;

 private:
  template<class Work>
  void throughFronts(bool upwards, std::vector<double>& x, const Work& work) const;
  std::vector<double> byPlaces(const std::vector<double>& v) const;
  std::vector<double> byRows(const std::vector<double>& x) const;
  std::vector<double> keptOf(const std::vector<double>& x) const;
  std::vector<double> scattered(const std::vector<double>& w) const;

  std::shared_ptr<const FrontTree> tree_;
  std::vector<double> values_;     // of L, front after front, its columns of the height of all its rows
  std::vector<std::size_t> begin_; // of each front in them
  std::vector<char> isKept_;       // of each place
  std::vector<int> kept_;          // places that were kept
  std::vector<int> dependent_;
  double smallestRatio_ = 1.0;
};

} // namespace Harmos::feti
