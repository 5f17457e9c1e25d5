// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Deflation.hpp"
#include "Harmos_EndomorphicOperator.hpp"

namespace Harmos::feti {

/// F' = (I − WUᵀ)F as a Tpetra operator: so taken from the product, rounding errors along W, where F is
/// largest, go with it.
class DeflatedOperator : public EndomorphicOperator {
 public:
  /// Both to outlive this.
  DeflatedOperator(const Operator& inner, const Deflation& deflation)
      : EndomorphicOperator(inner), deflation_(deflation) {}
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Deflation& deflation_;
};

/// (I − UWᵀ)M(I − WUᵀ): directions have no share in span(U), where M has its largest ones, F' has nothing and
/// iterates would drift away until rounding errors of what is taken from F are all that is left.
class DeflatedPreconditioner : public EndomorphicOperator {
 public:
  /// Both to outlive this.
  DeflatedPreconditioner(const Operator& inner, const Deflation& deflation)
      : EndomorphicOperator(inner), deflation_(deflation) {}
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Deflation& deflation_;
};

} // namespace Harmos::feti
