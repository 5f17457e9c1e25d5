// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Types.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

namespace Harmos::feti {

/// An operator made from another one on the same space: what PFP and deflated operators have in common.
class EndomorphicOperator : public Operator {
 public:
  Teuchos::RCP<const Map> getDomainMap() const override { return inner_.getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp = Teuchos::NO_TRANS, Scalar alpha = 1.0,
             Scalar beta = 0.0) const final {
    if (alpha == 1.0 && beta == 0.0)
      return applyTo(X, Y);
    MultiVector image(Y.getMap(), X.getNumVectors());
    applyTo(X, image);
    if (beta == 0.0)
      Y.scale(alpha, image);
    else
      Y.update(alpha, image, beta);
  }

 protected:
  /// Y ← the operator of X, whatever Y was.
  virtual void applyTo(const MultiVector& X, MultiVector& Y) const = 0;
  /// To outlive this.
  explicit EndomorphicOperator(const Operator& inner) : inner_(inner) {}
  const Operator& inner() const { return inner_; }

 private:
  const Operator& inner_;
};

} // namespace Harmos::feti
