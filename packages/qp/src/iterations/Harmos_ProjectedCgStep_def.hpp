// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_CurvatureTerms.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_ProjectedCg.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace Harmos::qp {

// The steps of ProjectedCg, and what projects and preconditions in them.

// v ← P_F v, for v that is zero at active entries; rowWork_ ← what C̄ᵀ took away. `sums` of the ranks are
// added up on the way.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::project(MV& v, std::vector<double>& sums) {
  if (!rows_.isPresent()) {
    if (!sums.empty())
      BT::sum(v, sums.data(), static_cast<int>(sums.size()));
    return;
  }
  rows_.solveFor(faceGram_.get(), v, *rowWork_, sums);
  rows_.addTransposed(-1.0, *rowWork_, v);
  if (hasFace_)
    Sets::maskActive(v, active_);
}

// The same; what C̄ᵀ took away is added to `removed`.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::project(MV& v, MV* removed) {
  std::vector<double> none;
  project(v, none);
  if (removed != nullptr && rows_.isPresent())
    Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1.0, *removed, 1.0, *rowWork_, *removed);
}

// z = P_F M⁻¹ w; without a preconditioner z is w.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::precondition() {
  if (!preconditioner_.isPresent() && !isSoftened_) {
    if (z_ != w_)
      Belos::MultiVecTraits<Scalar, MV>::Assign(*w_, *z_);
    return;
  }
  if (isSoftened_) {
    preconditionSoftened();
  } else {
    preconditioner_.apply(*w_, active_, *z_);
    project(*z_);
  }
  if (!isCoupled_)
    kept_.conjugate(*z_);
}

// z, and what a step ends with. w and the image lie in the kernel of the rows, so that products with them
// need not wait for the projection of z.
template<class Scalar, class MV, class OP>
ResidualSums ProjectedCg<Scalar, MV, OP>::preconditionAndSum() {
  const MV& x = *problem_.solution();
  if (isSoftened_ || kept_.size() > 0) {
    precondition();
    return Bounds::residualSums(*w_, *z_, *onFace_, x);
  }
  const bool isPreconditioned = preconditioner_.isPresent();
  if (isPreconditioned)
    preconditioner_.apply(*w_, active_, *z_);
  else if (z_ != w_)
    Belos::MultiVecTraits<Scalar, MV>::Assign(*w_, *z_);
  const ResidualSums local = Bounds::localResidualSums(*w_, *z_, *onFace_, x);
  std::vector<double> sums = {local.residualNorm2, local.preconditionedDotImage, local.iterateNorm2};
  project(*z_, sums);
  if (!isPreconditioned && rows_.isPresent()) { // w itself
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    MVT::MvAddMv(1.0, *removed_, 1.0, *rowWork_, *removed_);
    if (z_ != w_)
      MVT::Assign(*z_, *w_);
  }
  return {sums[0], sums[1], sums[2]};
}

// z = P M⁻¹ Pᵀ w, P = I − TC̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻C̄_F: what meets the equalities again is taken from pairs that
// slip by their share T, for there curvatures make it dear.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::preconditionSoftened() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const double q = stiffness_;
  if (!rows_.isPresent()) {
    preconditioner_.applySoftened(*w_, active_, q, *z_);
    return;
  }
  std::vector<double> none;
  const auto partOfRows = [&](const MV& v, MV& part) { // C̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻C̄v
    rows_.solveFor(softGram_.get(), v, *rowWork_, none);
    MVT::MvInit(part, 0.0);
    rows_.addTransposed(1.0, *rowWork_, part);
    Sets::maskActive(part, active_);
  };
  const Teuchos::RCP<MV> left = MVT::CloneCopy(*w_), part = MVT::CloneCopy(*w_);
  soften(*part);
  partOfRows(*part, *part);
  MVT::MvAddMv(1.0, *left, -1.0, *part, *left);
  preconditioner_.applySoftened(*left, active_, q, *z_);
  for (int pass = 0; pass < 2; ++pass) { // the second for what rounding leaves
    partOfRows(*z_, *part);
    soften(*part);
    MVT::MvAddMv(1.0, *z_, -1.0, *part, *z_);
  }
}

template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::Outcome ProjectedCg<Scalar, MV, OP>::step() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  if (isCoupled_)
    return coupledStep();
  const DirectionSums sums = applyToDirection();
  const double curvature = sums.dotImage / sums.norm2;
  if (!std::isfinite(curvature) || !std::isfinite(sums.dotGradient))
    return Outcome::Breakdown;
  raiseCurvatureBound(sums.dotHessian / sums.norm2);
  if (curvature < -100.0 * epsilon * curvatureBound_)
    return Outcome::Breakdown;
  if (curvature <= 100.0 * epsilon * curvatureBound_ && isFlatAlongDirection(curvature))
    return Outcome::Flat;
  directionDotImage_ = sums.dotImage;
  const double length = sums.dotGradient / directionDotImage_;
  MVT::MvAddMv(1.0, *problem_.solution(), -length, *p_, *problem_.solution());
  directions_.add(*p_, *onFace_, directionDotImage_, length);
  MVT::MvAddMv(1.0, *w_, -length, *onFace_, *w_);
  if (hasFace_) {
    MVT::MvAddMv(1.0, *gradient_, -length, *image_, *gradient_);
    isSettled_ = !isUnprojected_;
  }
  // Without a face what F has in the range of C̄ᵀ is none of A's.
  if (rows_.isPresent() && (hasFace_ || !isUnprojected_))
    MVT::MvAddMv(1.0, *removed_, -length, *rowWork_, *removed_);
  ++counters_.cgSteps;
  ++staleness_;
  hasLooked_ = false;
  watchRows();
  const ResidualSums after = preconditionAndSum();
  residual2_ = after.residualNorm2;
  raiseLevel(after.iterateNorm2);
  // Exactly conjugate to the last direction also with a preconditioner that is not quite symmetric.
  const double beta = after.preconditionedDotImage / directionDotImage_;
  MVT::MvAddMv(1.0, *z_, -beta, *p_, *p_);
  directions_.conjugate(*p_);
  return Outcome::Step;
}

// Whether a curvature along p is no more than what rounding leaves of the terms that it is a sum of.
template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::isFlatAlongDirection(double curvature) {
  const std::function<void(const MV&, MV&)> apply = [this](const MV& in, MV& out) {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), in, out);
  };
  return curvature <= 100.0 * std::numeric_limits<double>::epsilon() * curvatureTerms<Scalar, MV>(apply, *p_);
}

// In each tenth step the distance from the equalities is looked at, and what rounding errors have brought to
// w out of the kernel is taken out. Without a preconditioner that is done where z is made.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::watchRows() {
  if (!rows_.isPresent() || staleness_ % lookInterval != 0)
    return;
  if (preconditioner_.isPresent() || isSoftened_)
    project(*w_, removed_.get());
  lookAtRows();
}

// image_ ← Ap, or Fp, and onFace_ ← P_F of it; rowWork_ ← what was taken away there. p lies in the kernel of
// the rows, so that products with it need not wait for the projection.
template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::DirectionSums ProjectedCg<Scalar, MV, OP>::applyToDirection() {
  ++counters_.hessianApplications;
  Teuchos::RCP<const OP> a = isUnprojected_ ? problem_.unprojectedHessian() : problem_.hessianOnKernel();
  if (a.is_null())
    a = problem_.hessian();
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*a, *p_, *image_);
  const bool hasMore = problem_.hasDiscs() || problem_.hasSoftBounds();
  std::vector<double> sums;
  if (hasMore)
    sums.push_back(Bounds::localCurvature(*p_, *p_, *image_, {}).directionDotImage);
  Sets::addCurvature(active_, 1.0, *p_, false, *image_);
  SpringOps<Scalar, MV>::add(active_, 1.0, *p_, false, *image_);
  if (hasFace_) {
    Belos::MultiVecTraits<Scalar, MV>::Assign(*image_, *onFace_);
    Sets::maskActive(*onFace_, active_);
  }
  const CurvatureSums local = Bounds::localCurvature(*w_, *p_, *onFace_, active_);
  sums.insert(sums.end(), {local.gradientDotDirection, local.directionNorm2, local.directionDotImage});
  project(*onFace_, sums);
  const std::size_t first = hasMore ? 1 : 0;
  return {sums[first], sums[first + 1], sums[first + 2], sums[hasMore ? 0 : 2]};
}

// Fp in the place of Ap = PFp has brought parts in the range of C̄ᵀ to the gradient, which has none of its
// own: C̄(Ax − b) = −C̄b. They go to the multipliers, where what C̄_Fᵀ took away has them, too.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::settle() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (isSettled_)
    return;
  isSettled_ = true;
  std::vector<double> none;
  rows_.solveFor(nullptr, *gradient_, *rowWork_, none);
  MVT::MvAddMv(1.0, *rowWork_, 1.0, *rowsOfLoad_, *rowWork_);
  rows_.addTransposed(-1.0, *rowWork_, *gradient_);
  if (!faceGram_.is_null()) {
    // As far as the face holds them: nothing was taken away for motions that it leaves free.
    MVT::MvInit(*onFace_, 0.0);
    rows_.addTransposed(1.0, *rowWork_, *onFace_);
    Sets::maskActive(*onFace_, active_);
    rows_.solveFor(faceGram_.get(), *onFace_, *rowWork_, none);
  }
  MVT::MvAddMv(1.0, *removed_, -1.0, *rowWork_, *removed_);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::lookAtRows() {
  if (!rows_.isPresent())
    return;
  rows_.residual(*problem_.solution(), *unused_);
  keepRowResidual();
}

// Of the product that the rows have just made.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::keepRowResidual() {
  equalityResidual_ = rows_.residualNorm();
  equalityDistance_ = rows_.distance();
  hasLooked_ = true;
}

} // namespace Harmos::qp
