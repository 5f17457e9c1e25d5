// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedLagrangian.hpp"
#include "Harmos_NormEstimate_def.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
BoundedLagrangian<Scalar, MV, OP>::BoundedLagrangian(const ProblemType& problem, const MprgpOptions& options,
                                                     Counters& counters)
    : problem_(problem), options_(options), counters_(counters), hessian_(problem, counters) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using OPT = Belos::OperatorTraits<Scalar, MV, OP>;
  gradient_ = MVT::Clone(*problem.solution(), 1);
  effectiveRhs_ = MVT::Clone(*problem.solution(), 1);
  work_ = MVT::Clone(*problem.solution(), 1);
  normA_ = problem.hessianNorm();
  if (normA_ == 0.0) {
    BoundTraits<Scalar, MV>::setRandom(*work_);
    const std::function<void(const MV&, MV&)> product = [&](const MV& x, MV& y) {
      OPT::Apply(*problem.hessian(), x, y);
    };
    normA_ = options.normSafety *
             estimateNorm<Scalar, MV>(product, *work_, options.normApplications, counters.setupApplications);
  }
  if (problem.hasEqualities()) {
    residual_ = MVT::Clone(*problem.equalityValues(), 1);
    if (problem.equalityStructure() == EqualityStructure::General) {
      Teuchos::RCP<MV> rows = MVT::Clone(*problem.equalityValues(), 1);
      const std::function<void(const MV&, MV&)> product = [&](const MV& x, MV& y) {
        OPT::Apply(*problem.equalityRows(), x, *rows);
        OPT::Apply(*problem.equalityRows(), *rows, y, Belos::TRANS);
      };
      int products = 0;
      BoundTraits<Scalar, MV>::setRandom(*work_);
      normRows2_ =
          options.normSafety * estimateNorm<Scalar, MV>(product, *work_, options.normApplications, products);
    } else {
      normRows2_ = 1.0;
    }
  }
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::augmentedNorm() const {
  const double fromRows = hessian_.penalty() * normRows2_;
  const double result = problem_.equalityStructure() == EqualityStructure::OrthonormalInvariant
                            ? std::max(normA_, fromRows)
                            : normA_ + fromRows;
  // A = 0 is a legal, if odd, Hessian; any step length will do then.
  return result > 0.0 ? result : 1.0;
}

// H x − effectiveRhs is the gradient: effectiveRhs = b − Cᵀμ + ρCᵀc.
template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::updateEffectiveRhs() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MVT::Assign(*problem_.rhs(), *effectiveRhs_);
  if (!problem_.hasEqualities())
    return;
  hessian_.addTransposed(-1.0, *problem_.multiplier(), *effectiveRhs_);
  hessian_.addTransposed(hessian_.penalty(), *problem_.equalityValues(), *effectiveRhs_);
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::start(double penalty) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MV& x = *problem_.solution();
  hessian_.setPenalty(penalty);
  BoundTraits<Scalar, MV>::project(x, problem_.lowerBound().get(), problem_.upperBound().get());
  updateEffectiveRhs();
  if (norm<Scalar>(x) > 0.0) {
    hessian_.apply(x, *gradient_);
    MVT::MvAddMv(1.0, *gradient_, -1.0, *effectiveRhs_, *gradient_);
  } else {
    MVT::MvAddMv(-1.0, *effectiveRhs_, 0.0, *effectiveRhs_, *gradient_);
  }
  iteration_ = Teuchos::rcp(new Iteration([this](const MV& in, MV& out) { hessian_.apply(in, out); },
                                          problem_.lowerBound().get(), problem_.upperBound().get(), options_,
                                          counters_));
  iteration_->start(problem_.solution(), gradient_, effectiveRhs_, augmentedNorm());
}

template<class Scalar, class MV, class OP>
IterationState<MV> BoundedLagrangian<Scalar, MV, OP>::evaluate(int outer, int inner) {
  IterationState<MV> state;
  state.x = problem_.solution().get();
  // Of L(·, μ, ρ), which is that of the Lagrangian with the multiplier μ + ρr: g(x, μ + ρr, 0) = g(x, μ, ρ).
  state.projectedGradient = std::sqrt(iteration_->sums().projectedNorm2());
  if (problem_.hasEqualities()) {
    hessian_.equalityResidual(*problem_.solution(), *residual_);
    state.equalityResidual = norm<Scalar>(*residual_);
  }
  state.outer = outer;
  state.inner = inner;
  state.counters = &counters_;
  return state;
}

template<class Scalar, class MV, class OP>
bool BoundedLagrangian<Scalar, MV, OP>::confirmGradient(double projectedGradient) {
  // Each step adds an error of about ε(‖H‖‖x‖ + ‖b‖) to the recurrence for g; independent errors add up like
  // the square root of their number.
  const double drift = std::sqrt(static_cast<double>(iteration_->staleness())) * attainableGradient();
  if (iteration_->staleness() == 0 || drift <= 0.1 * projectedGradient)
    return false;
  ++counters_.confirmations;
  iteration_->refreshGradient();
  iteration_->restart(iteration_->hessianNorm());
  return true;
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::updateMultiplier(double penalty) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MV& mu = *problem_.multiplier();
  hessian_.equalityResidual(*problem_.solution(), *residual_);
  MVT::MvAddMv(1.0, mu, hessian_.penalty(), *residual_, mu);
  // The new gradient Ax − b + Cᵀ(μ_new + ρ_new r) differs from the old one by ρ_new Cᵀr.
  hessian_.setPenalty(penalty);
  hessian_.addTransposed(penalty, *residual_, *gradient_);
  updateEffectiveRhs();
  iteration_->restart(std::max(augmentedNorm(), iteration_->hessianNorm()));
}

template<class Scalar, class MV, class OP>
void BoundedLagrangian<Scalar, MV, OP>::finish() {
  if (!problem_.hasEqualities())
    return;
  MV& mu = *problem_.multiplier();
  hessian_.equalityResidual(*problem_.solution(), *residual_);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, mu, hessian_.penalty(), *residual_, mu);
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::value() const {
  // With f(x) = ½xᵀ(Ax − b) − ½bᵀx and Ax − b = g − Cᵀ(μ + ρr):
  // L = ½xᵀ(g − b) + ½μᵀr − ½cᵀ(μ + ρr).
  const MV& x = *problem_.solution();
  double result = 0.5 * (dot<Scalar>(x, *gradient_) - dot<Scalar>(x, *problem_.rhs()));
  if (problem_.hasEqualities()) {
    const MV& mu = *problem_.multiplier();
    const MV& c = *problem_.equalityValues();
    result += 0.5 * dot<Scalar>(mu, *residual_) -
              0.5 * (dot<Scalar>(c, mu) + hessian_.penalty() * dot<Scalar>(c, *residual_));
  }
  return result;
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::attainableGradient() const {
  return std::numeric_limits<double>::epsilon() *
         (augmentedNorm() * norm<Scalar>(*problem_.solution()) + norm<Scalar>(*effectiveRhs_));
}

template<class Scalar, class MV, class OP>
double BoundedLagrangian<Scalar, MV, OP>::attainableEquality() const {
  if (!problem_.hasEqualities())
    return 0.0;
  return std::numeric_limits<double>::epsilon() *
         (std::sqrt(normRows2_) * norm<Scalar>(*problem_.solution()) +
          norm<Scalar>(*problem_.equalityValues()));
}

} // namespace Harmos::qp
