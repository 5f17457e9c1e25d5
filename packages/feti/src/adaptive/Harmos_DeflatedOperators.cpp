// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeflatedOperators.hpp"

#include "Harmos_ProjectedOperator.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti {

void DeflatedOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                             Scalar beta) const {
  if (alpha == 1.0 && beta == 0.0) {
    inner().apply(X, Y);
    deflation_.removeFromLoad(Y);
    return;
  }
  MultiVector image(Y.getMap(), X.getNumVectors());
  inner().apply(X, image);
  deflation_.removeFromLoad(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

void DeflatedPreconditioner::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                                   Scalar beta) const {
  MultiVector load(X, Teuchos::Copy), image(Y.getMap(), X.getNumVectors());
  deflation_.removeFromLoad(load);
  inner().apply(load, image);
  deflation_.removeSpan(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

DeflatedProblem::DeflatedProblem(const DualProblem& dual, const Operator& dualOperator, const Operator& kept,
                                 const CoarseSpace& coarse, const Deflation& deflation)
    : span(&deflation),
      unprojected(Teuchos::rcp(new DeflatedOperator(dualOperator, deflation))),
      hessian(unprojected),
      preconditioner(Teuchos::rcp(new DeflatedPreconditioner(kept, deflation))) {
  const auto load = Teuchos::rcp(new MultiVector(dual.d(), Teuchos::Copy));
  deflation.removeFromLoad(*load);
  if (coarse.dimension() > 0) {
    hessian = Teuchos::rcp(new ProjectedOperator(*unprojected, coarse));
    hessianOnKernel = Teuchos::rcp(new ProjectedOperator(*unprojected, coarse, true));
    coarse.project(*load);
  }
  rhs = load;
}

} // namespace Harmos::feti
