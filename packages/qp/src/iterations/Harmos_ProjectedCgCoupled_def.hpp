// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_ProjectedCg.hpp"
#include "Harmos_VectorOps.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace Harmos::qp {

// The steps of ProjectedCg on faces where limits follow the solution.

// Motions on which no force of the face acts are those of before: gradients at what slips tell slips with
// them.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::keepMotions(const MV& before) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Teuchos::RCP<MV> kept = rows_.makeVector(), part = rows_.makeVector();
  const Teuchos::RCP<MV> v = MVT::Clone(*w_, 1);
  MVT::MvAddMv(1.0, before, -1.0, *removed_, *kept);
  for (int pass = 0; pass < 2; ++pass) { // n ← n − (C̄_FC̄_Fᵀ)⁻C̄_FC̄_Fᵀn
    MVT::MvInit(*v, 0.0);
    rows_.addTransposed(1.0, *kept, *v);
    Sets::maskActive(*v, active_);
    rows_.apply(*v, *part);
    faceGram_->solve(*part);
    MVT::MvAddMv(1.0, *kept, -1.0, *part, *kept);
  }
  MVT::MvAddMv(1.0, *removed_, 1.0, *kept, *removed_);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::findFollowing() {
  isCoupled_ = false;
  if (!problem_.hasFollowingLimits())
    return;
  following_ = Kernels::followingEntries(problem_.followingLimits(), problem_.feasibleSet().discs, active_);
  isCoupled_ = BT::maximum(*problem_.solution(), following_.empty() ? 0.0 : 1.0) > 0.0;
  if (isCoupled_ && rows_.isPresent() && rowResidual_.is_null())
    rowResidual_ = rows_.makeVector();
}

// x ← Tx.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::letFollow(MV& x) const {
  if (!isCoupled_)
    return;
  const Teuchos::RCP<MV> free = Belos::MultiVecTraits<Scalar, MV>::CloneCopy(x);
  Limits::addFollowing(following_, *free, x);
}

// x ← C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::solveRows(const MV& residual, MV& x) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MVT::Assign(residual, *rowWork_);
  const bool isStiff = hasSprings_ && isSoftened_; // what springs hold is to stay
  const Teuchos::RCP<const FaceGram<MV>> gram = isStiff ? softGram_ : faceGram_;
  if (!gram.is_null())
    gram->solve(*rowWork_);
  MVT::MvInit(x, 0.0);
  rows_.addTransposed(1.0, *rowWork_, x);
  Sets::maskActive(x, active_);
  if (isStiff)
    soften(x);
}

// x = TC̄_Fᵀη with C̄x = r, where there is one: the matrix of rows is not symmetric, and (C̄_FC̄_Fᵀ)⁻, which
// knows nothing of T, makes the directions.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::solveRowsThatFollow(const MV& residual, MV& x) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  constexpr double enough = 1e-8;
  constexpr int mostSteps = 50;
  std::vector<std::pair<Teuchos::RCP<MV>, Teuchos::RCP<MV>>> steps; // and C̄ of them, of length 1
  const Teuchos::RCP<MV> left = MVT::CloneCopy(residual);
  MVT::MvInit(x, 0.0);
  const double size = norm<Scalar>(residual);
  double now = size;
  while (now > enough * size && static_cast<int>(steps.size()) < mostSteps) {
    const Teuchos::RCP<MV> step = MVT::Clone(x, 1), image = rows_.makeVector();
    solveRows(*left, *step);
    letFollow(*step);
    rows_.apply(*step, *image);
    for (int pass = 0; pass < 2; ++pass)
      for (const auto& [before, itsImage] : steps) {
        const double along = dot<Scalar>(*itsImage, *image);
        MVT::MvAddMv(1.0, *image, -along, *itsImage, *image);
        MVT::MvAddMv(1.0, *step, -along, *before, *step);
      }
    const double length = norm<Scalar>(*image);
    if (!(length > 0.0))
      break;
    MVT::MvAddMv(1.0 / length, *image, 0.0, *image, *image);
    MVT::MvAddMv(1.0 / length, *step, 0.0, *step, *step);
    const double along = dot<Scalar>(*image, *left);
    MVT::MvAddMv(1.0, x, along, *step, x);
    MVT::MvAddMv(1.0, *left, -along, *image, *left);
    steps.emplace_back(step, image);
    const double next = norm<Scalar>(*left);
    if (!(next < (1.0 - 1e-6) * now))
      break;
    now = next;
  }
}

// Whether forces of the face act on all motions, or on some not at all, or on some hardly: the least
// eigenvalue of C̄_FC̄_Fᵀ, about, as the share of all forces of equalities and bounds that are there.
template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::hold() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (faceGram_.is_null())
    return 1.0;
  const Teuchos::RCP<MV> motion = rows_.makeVector(), left = rows_.makeVector(), v = MVT::Clone(*w_, 1);
  rows_.setRandom(*motion);
  MVT::Assign(*motion, *left);
  for (int pass = 0; pass < 2; ++pass) { // r ← r − C̄C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r
    solveRows(*left, *v);
    rows_.apply(*v, *unused_);
    MVT::MvAddMv(1.0, *left, -1.0, *unused_, *left);
  }
  if (norm<Scalar>(*left) > std::sqrt(std::numeric_limits<double>::epsilon()) * norm<Scalar>(*motion))
    return 0.0;
  double size = norm<Scalar>(*motion), result = 1.0;
  for (int pass = 0; pass < 3; ++pass) { // inverse iteration
    faceGram_->solve(*motion);
    const double grown = norm<Scalar>(*motion);
    result = size / grown;
    size = grown;
  }
  return result;
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::sumResidual() {
  const MV* rows = isCoupled_ ? rowResidual_.get() : nullptr;
  residual2_ = coupled_.product(*w_, rows, *w_, rows);
}

// What the face would need without T, so that the equalities are met with it; and what that does.
template<class Scalar, class MV, class OP>
CoupledDirection<MV> ProjectedCg<Scalar, MV, OP>::coupledDirection() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  CoupledDirection<MV> d;
  precondition();
  d.p = MVT::CloneCopy(*z_);
  letFollow(*d.p);
  if (rows_.isPresent()) {
    d.removed = rows_.makeVector();
    d.rows = rows_.makeVector();
    const Teuchos::RCP<MV> correction = MVT::Clone(*d.p, 1);
    rows_.apply(*d.p, *d.rows);
    MVT::MvAddMv(1.0, *rowResidual_, -1.0, *d.rows, *d.rows);
    solveRowsThatFollow(*d.rows, *correction);
    MVT::MvAddMv(1.0, *d.p, 1.0, *correction, *d.p);
    rows_.apply(*d.p, *d.rows);
    MVT::MvInit(*d.removed, 0.0);
  }
  d.image = MVT::Clone(*d.p, 1);
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *d.p, *d.image);
  raiseCurvatureBound(norm<Scalar>(*d.image) / norm<Scalar>(*d.p));
  Sets::addCurvature(active_, 1.0, *d.p, false, *d.image);
  SpringOps<Scalar, MV>::add(active_, 1.0, *d.p, false, *d.image);
  d.onFace = MVT::CloneCopy(*d.image);
  Sets::maskActive(*d.onFace, active_);
  project(*d.onFace, d.removed.get());
  return d;
}

template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::Outcome ProjectedCg<Scalar, MV, OP>::coupledStep() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  // Images of rounding errors, or that take nothing from the residual.
  constexpr double nothing = 1e-12;
  if (coupled_.rowWeight() == 0.0) // nothing was known of A
    coupled_.setRowWeight(1.0);
  CoupledDirection<MV> d = coupledDirection();
  const double before = coupled_.product(*d.onFace, d.rows.get(), *d.onFace, d.rows.get());
  coupled_.orthogonalise(d);
  const double norm2 = coupled_.product(*d.onFace, d.rows.get(), *d.onFace, d.rows.get());
  const double along = coupled_.product(*w_, rowResidual_.get(), *d.onFace, d.rows.get());
  if (!std::isfinite(norm2) || !std::isfinite(along))
    return Outcome::Breakdown;
  if (!(norm2 > nothing * nothing * before) || along * along <= nothing * norm2 * residual2_)
    return Outcome::Flat;
  const double length = along / norm2;
  MV& x = *problem_.solution();
  MVT::MvAddMv(1.0, x, -length, *d.p, x);
  MVT::MvAddMv(1.0, *gradient_, -length, *d.image, *gradient_);
  MVT::MvAddMv(1.0, *w_, -length, *d.onFace, *w_);
  if (rows_.isPresent()) {
    MVT::MvAddMv(1.0, *rowResidual_, -length, *d.rows, *rowResidual_);
    MVT::MvAddMv(1.0, *removed_, -length, *d.removed, *removed_);
  }
  coupled_.add(d, norm2);
  sumResidual();
  lookAtRows();
  ++counters_.cgSteps;
  ++staleness_;
  raiseLevel(dot<Scalar>(x, x));
  return Outcome::Step;
}

} // namespace Harmos::qp
