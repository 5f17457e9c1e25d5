// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_MprgpIteration.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV>
MprgpIteration<Scalar, MV>::MprgpIteration(Apply apply, const MV* lower, const MV* upper,
                                           const MprgpOptions& options, Counters& counters)
    : apply_(std::move(apply)), lower_(lower), upper_(upper), options_(options), counters_(counters) {}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::start(Teuchos::RCP<MV> x, Teuchos::RCP<MV> gradient,
                                       Teuchos::RCP<const MV> rhs, double hessianNorm) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  x_ = x;
  g_ = gradient;
  b_ = rhs;
  for (Teuchos::RCP<MV>* vector : {&p_, &image_, &phi_, &xOld_, &gOld_, &work_})
    *vector = MVT::Clone(*x, 1);
  active_.clear();
  staleness_ = 0;
  restart(hessianNorm);
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::restart(double hessianNorm) {
  hessianNorm_ = hessianNorm;
  split(nullptr);
  Belos::MultiVecTraits<Scalar, MV>::Assign(*phi_, *p_);
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::split(const MV* image) {
  sums_ = BoundTraits<Scalar, MV>::split(*x_, *g_, lower_, upper_, options_.stepFactor / hessianNorm_, image,
                                         *phi_, active_);
  if (sums_.changed > 0 || counters_.faces == 0)
    ++counters_.faces;
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::refreshGradient() {
  apply_(*x_, *g_);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *g_, -1.0, *b_, *g_);
  staleness_ = 0;
}

// f(x) − f(x_old) = ½ (x − x_old)ᵀ(g + g_old), exact for a quadratic: free of the cancellation in the
// difference of two costs.
template<class Scalar, class MV>
double MprgpIteration<Scalar, MV>::costChange(const MV& xOld, const MV& gOld) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MVT::MvAddMv(1.0, *x_, -1.0, xOld, *work_);
  return 0.5 * (dot<Scalar>(*work_, *g_) + dot<Scalar>(*work_, gOld));
}

template<class Scalar, class MV>
bool MprgpIteration<Scalar, MV>::expandProjected(double cgStep) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MVT::Assign(*x_, *xOld_);
  MVT::Assign(*g_, *gOld_);
  const int staleBefore = staleness_;
  MVT::MvAddMv(1.0, *x_, -cgStep, *p_, *x_);
  BoundTraits<Scalar, MV>::project(*x_, lower_, upper_);
  refreshGradient();
  if (costChange(*xOld_, *gOld_) < 0.0)
    return true;
  ++counters_.fallbacks;
  MVT::Assign(*xOld_, *x_);
  MVT::Assign(*gOld_, *g_);
  staleness_ = staleBefore;
  return false;
}

template<class Scalar, class MV>
void MprgpIteration<Scalar, MV>::expandFixed(double longestStep) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  BT::stepToBoundary(*x_, *p_, longestStep, lower_, upper_);
  MVT::MvAddMv(1.0, *g_, -longestStep, *image_, *g_);
  MVT::Assign(*x_, *xOld_);
  MVT::Assign(*g_, *gOld_);
  // φ at the boundary point; the set examined there is not a face the iteration works in.
  LocalActiveSet boundary = active_;
  BT::split(*x_, *g_, lower_, upper_, options_.stepFactor / hessianNorm_, nullptr, *phi_, boundary);
  constexpr int mostCuts = 60;
  for (int cut = 0; cut <= mostCuts; ++cut) {
    MVT::MvAddMv(1.0, *xOld_, -options_.stepFactor / hessianNorm_, *phi_, *x_);
    BT::project(*x_, lower_, upper_);
    refreshGradient();
    // The projected step decreases the cost for every ᾱ ≤ 2/‖H‖: if it rose, ‖H‖ is larger than estimated.
    // Changes at the level of rounding errors prove nothing.
    const double change = costChange(*xOld_, *gOld_);
    const double moved = norm<Scalar>(*work_);
    const double noise = 10.0 * std::numeric_limits<double>::epsilon() * moved * norm<Scalar>(*gOld_);
    if (!(change > noise))
      return;
    ++counters_.stepCuts;
    hessianNorm_ *= 2.0;
  }
}

template<class Scalar, class MV>
typename MprgpIteration<Scalar, MV>::Outcome MprgpIteration<Scalar, MV>::step() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();

  const bool proportional = sums_.choppedNorm2 <= options_.gamma * options_.gamma * sums_.reducedNorm2;
  if (!proportional)
    BT::choppedGradient(*x_, *g_, lower_, upper_, *p_);

  apply_(*p_, *image_);
  DirectionSums along = BT::direction(*x_, *g_, *p_, *image_, lower_, upper_);
  if (proportional && along.gradientDotDirection <= 0.0 && sums_.freeNorm2 > 0.0) {
    // Rounding errors have turned the direction upwards; −φ always leads down.
    MVT::Assign(*phi_, *p_);
    apply_(*p_, *image_);
    along = BT::direction(*x_, *g_, *p_, *image_, lower_, upper_);
  }
  if (!std::isfinite(along.directionDotImage) || !std::isfinite(along.gradientDotDirection))
    return Outcome::Breakdown;
  if (!(along.directionNorm2 > 0.0))
    return Outcome::Breakdown;
  const double curvature = along.directionDotImage / along.directionNorm2;
  hessianNorm_ = std::max(hessianNorm_, curvature);
  // Rounding errors of Hp: below this level, the sign of the curvature means nothing.
  const double flat = 100.0 * epsilon * hessianNorm_;
  if (curvature < -flat)
    return Outcome::Breakdown;
  const bool isFlat = curvature <= flat;
  if (isFlat && !std::isfinite(along.longestStep))
    return Outcome::Unbounded;
  const double cgStep =
      isFlat ? std::numeric_limits<double>::infinity() : along.gradientDotDirection / along.directionDotImage;

  if (!proportional) {
    // Towards the inside of an active bound; only another bound, on the far side, can cut the step.
    ++counters_.proportioningSteps;
    if (cgStep < along.longestStep) {
      MVT::MvAddMv(1.0, *x_, -cgStep, *p_, *x_);
      MVT::MvAddMv(1.0, *g_, -cgStep, *image_, *g_);
    } else {
      BT::stepToBoundary(*x_, *p_, along.longestStep, lower_, upper_);
      MVT::MvAddMv(1.0, *g_, -along.longestStep, *image_, *g_);
    }
    ++staleness_;
    split(nullptr);
    MVT::Assign(*phi_, *p_);
    return Outcome::Proportioning;
  }

  if (cgStep < along.longestStep) {
    ++counters_.cgSteps;
    MVT::MvAddMv(1.0, *x_, -cgStep, *p_, *x_);
    MVT::MvAddMv(1.0, *g_, -cgStep, *image_, *g_);
    ++staleness_;
    split(image_.get());
    if (sums_.changed > 0) {
      // Rounding put an entry onto its bound: p is no longer a direction of the face.
      MVT::Assign(*phi_, *p_);
    } else {
      const double beta = sums_.freeDotImage / along.directionDotImage;
      MVT::MvAddMv(1.0, *phi_, -beta, *p_, *p_);
    }
    return Outcome::ConjugateGradient;
  }

  ++counters_.expansionSteps;
  ++staleness_;
  const bool projected = options_.expansion == Expansion::ProjectedConjugateGradient && !isFlat;
  if (!projected || !expandProjected(cgStep))
    expandFixed(along.longestStep);
  split(nullptr);
  MVT::Assign(*phi_, *p_);
  return Outcome::Expansion;
}

} // namespace Harmos::qp
