// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ProjectedOperator.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti {

void ProjectedOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                              Scalar beta) const {
  MultiVector image(Y.getMap(), X.getNumVectors());
  if (onKernel_) {
    inner().apply(X, image);
  } else {
    MultiVector projected(X, Teuchos::Copy);
    coarse_.project(projected);
    inner().apply(projected, image);
  }
  coarse_.project(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

} // namespace Harmos::feti
