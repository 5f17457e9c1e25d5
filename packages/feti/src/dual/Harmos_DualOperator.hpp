// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverses.hpp"
#include "Harmos_SubdomainSum.hpp"

namespace Harmos::feti {

/// F = B K⁺ Bᵀ, in the form of the local inverses; with rows that give way, F + C. Of clusters UᵀF = 0, and
/// rounding errors in that are taken out.
///
/// Symmetric positive semidefinite on vectors over Constraints::rowMap(). Cost: one neighbour exchange each
/// way; locally, for each class of congruent subdomains one matrix-matrix product with its S⁺ (condensed) or
/// one solve with many right-hand sides (implicit).
///
/// Guarded by tests/unit/feti/test_dual_operator.cpp (symmetry, independence of ranks and forms).
class DualOperator : public SubdomainSum {
 public:
  /// @param constraints to outlive this. @param inverses whose inverses it keeps: factored anew, it is F of
  /// the new matrices.
  DualOperator(const Constraints& constraints, const LocalInverses& inverses);

  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Constraints& constraints_;
  std::shared_ptr<const ClusterInverse> joined_; // or null
};

/// The entries of B, or B_D, of the members of a class, counted by boundary dofs. @param entries by
/// subdomains.
std::vector<SubdomainSum::Entry> boundaryEntries(const std::vector<std::vector<Constraints::Entry>>& entries,
                                                 const CongruenceClass& ofClass);

} // namespace Harmos::feti
