// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeflatedOperators.hpp"

#include "Harmos_ProjectedOperator.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti {

void DeflatedOperator::applyTo(const MultiVector& X, MultiVector& Y) const {
  inner().apply(X, Y);
  deflation_.removeFromLoad(Y);
}

void DeflatedPreconditioner::applyTo(const MultiVector& X, MultiVector& Y) const {
  MultiVector load(X, Teuchos::Copy);
  deflation_.removeFromLoad(load);
  inner().apply(load, Y);
  deflation_.removeSpan(Y);
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
