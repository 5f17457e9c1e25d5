// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_QpProblem.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_VectorOps.hpp"

namespace Harmos::qp {

/// H = A + ρCᵀC of a problem, and the pieces the augmented Lagrangian needs; counts its products with A.
template<class Scalar, class MV, class OP>
class AugmentedHessian {
 public:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using OPT = Belos::OperatorTraits<Scalar, MV, OP>;

  AugmentedHessian(const Problem<Scalar, MV, OP>& problem, Counters& counters)
      : problem_(problem), counters_(counters) {
    if (problem.hasEqualities()) {
      rows_ = MVT::Clone(*problem.equalityValues(), 1);
      image_ = MVT::Clone(*problem.solution(), 1);
    }
  }

  void setPenalty(double penalty) { penalty_ = penalty; }
  double penalty() const { return penalty_; }

  /// y = Hx.
  void apply(const MV& x, MV& y) {
    ++counters_.hessianApplications;
    OPT::Apply(*problem_.hessian(), x, y);
    if (!problem_.hasEqualities() || penalty_ == 0.0)
      return;
    OPT::Apply(*problem_.equalityRows(), x, *rows_);
    OPT::Apply(*problem_.equalityRows(), *rows_, *image_, Belos::TRANS);
    MVT::MvAddMv(1.0, y, penalty_, *image_, y);
  }

  /// r = Cx − c.
  void equalityResidual(const MV& x, MV& residual) {
    OPT::Apply(*problem_.equalityRows(), x, residual);
    MVT::MvAddMv(1.0, residual, -1.0, *problem_.equalityValues(), residual);
  }

  /// y ← y + factor · Cᵀr.
  void addTransposed(double factor, const MV& r, MV& y) {
    OPT::Apply(*problem_.equalityRows(), r, *image_, Belos::TRANS);
    MVT::MvAddMv(1.0, y, factor, *image_, y);
  }

 private:
  const Problem<Scalar, MV, OP>& problem_;
  Counters& counters_;
  double penalty_ = 0.0;
  Teuchos::RCP<MV> rows_;
  Teuchos::RCP<MV> image_;
};

} // namespace Harmos::qp
