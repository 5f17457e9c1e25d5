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
    : hessian_{std::move(apply), std::move(precondition)},
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
  for (Teuchos::RCP<MV>* vector : {&along_.p, &along_.image, &work_.xOld, &work_.gOld, &work_.phi})
    *vector = MVT::Clone(*x, 1);
  if (hessian_.precondition)
    work_.z = MVT::Clone(*x, 1);
  active_.clear();
  staleness_ = 0;
  hessian_.curvatureScale = curvatureScale;
  discSize_ = feasible_.hasDiscs() ? BoundTraits<Scalar, MV>::maximum(*x, feasible_.discs->largest()) : 0.0;
  restart(hessianNorm);
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::restart(double hessianNorm) {
  hessian_.norm = hessianNorm;
  begin();
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::exchange(StateArchive<MV>& archive) {
  archive.vector("mprgp direction", *along_.p);
  archive.vector("mprgp image", *along_.image);
  archive.number("mprgp next", along_.next);
  archive.number("mprgp free norm", sums_.freeNorm2);
  archive.number("mprgp chopped norm", sums_.choppedNorm2);
  archive.number("mprgp reduced norm", sums_.reducedNorm2);
  archive.number("mprgp iterate norm", sums_.xNorm2);
  archive.number("mprgp hessian norm", hessian_.norm);
  archive.number("mprgp longest step", along_.longestStep);
  archive.number("mprgp direction dot image", along_.dotImage);
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
  along_.longestStep = sums_.longestStep;
  along_.next = hessian_.precondition ? Next::Fresh : Next::Ready;
  countFace();
}

// p ← z or p ← z − βp with z = (M⁻¹φ)_F.
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::completeDirection() {
  if (along_.next == Next::Ready)
    return;
  hessian_.precondition(*work_.phi, active_, faceChanged_, *work_.z);
  faceChanged_ = false;
  const double beta =
      along_.next == Next::Conjugate ? dot<Scalar>(*work_.z, *along_.image) / along_.dotImage : 0.0;
  along_.longestStep = BoundOps<Scalar, MV>::conjugate(*x_, *work_.z, beta, feasible_, *along_.p);
  along_.next = Next::Ready;
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::refreshGradient() {
  hessian_.apply(*x_, *g_);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *g_, -1.0, *b_, *g_);
  staleness_ = 0;
}

template<class Scalar, class MV>
bool MprgpIteration<Scalar, MV>::expandProjected(double cgStep) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  MVT::Assign(*g_, *work_.gOld);
  const int staleBefore = staleness_;
  Bounds::projectedStep(*x_, *work_.xOld, *along_.p, cgStep, feasible_);
  refreshGradient();
  const ChangeSums change = Bounds::change(*x_, *work_.xOld, *g_, *work_.gOld);
  if (change.cost < 0.0) {
    decrease_ = -change.cost;
    return true;
  }
  ++counters_.fallbacks;
  MVT::Assign(*work_.xOld, *x_);
  MVT::Assign(*work_.gOld, *g_);
  staleness_ = staleBefore;
  return false;
}

// To the boundary along p, then x ← Π(x − ᾱφ).
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::expandFixed(const CurvatureSums& along) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  const double length = along_.longestStep;
  decrease_ = length * (along.gradientDotDirection - 0.5 * length * along.directionDotImage);
  // The set examined at the boundary point is not a face the iteration works in.
  ActiveFace boundary = active_;
  Bounds::advance(*x_, *g_, *along_.p, *along_.image, length, 0.0, true, feasible_, stepLength(), *work_.phi,
                  boundary);
  MVT::Assign(*g_, *work_.gOld);
  goDown(*work_.phi);
}

// x ← Π(x − ᾱ·direction), where the gradient is that of work_.gOld.
template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::goDown(const MV& direction) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  constexpr int mostCuts = 60;
  for (int cut = 0; cut <= mostCuts; ++cut) {
    if (cut > 0)
      MVT::Assign(*work_.xOld, *x_);
    Bounds::projectedStep(*x_, *work_.xOld, direction, stepLength(), feasible_);
    refreshGradient();
    // The projected step decreases the cost for every ᾱ ≤ 2/‖H‖: if it rose, ‖H‖ is larger than estimated.
    // Changes at the level of rounding errors prove nothing.
    const ChangeSums change = Bounds::change(*x_, *work_.xOld, *g_, *work_.gOld);
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
    hessian_.norm *= 2.0;
  }
  // No step is short enough, which only rounding errors can bring about: stay at the boundary.
  MVT::Assign(*work_.xOld, *x_);
  MVT::Assign(*work_.gOld, *g_);
}

// Along the rim of a disc no step is feasible: the projected gradient step of MPGP takes the place of the
// proportioning one.
template<class Scalar, class MV>
typename MprgpIteration<Scalar, MV>::Outcome MprgpIteration<Scalar, MV>::proportionBySteps() {
  if (!std::isfinite(sums_.choppedNorm2))
    return Outcome::Breakdown;
  Belos::MultiVecTraits<Scalar, MV>::Assign(*g_, *work_.gOld);
  decrease_ = 0.0;
  ++counters_.proportioningSteps;
  ++staleness_;
  goDown(*work_.gOld);
  begin();
  return Outcome::Proportioning;
}

// Of pᵀHp/‖p‖², from the terms that it is a sum of.
template<class Scalar, class MV>
double MprgpIteration<Scalar, MV>::roundingOfCurvature() const {
  return 100.0 * std::numeric_limits<double>::epsilon() *
         curvatureTerms<Scalar, MV>(hessian_.apply, *along_.p);
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
    along_.longestStep = Bounds::choppedDirection(*x_, *g_, feasible_, *along_.p);

  hessian_.apply(*along_.p, *along_.image);
  CurvatureSums along = Bounds::curvature(*g_, *along_.p, *along_.image, active_);
  // Rounding errors, or a preconditioner that is not positive definite, have turned the direction upwards or
  // across; −φ always leads down.
  constexpr double across = 1e-10;
  if (proportional && sums_.freeNorm2 > 0.0 &&
      !(along.gradientDotDirection > across * std::sqrt(along.directionNorm2 * sums_.freeNorm2))) {
    if (hessian_.precondition)
      along_.longestStep = Bounds::conjugate(*x_, *work_.phi, 0.0, feasible_, *along_.p);
    else
      begin();
    hessian_.apply(*along_.p, *along_.image);
    along = Bounds::curvature(*g_, *along_.p, *along_.image, active_);
  }
  if (!std::isfinite(along.directionDotImage) || !std::isfinite(along.gradientDotDirection))
    return Outcome::Breakdown;
  if (!(along.directionNorm2 > 0.0))
    return Outcome::Breakdown;
  const double curvature = along.directionDotImage / along.directionNorm2;
  hessian_.norm = std::max(hessian_.norm, curvature);
  // Rounding errors of Ap: below this level, the sign of the curvature means nothing. A penalty's part of Hp
  // has none: along a direction that it does not resist, it is a square of rounding errors.
  const double flat = 100.0 * epsilon * hessian_.curvatureScale;
  if (curvature < -flat)
    return Outcome::Breakdown;
  const bool isFlat = curvature <= flat && curvature <= roundingOfCurvature();
  if (isFlat && !std::isfinite(along_.longestStep))
    return Outcome::Unbounded;
  const double cgStep =
      isFlat ? std::numeric_limits<double>::infinity() : along.gradientDotDirection / along.directionDotImage;
  const bool feasible = cgStep < along_.longestStep;
  const double length = std::min(cgStep, along_.longestStep);

  if (!proportional || feasible) {
    decrease_ = length * (along.gradientDotDirection - 0.5 * length * along.directionDotImage);
    // The β of the next direction, before its φ is there.
    const bool conjugate = proportional && !hessian_.precondition;
    const double beta =
        conjugate ? (along.freeDotImage - length * along.freeImageNorm2) / along.directionDotImage : 0.0;
    sums_ = Bounds::advance(*x_, *g_, *along_.p, *along_.image, length, beta, !feasible, feasible_,
                            stepLength(), freeGradient(), active_);
    along_.longestStep = sums_.longestStep;
    ++staleness_;
    countFace();
    along_.dotImage = along.directionDotImage;
    if (!proportional) {
      // Towards the inside of an active bound; only another bound, on the far side, can cut the step.
      ++counters_.proportioningSteps;
      along_.next = hessian_.precondition ? Next::Fresh : Next::Ready;
      return Outcome::Proportioning;
    }
    ++counters_.cgSteps;
    along_.next = hessian_.precondition ? Next::Conjugate : Next::Ready;
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
