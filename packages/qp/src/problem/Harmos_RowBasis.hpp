// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_VectorOps.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>
#include <Teuchos_Range1D.hpp>
#include <Teuchos_SerialDenseMatrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// An orthonormal basis Q of the range of rows, kept as vectors: rows = LQᵀ, with pivots.
///
/// Gram and Schmidt's modified process with pivoting, each vector made orthogonal twice (Björck, Numerical
/// Methods for Least Squares Problems, 1996, section 2.4): rows are told from dependent ones to rounding,
/// where CCᵀ tells them to its root. Costs a vector a row, 6 n m² flops and 6 m reductions.
///
/// Guarded by tests/unit/qp/test_hard_problems.cpp.
template<class Scalar, class MV>
class RowBasis {
 public:
  /// @param rows of norm 1, as columns; they are overwritten. @note Collective.
  explicit RowBasis(MV& rows) : vectors_(MVT::Clone(rows, MVT::GetNumberVecs(rows))) {
    const int m = MVT::GetNumberVecs(rows);
    const auto size = static_cast<std::size_t>(m);
    MVT::MvInit(*vectors_, 0.0);
    Matrix triangle(m, m); // L, rows in the user's order
    std::vector<int> order;
    std::vector<double> lengths(size, 1.0);
    // Rows of norm 1 are known to ε; sums over rows raise that.
    const double noise = 1e2 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(m));
    while (static_cast<int>(order.size()) < m) {
      const int row = static_cast<int>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
      if (!(lengths[static_cast<std::size_t>(row)] > noise))
        break;
      const Teuchos::RCP<MV> q = orthogonalised(rows, row, triangle);
      const int k = static_cast<int>(order.size());
      triangle(row, k) = norm<Scalar>(*q);
      MVT::MvScale(*q, 1.0 / triangle(row, k));
      MVT::SetBlock(*q, Teuchos::Range1D(k, k), *vectors_);
      order.push_back(row);
      takeAway(*q, k, order, rows, triangle, lengths);
    }
    const int rank = static_cast<int>(order.size());
    for (int row = 0; row < m; ++row)
      if (std::find(order.begin(), order.begin() + rank, row) == order.begin() + rank)
        order.push_back(row);
    std::vector<double> entries;
    for (int k = 0; k < m; ++k)
      for (int row : order)
        entries.push_back(triangle(row, k));
    factor_ = PivotedCholesky(std::move(entries), std::move(order), rank);
  }

  /// L, of the pivot rows; the rank is that of the rows.
  const PivotedCholesky& factor() const { return factor_; }

  /// w = Qᵀx, zero beyond the rank. @note Collective.
  void apply(const MV& x, MV& w) const {
    Matrix products(factor_.size(), 1);
    MVT::MvTransMv(1.0, *vectors_, x, products);
    BoundTraits<Scalar, MV>::scatter(
        std::vector<double>(products.values(), products.values() + factor_.size()), w);
  }

  /// x ← x + factor·Qw. @note Collective.
  void addTransposed(double factor, const MV& w, MV& x) const {
    const std::vector<double> parts = BoundTraits<Scalar, MV>::gather(w);
    Matrix column(factor_.size(), 1);
    std::copy(parts.begin(), parts.end(), column.values());
    MVT::MvTimesMatAddMv(factor, *vectors_, column, 1.0, x);
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Matrix = Teuchos::SerialDenseMatrix<int, Scalar>;

  // A row without what rounding left of the vectors before in it, which may be short by now.
  Teuchos::RCP<MV> orthogonalised(const MV& rows, int row, Matrix& triangle) const {
    const Teuchos::RCP<MV> q = MVT::CloneCopy(*MVT::CloneView(rows, Teuchos::Range1D(row, row)));
    Matrix parts(triangle.numCols(), 1);
    for (int pass = 0; pass < 2; ++pass) {
      MVT::MvTransMv(1.0, *vectors_, *q, parts);
      MVT::MvTimesMatAddMv(-1.0, *vectors_, parts, 1.0, *q);
      for (int k = 0; k < parts.numRows(); ++k)
        triangle(row, k) += parts(k, 0);
    }
    return q;
  }

  // The part along q of the rows that are left.
  void takeAway(const MV& q, int k, const std::vector<int>& order, MV& rows, Matrix& triangle,
                std::vector<double>& lengths) const {
    Matrix parts(1, triangle.numCols());
    MVT::MvTransMv(1.0, q, rows, parts);
    for (int row : order)
      parts(0, row) = 0.0;
    MVT::MvTimesMatAddMv(-1.0, q, parts, 1.0, rows);
    for (int row = 0; row < parts.numCols(); ++row)
      triangle(row, k) += parts(0, row);
    MVT::MvNorm(rows, lengths);
    for (int row : order)
      lengths[static_cast<std::size_t>(row)] = 0.0;
  }

  Teuchos::RCP<MV> vectors_; // zero beyond the rank
  PivotedCholesky factor_;
};

} // namespace Harmos::qp
