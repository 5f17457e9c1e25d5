// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_CurvatureTerms.hpp"
#include "Harmos_MprgpIteration.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV>
MprgpIteration<Scalar, MV>::MprgpIteration(Apply apply, Precondition precondition,
                                           const FeasibleSet<MV>& feasible, const MprgpOptions& options,
                                           Counters& counters)
    : apply_(std::move(apply)),
      precondition_(std::move(precondition)),
      feasible_(feasible),
      options_(options),
      counters_(counters) {}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::start(Teuchos::RCP<MV> x, Teuchos::RCP<MV> gradient,
                                       Teuchos::RCP<const MV> rhs, double hessianNorm,
                                       double curvatureScale) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  x_ = x;
  g_ = gradient;
  b_ = rhs;
  for (Teuchos::RCP<MV>* vector : {&p_, &image_, &xOld_, &gOld_, &phi_})
    *vector = MVT::Clone(*x, 1);
  if (precondition_)
    z_ = MVT::Clone(*x, 1);
  active_.clear();
  staleness_ = 0;
  curvatureScale_ = curvatureScale;
  discSize_ = feasible_.hasDiscs() ? BoundTraits<Scalar, MV>::maximum(*x, feasible_.discs->largest()) : 0.0;
  restart(hessianNorm);
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::restart(double hessianNorm) {
  hessianNorm_ = hessianNorm;
  begin();
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::exchange(StateArchive<MV>& archive) {
  archive.vector("mprgp direction", *p_);
  archive.vector("mprgp image", *image_);
  archive.number("mprgp next", next_);
  archive.number("mprgp free norm", sums_.freeNorm2);
  archive.number("mprgp chopped norm", sums_.choppedNorm2);
  archive.number("mprgp reduced norm", sums_.reducedNorm2);
  archive.number("mprgp iterate norm", sums_.xNorm2);
  archive.number("mprgp hessian norm", hessianNorm_);
  archive.number("mprgp longest step", longestStep_);
  archive.number("mprgp direction dot image", directionDotImage_);
  archive.number("mprgp decrease", decrease_);
  archive.number("mprgp staleness", staleness_);
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::countFace() {
  if (sums_.changed > 0 || counters_.faces == 0)
    ++counters_.faces;
  faceChanged_ = faceChanged_ || sums_.changed > 0;
}

// The splitting at x, and p = φ; preconditioned, the direction is made when a step needs it.
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::begin() {
  sums_ = BoundOps<Scalar, MV>::split(*x_, *g_, feasible_, stepLength(), &freeGradient(), active_);
  longestStep_ = sums_.longestStep;
  next_ = precondition_ ? Next::Fresh : Next::Ready;
  countFace();
}

// p ← z or p ← z − βp with z = (M⁻¹φ)_F.
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::completeDirection() {
  if (next_ == Next::Ready)
    return;
  precondition_(*phi_, active_, faceChanged_, *z_);
  faceChanged_ = false;
  const double beta = next_ == Next::Conjugate ? dot<Scalar>(*z_, *image_) / directionDotImage_ : 0.0;
  longestStep_ = BoundOps<Scalar, MV>::conjugate(*x_, *z_, beta, feasible_, *p_);
  next_ = Next::Ready;
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::refreshGradient() {
  apply_(*x_, *g_);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *g_, -1.0, *b_, *g_);
  staleness_ = 0;
}

template<class Scalar, class MV>
bool MprgpIteration<Scalar, MV>::expandProjected(double cgStep) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  MVT::Assign(*g_, *gOld_);
  const int staleBefore = staleness_;
  Bounds::projectedStep(*x_, *xOld_, *p_, cgStep, feasible_);
  refreshGradient();
  const ChangeSums change = Bounds::change(*x_, *xOld_, *g_, *gOld_);
  if (change.cost < 0.0) {
    decrease_ = -change.cost;
    return true;
  }
  ++counters_.fallbacks;
  MVT::Assign(*xOld_, *x_);
  MVT::Assign(*gOld_, *g_);
  staleness_ = staleBefore;
  return false;
}

// To the boundary along p, then x ← Π(x − ᾱφ).
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::expandFixed(const CurvatureSums& along) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  const double length = longestStep_;
  decrease_ = length * (along.gradientDotDirection - 0.5 * length * along.directionDotImage);
  // The set examined at the boundary point is not a face the iteration works in.
  ActiveFace boundary = active_;
  Bounds::advance(*x_, *g_, *p_, *image_, length, 0.0, true, feasible_, stepLength(), *phi_, boundary);
  MVT::Assign(*g_, *gOld_);
  goDown(*phi_);
}

// x ← Π(x − ᾱ·direction), where the gradient is that of gOld_.
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::goDown(const MV& direction) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  constexpr int mostCuts = 60;
  for (int cut = 0; cut <= mostCuts; ++cut) {
    if (cut > 0)
      MVT::Assign(*xOld_, *x_);
    Bounds::projectedStep(*x_, *xOld_, direction, stepLength(), feasible_);
    refreshGradient();
    // The projected step decreases the cost for every ᾱ ≤ 2/‖H‖: if it rose, ‖H‖ is larger than estimated.
    // Changes at the level of rounding errors prove nothing.
    const ChangeSums change = Bounds::change(*x_, *xOld_, *g_, *gOld_);
    double noise =
        10.0 * std::numeric_limits<double>::epsilon() * std::sqrt(change.moved2 * change.gradientNorm2);
    // Points on rims are there to rounding errors, along gradients that do not vanish.
    noise += 10.0 * std::numeric_limits<double>::epsilon() * discSize_ *
             std::sqrt(static_cast<double>(sums_.active) * change.gradientNorm2);
    if (!(change.cost > noise)) {
      decrease_ -= change.cost;
      return;
    }
    ++counters_.stepCuts;
    hessianNorm_ *= 2.0;
  }
  // No step is short enough, which only rounding errors can bring about: stay at the boundary.
  MVT::Assign(*xOld_, *x_);
  MVT::Assign(*gOld_, *g_);
}

// Along the rim of a disc no step is feasible: the projected gradient step of MPGP takes the place of the
// proportioning one.
template<class Scalar, class MV>
typename MprgpIteration<Scalar, MV>::Outcome MprgpIteration<Scalar, MV>::proportionBySteps() {
  if (!std::isfinite(sums_.choppedNorm2))
    return Outcome::Breakdown;
  Belos::MultiVecTraits<Scalar, MV>::Assign(*g_, *gOld_);
  decrease_ = 0.0;
  ++counters_.proportioningSteps;
  ++staleness_;
  goDown(*gOld_);
  begin();
  return Outcome::Proportioning;
}

// Of pᵀHp/‖p‖², from the terms that it is a sum of.
template<class Scalar, class MV>
double MprgpIteration<Scalar, MV>::roundingOfCurvature() const {
  return 100.0 * std::numeric_limits<double>::epsilon() * curvatureTerms<Scalar, MV>(apply_, *p_);
}

template<class Scalar, class MV>
typename MprgpIteration<Scalar, MV>::Outcome MprgpIteration<Scalar, MV>::step() {
  using Bounds = BoundOps<Scalar, MV>;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();

  const bool proportional = sums_.choppedNorm2 <= options_.gamma * options_.gamma * sums_.reducedNorm2;
  if (!proportional && feasible_.hasDiscs())
    return proportionBySteps();
  if (proportional)
    completeDirection();
  else
    longestStep_ = Bounds::choppedDirection(*x_, *g_, feasible_, *p_);

  apply_(*p_, *image_);
  CurvatureSums along = Bounds::curvature(*g_, *p_, *image_, active_);
  // Rounding errors, or a preconditioner that is not positive definite, have turned the direction upwards or
  // across; −φ always leads down.
  constexpr double across = 1e-10;
  if (proportional && sums_.freeNorm2 > 0.0 &&
      !(along.gradientDotDirection > across * std::sqrt(along.directionNorm2 * sums_.freeNorm2))) {
    if (precondition_)
      longestStep_ = Bounds::conjugate(*x_, *phi_, 0.0, feasible_, *p_);
    else
      begin();
    apply_(*p_, *image_);
    along = Bounds::curvature(*g_, *p_, *image_, active_);
  }
  if (!std::isfinite(along.directionDotImage) || !std::isfinite(along.gradientDotDirection))
    return Outcome::Breakdown;
  if (!(along.directionNorm2 > 0.0))
    return Outcome::Breakdown;
  const double curvature = along.directionDotImage / along.directionNorm2;
  hessianNorm_ = std::max(hessianNorm_, curvature);
  // Rounding errors of Ap: below this level, the sign of the curvature means nothing. A penalty's part of Hp
  // has none: along a direction that it does not resist, it is a square of rounding errors.
  const double flat = 100.0 * epsilon * curvatureScale_;
  if (curvature < -flat)
    return Outcome::Breakdown;
  const bool isFlat = curvature <= flat && curvature <= roundingOfCurvature();
  if (isFlat && !std::isfinite(longestStep_))
    return Outcome::Unbounded;
  const double cgStep =
      isFlat ? std::numeric_limits<double>::infinity() : along.gradientDotDirection / along.directionDotImage;
  const bool feasible = cgStep < longestStep_;
  const double length = std::min(cgStep, longestStep_);

  if (!proportional || feasible) {
    decrease_ = length * (along.gradientDotDirection - 0.5 * length * along.directionDotImage);
    // The β of the next direction, before its φ is there.
    const bool conjugate = proportional && !precondition_;
    const double beta =
        conjugate ? (along.freeDotImage - length * along.freeImageNorm2) / along.directionDotImage : 0.0;
    sums_ = Bounds::advance(*x_, *g_, *p_, *image_, length, beta, !feasible, feasible_, stepLength(),
                            freeGradient(), active_);
    longestStep_ = sums_.longestStep;
    ++staleness_;
    countFace();
    directionDotImage_ = along.directionDotImage;
    if (!proportional) {
      // Towards the inside of an active bound; only another bound, on the far side, can cut the step.
      ++counters_.proportioningSteps;
      next_ = precondition_ ? Next::Fresh : Next::Ready;
      return Outcome::Proportioning;
    }
    ++counters_.cgSteps;
    next_ = precondition_ ? Next::Conjugate : Next::Ready;
    // Rounding put an entry onto its bound: p is no longer conjugate within the face.
    if (sums_.changed > 0)
      begin();
    return Outcome::ConjugateGradient;
  }

  ++counters_.expansionSteps;
  ++staleness_;
  const bool projected = options_.expansion == Expansion::ProjectedConjugateGradient && !isFlat;
  if (!projected || !expandProjected(cgStep))
    expandFixed(along);
  begin();
  return Outcome::Expansion;
}

} // namespace Harmos::qp
