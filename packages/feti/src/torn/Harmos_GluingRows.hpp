// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DofCopies.hpp"

#include <cmath>
#include <map>
#include <vector>

namespace Harmos::feti::Details {

/// The gluing rows of a dof, or of dofs that are united, orthonormal in the inner product of the weights: row
/// k is (d₁, …, d_k, −s, 0, …)√d_{k+1}/√(s(s + d_{k+1})), s = d₁ + … + d_k.
class GluingRows {
 public:
  explicit GluingRows(const std::vector<Copy>& copies) : copies_(copies) {
    before_.reserve(copies.size() + 1);
    for (const Copy& copy : copies)
      before_.push_back(before_.back() + copy.weight);
  }
  std::size_t count() const { return copies_.size() - 1; }
  /// Row k has entries at the copies up to k + 1, which it compares with the mean of those before.
  double value(std::size_t k, std::size_t copy) const {
    return (copy <= k ? copies_[copy].weight : -before_[k + 1]) / length(k);
  }
  /// By which that difference was multiplied.
  double scale(std::size_t k) const { return before_[k + 1] / length(k); }

 private:
  double length(std::size_t k) const {
    return std::sqrt(before_[k + 1] * (before_[k + 1] + copies_[k + 1].weight)) /
           std::sqrt(copies_[k + 1].weight);
  }
  const std::vector<Copy>& copies_;
  std::vector<double> before_ = {0.0}; // weights of the first copies
};

/// Of the multiplier of a given row, physical: factor times the multiplier of a row of B.
struct MultiplierTerm {
  int place; ///< of the given row on its rank
  long long row;
  double factor;
};

/// A term of a row at one of several united dofs: it acts on the mean of all, and the rows that united them
/// bear the difference.
struct Lean {
  long long name; ///< of the dofs
  long long dof;
  long long row; ///< of B
  double factor; ///< force on the dof by the row's multiplier
};

/// The multipliers of rows that were taken to unite dofs, of which there may be more than are independent: of
/// all that add up to the forces on the dofs, the least ones. With c_tλ_t = y_a − y_b the forces are those of
/// a graph's Laplacian times y.
/// @param firstRow the first gluing row of each united dof, by name. @param leans by sender, at the home of
/// their name.
/// @return by rank. Local.
std::vector<std::vector<MultiplierTerm>> multipliersOfUnions(const DofCopies& dofs,
                                                             const std::map<long long, long long>& firstRow,
                                                             const std::vector<std::vector<Lean>>& leans);

} // namespace Harmos::feti::Details
