// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundedLagrangian.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FaceArchive.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_MprgpIteration_def.hpp"
#include "Harmos_NormEstimate_def.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
BoundedLagrangian<Scalar, MV, OP>::BoundedLagrangian(const ProblemType& problem,
                                                     EqualityRows<Scalar, MV, OP>& rows,
                                                     const MprgpOptions& options, Counters& counters,
                                                     bool resumes)
    : problem_(problem),
      rows_(rows),
      options_(options),
      counters_(counters),
      preconditioner_(problem, counters) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using OPT = Belos::OperatorTraits<Scalar, MV, OP>;
  gradient_ = MVT::Clone(*problem.solution(), 1);
  rhs_.vector = MVT::Clone(*problem.solution(), 1);
  normA_ = problem.hessianNorm();
  if (normA_ == 0.0 && !resumes) {
    BoundOps<Scalar, MV>::setRandom(*gradient_);
    const std::function<void(const MV&, MV&)> product = [&](const MV& x, MV& y) {
      OPT::Apply(*problem.hessian(), x, y);
    };
    normA_ = options.normSafety * estimateNorm<Scalar, MV>(product, *gradient_, options.normApplications,
                                                           counters.setupApplications);
  }
  if (rows_.isPresent()) {
    mu_ = rows_.makeVector();
    residual_.vector = rows_.makeVector();
    work_.rows = rows_.makeVector();
  }
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::augmentedNorm() const {
  const double fromRows = penalty_ * rows_.norm2();
  const double result = rows_.isInvariant() ? std::max(normA_, fromRows) : normA_ + fromRows;
  // A = 0 is a legal, if odd, Hessian; any step length will do then.
  return result > 0.0 ? result : 1.0;
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::applyHessian(const MV& x, MV& y) {
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), x, y);
  if (!rows_.isPresent() || penalty_ == 0.0)
    return;
  rows_.apply(x, *work_.rows);
  rows_.addTransposed(penalty_, *work_.rows, y);
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::applyPreconditioner(const MV& phi, const ActiveFace& active, MV& z) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (!rows_.isPresent() || !rows_.isOrthonormal() || penalty_ == 0.0) {
    preconditioner_.apply(phi, active, z);
    return;
  }
  if (work_.projected.is_null()) {
    work_.projected = MVT::Clone(phi, 1);
    work_.removed = rows_.makeVector();
  }
  MVT::Assign(phi, *work_.projected);
  rows_.apply(phi, *work_.removed);
  rows_.addTransposed(-1.0, *work_.removed, *work_.projected);
  FaceOps<Scalar, MV>::mask(*work_.projected, active);
  preconditioner_.apply(*work_.projected, active, z);
  rows_.apply(z, *work_.rows);
  rows_.addTransposed(-1.0, *work_.rows, z);
  rows_.addTransposed(1.0 / penalty_, *work_.removed, z);
  FaceOps<Scalar, MV>::mask(z, active);
}

// Hx − effectiveRhs is the gradient: effectiveRhs = b − C̄ᵀμ + ρC̄ᵀc̄.
template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::updateEffectiveRhs() {
  Belos::MultiVecTraits<Scalar, MV>::Assign(*problem_.rhs(), *rhs_.vector);
  if (!rows_.isPresent())
    return;
  rows_.addTransposed(-1.0, *mu_, *rhs_.vector);
  rows_.addTransposed(penalty_, rows_.values(), *rhs_.vector);
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::start(double penalty) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MV& x = *problem_.solution();
  penalty_ = penalty;
  BoundOps<Scalar, MV>::project(x, problem_.feasibleSet());
  if (rows_.isPresent())
    rows_.toInternal(*problem_.multiplier(), *mu_);
  updateEffectiveRhs();
  if (norm<Scalar>(x) > 0.0) {
    applyHessian(x, *gradient_);
    MVT::MvAddMv(1.0, *gradient_, -1.0, *rhs_.vector, *gradient_);
  } else {
    MVT::MvAddMv(-1.0, *rhs_.vector, 0.0, *rhs_.vector, *gradient_);
  }
  startIteration();
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::exchange(StateArchive<MV>& archive) {
  archive.vector("x", *problem_.solution());
  archive.vector("gradient", *gradient_);
  exchangeActive(archive);
  if (rows_.isPresent())
    archive.rowVector("multiplier", *mu_);
  archive.number("penalty", penalty_);
  archive.number("hessian norm", normA_);
  double level = level_;
  bool direct = direct_;
  archive.number("rounding level", level);
  archive.number("gradient is direct", direct);
  if (archive.isReading()) {
    updateEffectiveRhs();
    startIteration();
    level_ = level;
    direct_ = direct;
  }
  iteration_->exchange(archive);
}

// Entries at a bound are to be there to the last bit also where another number of ranks has rounded the
// bounds differently.
template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::exchangeActive(StateArchive<MV>& archive) {
  MV& x = *problem_.solution();
  ActiveFace face;
  if (!archive.isReading())
    face = iteration_->active();
  FaceArchive<Scalar, MV>(archive, "mprgp", x).exchange(face);
  if (!archive.isReading())
    return;
  BoundOps<Scalar, MV>::project(x, problem_.feasibleSet());
  BlockOps<Scalar, MV>::moveToFace(problem_.feasibleSet(), face, x);
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::startIteration() {
  typename Iteration::Precondition precondition;
  if (preconditioner_.isPresent())
    precondition = [this](const MV& phi, const ActiveFace& active, bool changed, MV& z) {
      if (changed)
        preconditioner_.invalidate();
      applyPreconditioner(phi, active, z);
    };
  iteration_ = Teuchos::rcp(new Iteration([this](const MV& in, MV& out) { applyHessian(in, out); },
                                          precondition, problem_.feasibleSet(), options_, counters_));
  rhs_.norm = norm<Scalar>(*rhs_.vector);
  level_ = 0.0;
  direct_ = false;
  iteration_->start(problem_.solution(), gradient_, rhs_.vector, augmentedNorm(),
                    normA_ > 0.0 ? normA_ : 1.0);
}

template<class Scalar, class MV, class OP>
IterationState<MV> BoundedLagrangian<Scalar, MV, OP>::evaluate(int outer, int inner) {
  IterationState<MV> state;
  state.x = problem_.solution().get();
  // Of L(·, μ, ρ), which is that of the Lagrangian with the multiplier μ + ρr: g(x, μ + ρr, 0) = g(x, μ, ρ).
  state.projectedGradient = std::sqrt(iteration_->sums().projectedNorm2());
  if (rows_.isPresent()) {
    rows_.residual(*problem_.solution(), *residual_.vector);
    residual_.norm = norm<Scalar>(*residual_.vector);
    state.equalityResidual = rows_.residualNorm();
    state.equalityDistance = rows_.distance();
  }
  state.decrease = decrease();
  level_ = std::max(level_, attainableGradient());
  state.outer = outer;
  state.inner = inner;
  state.counters = &counters_;
  return state;
}

template<class Scalar, class MV, class OP>
bool BoundedLagrangian<Scalar, MV, OP>::confirmGradient(double projectedGradient) {
  // Each step adds an error of about ε(‖H‖‖x‖ + ‖b‖) to the recurrence for g, of the largest x on the way;
  // independent errors add up like the square root of their number.
  const double drift = std::sqrt(std::max(1.0, static_cast<double>(iteration_->staleness()))) * level_;
  if (direct_ || drift <= 0.1 * projectedGradient)
    return false;
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  ++counters_.confirmations;
  ++counters_.hessianApplications;
  // With the very multiplier that is returned: what its residual is off by, it is off by in both.
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *problem_.solution(), *gradient_);
  MVT::MvAddMv(1.0, *gradient_, -1.0, *problem_.rhs(), *gradient_);
  if (rows_.isPresent()) {
    rows_.residual(*problem_.solution(), *residual_.vector);
    MVT::MvAddMv(1.0, *mu_, penalty_, *residual_.vector, *work_.rows);
    rows_.addTransposed(1.0, *work_.rows, *gradient_);
  }
  iteration_->restart(iteration_->hessianNorm());
  direct_ = true;
  level_ = attainableGradient();
  return true;
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::updateMultiplier(double penalty, double factor) {
  rows_.residual(*problem_.solution(), *residual_.vector);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *mu_, factor * penalty_, *residual_.vector, *mu_);
  // The new gradient Ax − b + C̄ᵀ(μ_new + ρ_new r) differs from the old one by (ρ_new + (factor − 1)ρ)C̄ᵀr.
  rows_.addTransposed(penalty + (factor - 1.0) * penalty_, *residual_.vector, *gradient_);
  penalty_ = penalty;
  updateEffectiveRhs();
  rhs_.norm = norm<Scalar>(*rhs_.vector);
  direct_ = false;
  iteration_->restart(std::max(augmentedNorm(), iteration_->hessianNorm()));
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::storeMultiplier() {
  if (!rows_.isPresent())
    return;
  rows_.residual(*problem_.solution(), *residual_.vector);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *mu_, penalty_, *residual_.vector, *work_.rows);
  rows_.toUser(*work_.rows, *problem_.multiplier());
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<MV> BoundedLagrangian<Scalar, MV, OP>::unboundedDirection(Certificate& certificate) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using OPT = Belos::OperatorTraits<Scalar, MV, OP>;
  const Teuchos::RCP<MV> d = MVT::CloneCopy(iteration_->direction());
  MVT::MvScale(*d, -1.0);
  BlockOps<Scalar, MV>::recede(problem_.blocks(), *d);
  MVT::MvScale(*d, 1.0 / norm<Scalar>(*d));
  ++counters_.hessianApplications;
  OPT::Apply(*problem_.hessian(), *d, *gradient_);
  certificate.gap = dot<Scalar>(*problem_.rhs(), *d);
  certificate.defect = normA_ > 0.0 ? norm<Scalar>(*gradient_) / normA_ : 0.0;
  if (rows_.isPresent()) {
    rows_.apply(*d, *work_.rows);
    certificate.defect = std::max(certificate.defect, norm<Scalar>(*work_.rows) / std::sqrt(rows_.norm2()));
  }
  return d;
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::value() const {
  // With f(x) = ½xᵀ(Ax − b) − ½bᵀx and Ax − b = g − C̄ᵀ(μ + ρr):
  // L = ½xᵀ(g − b) + ½μᵀr − ½c̄ᵀ(μ + ρr).
  const MV& x = *problem_.solution();
  double result = 0.5 * (dot<Scalar>(x, *gradient_) - dot<Scalar>(x, *problem_.rhs()));
  if (rows_.isPresent())
    result +=
        0.5 * dot<Scalar>(*mu_, *residual_.vector) -
        0.5 * (dot<Scalar>(rows_.values(), *mu_) + penalty_ * dot<Scalar>(rows_.values(), *residual_.vector));
  return result;
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::attainableGradient() const {
  return std::numeric_limits<double>::epsilon() *
         (augmentedNorm() * std::sqrt(iteration_->sums().xNorm2) + rhs_.norm);
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::attainableEquality() const {
  if (!rows_.isPresent())
    return 0.0;
  return std::numeric_limits<double>::epsilon() *
         (std::sqrt(rows_.norm2() * iteration_->sums().xNorm2) + rows_.valuesNorm());
}

} // namespace Harmos::qp
