// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"
#include "Harmos_LocalInverse.hpp"

#include <Tpetra_Operator.hpp>

#include <exception>

namespace Harmos::feti {

/// F = B K⁺ Bᵀ in its implicit form: one solve with each local factorisation a product.
///
/// Symmetric positive semidefinite on vectors over Constraints::rowMap(). Cost: one neighbour exchange each
/// way and a forward and backward substitution for each subdomain.
///
/// A failure of a local solve on one rank cannot be thrown at once, or the others would wait in the exchange.
/// It is kept, and the result is poisoned with NaN, which the next reduction of any solver carries to all
/// ranks; rethrowFailure() then makes it an agreed error. Success so costs no reduction.
///
/// Guarded by tests/unit/feti/test_dual_operator.cpp (symmetry, independence of ranks).
class DualOperator : public Operator {
 public:
  /// All to outlive this.
  DualOperator(const SubdomainSystem& system, const Constraints& constraints, const LocalInverses& inverses);

  Teuchos::RCP<const Map> getDomainMap() const override { return constraints_.rowMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return constraints_.rowMap(); }
  bool hasTransposeApply() const override { return true; }

  /// Y = αFX + βY. @note Collective.
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

  /// Throws on all ranks the failure of a local solve, if one was kept. @note Collective.
  void rethrowFailure() const;

 private:
  const SubdomainSystem& system_;
  const Constraints& constraints_;
  const LocalInverses& inverses_;
  mutable std::exception_ptr failure_;
};

} // namespace Harmos::feti
