// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ProjectedOperator.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti {

void ProjectedOperator::applyTo(const MultiVector& X, MultiVector& Y) const {
  if (onKernel_) {
    inner().apply(X, Y);
  } else {
    MultiVector projected(X, Teuchos::Copy);
    coarse_.project(projected);
    inner().apply(projected, Y);
  }
  coarse_.project(Y);
}

} // namespace Harmos::feti
