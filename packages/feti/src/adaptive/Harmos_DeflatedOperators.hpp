// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Deflation.hpp"
#include "Harmos_DualProblem.hpp"
#include "Harmos_EndomorphicOperator.hpp"

namespace Harmos::feti {

/// F' = (I − WUᵀ)F as a Tpetra operator: so taken from the product, rounding errors along W, where F is
/// largest, go with it.
class DeflatedOperator : public EndomorphicOperator {
 public:
  DeflatedOperator(const Operator& inner, const Deflation& deflation)
      : EndomorphicOperator(inner), deflation_(deflation) {}

 private:
  void applyTo(const MultiVector& X, MultiVector& Y) const override;
  const Deflation& deflation_;
};

/// (I − UWᵀ)M(I − WUᵀ): directions have no share in span(U), where M has its largest ones, F' has nothing and
/// iterates would drift away until rounding errors of what is taken from F are all that is left.
class DeflatedPreconditioner : public EndomorphicOperator {
 public:
  DeflatedPreconditioner(const Operator& inner, const Deflation& deflation)
      : EndomorphicOperator(inner), deflation_(deflation) {}

 private:
  void applyTo(const MultiVector& X, MultiVector& Y) const override;
  const Deflation& deflation_;
};

/// What is left of a dual problem without the span of adaptive vectors.
struct DeflatedProblem {
  /// All to outlive this, and what is made of it. @param dualOperator F, not projected.
  DeflatedProblem(const DualProblem& dual, const Operator& dualOperator, const Operator& preconditioner,
                  const CoarseSpace& coarse, const Deflation& deflation);

  const Deflation* span;
  Teuchos::RCP<const Operator> unprojected;              ///< F'
  Teuchos::RCP<const Operator> hessian, hessianOnKernel; ///< PF'P, PF'; without a coarse problem F', null
  Teuchos::RCP<const Operator> preconditioner;
  Teuchos::RCP<const MultiVector> rhs; ///< projected likewise
};

} // namespace Harmos::feti
