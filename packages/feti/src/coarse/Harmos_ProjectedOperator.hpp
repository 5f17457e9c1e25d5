// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseSpace.hpp"

#include <Tpetra_Operator.hpp>

namespace Harmos::feti {

/// PFP as a Tpetra operator; or PF, which is the same on vectors with Gλ = 0 and saves a reduction.
class ProjectedOperator : public Operator {
 public:
  ProjectedOperator(const Operator& inner, const CoarseSpace& coarse, bool onKernel = false)
      : inner_(inner), coarse_(coarse), onKernel_(onKernel) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return inner_.getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Operator& inner_;
  const CoarseSpace& coarse_;
  bool onKernel_;
};

} // namespace Harmos::feti
