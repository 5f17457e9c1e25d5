// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FaceSystem.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
FaceSystem<Scalar, MV, OP>::FaceSystem(const Problem<Scalar, MV, OP>& problem,
                                       EqualityRows<Scalar, MV, OP>& rows, Counters& counters)
    : problem_(problem), rows_(rows), counters_(counters), preconditioner_(problem, counters) {}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::setFace(const ActiveFace& face, MV& x) {
  ActiveFace before;
  before.springs = face_.springs;
  resume(face);
  if (hasSprings_ && isSoftened_)
    Faces::moveToSprings(before, face_, stiffness_, x);
  BlockOps<Scalar, MV>::moveToFace(problem_.blocks(), face_, x);
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::resume(const ActiveFace& face) {
  face_ = face;
  preconditioner_.invalidate();
  findCurvatures();
  couple();
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::couple() {
  face_.couplings.clear();
  isCoupled_ = false;
  if (problem_.kind().isCost)
    return;
  for (const auto& block : problem_.blocks())
    block->couple(face_);
  isCoupled_ = isAnywhere(!face_.couplings.empty());
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::findCurvatures() {
  isSoftened_ = !problem_.kind().isPiecewiseLinear && preconditioner_.isPresent() &&
                isAnywhere(!face_.slipping.empty());
  hasSprings_ = !problem_.kind().isSet && isAnywhere(!face_.springs.empty());
  isSoftened_ = isSoftened_ || hasSprings_;
  softGram_ = Teuchos::null;
  const bool isAsked = isSoftened_ || ((!problem_.kind().isCost || problem_.feasibleSet().isTwoSided()) &&
                                       preconditioner_.isPresent());
  if (!isAsked)
    return;
  if (!(stiffness_ > 0.0))
    findStiffness();
  isSoftened_ = isSoftened_ && stiffness_ > 0.0 && std::isfinite(stiffness_);
}

// bᵀb/bᵀM⁻¹b; without a preconditioner the quotient of the load.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::findStiffness() {
  const MV& b = *problem_.rhs();
  const Teuchos::RCP<MV> y = MVT::Clone(b, 1);
  if (preconditioner_.isPresent()) {
    preconditioner_.apply(b, ActiveFace{}, *y);
    preconditioner_.invalidate();
    stiffness_ = dot<Scalar>(b, b) / dot<Scalar>(b, *y);
    return;
  }
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), b, *y);
  stiffness_ = dot<Scalar>(b, *y) / dot<Scalar>(b, b);
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::addCurvatures(const MV& x, bool fromCentre, MV& y) const {
  Faces::addCurvature(face_, 1.0, x, fromCentre, y);
  Faces::addSprings(face_, 1.0, x, fromCentre, y);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<MV> FaceSystem<Scalar, MV, OP>::springForces(const MV& x) const {
  const Teuchos::RCP<MV> forces = MVT::Clone(x, 1);
  MVT::MvInit(*forces, 0.0);
  Faces::addSprings(face_, 1.0, x, false, *forces);
  return forces;
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::project(MV& v, MV& removed, std::vector<double>& sums) const {
  rows_.solveFor(faceGram_.get(), v, removed, sums);
  rows_.addTransposed(-1.0, removed, v);
  mask(v);
}

// Where nothing is held C_FC_Fᵀ = I.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::factorRows() {
  const bool isWhole = std::all_of(face_.begin(), face_.end(), [](signed char state) { return state == 0; });
  faceGram_ = isAnywhere(!isWhole) ? rows_.faceGram(face_) : Teuchos::null;
  if (isSoftened_)
    softGram_ = rows_.faceGram(face_, stiffness_);
}

// v ← Tv, where pairs slip and at springs.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::soften(MV& v) const {
  const double q = stiffness_;
  const Teuchos::RCP<MV> whole = MVT::CloneCopy(v);
  Faces::addAtSlips(
      face_, [q](double curvature) { return -curvature / (q + curvature); }, *whole, v);
  Faces::share(face_, q, v);
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::precondition(const MV& w, MV& z, MV* rowWork) {
  if (isSoftened_)
    return preconditionSoftened(w, z, rowWork);
  if (!preconditioner_.isPresent()) {
    if (&z != &w)
      MVT::Assign(w, z);
    return;
  }
  preconditioner_.apply(w, face_, z);
  std::vector<double> none;
  if (rows_.isPresent())
    project(z, *rowWork, none);
}

// z = P M⁻¹ Pᵀ w, P = I − TC̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻C̄_F: what meets the equalities again is taken from pairs that
// slip by their share T, for there curvatures make it dear.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::preconditionSoftened(const MV& w, MV& z, MV* rowWork) {
  const double q = stiffness_;
  if (!rows_.isPresent())
    return preconditioner_.applySoftened(w, face_, q, z);
  std::vector<double> none;
  const auto partOfRows = [&](const MV& v, MV& part) { // C̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻C̄v
    rows_.solveFor(softGram_.get(), v, *rowWork, none);
    MVT::MvInit(part, 0.0);
    rows_.addTransposed(1.0, *rowWork, part);
    Faces::mask(part, face_);
  };
  const Teuchos::RCP<MV> left = MVT::CloneCopy(w), part = MVT::CloneCopy(w);
  soften(*part);
  partOfRows(*part, *part);
  MVT::MvAddMv(1.0, *left, -1.0, *part, *left);
  preconditioner_.applySoftened(*left, face_, q, z);
  for (int pass = 0; pass < 2; ++pass) { // the second for what rounding leaves
    partOfRows(z, *part);
    soften(*part);
    MVT::MvAddMv(1.0, z, -1.0, *part, z);
  }
}

// What springs hold is to stay.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::solveRows(const MV& residual, MV& x) const {
  const Teuchos::RCP<MV> y = MVT::CloneCopy(residual);
  const bool isStiff = hasSprings_ && isSoftened_;
  const Teuchos::RCP<const FaceGram<MV>> gram = isStiff ? softGram_ : faceGram_;
  if (!gram.is_null())
    gram->solve(*y);
  MVT::MvInit(x, 0.0);
  rows_.addTransposed(1.0, *y, x);
  mask(x);
  if (isStiff)
    soften(x);
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::letFollow(MV& x) const {
  if (!isCoupled_)
    return;
  const Teuchos::RCP<MV> free = MVT::CloneCopy(x);
  Faces::addFollowing(face_, *free, x);
}

template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::solveRowsThatFollow(const MV& residual, MV& x) const {
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

template<class Scalar, class MV, class OP>
double FaceSystem<Scalar, MV, OP>::hold() const {
  if (faceGram_.is_null())
    return 1.0;
  const Teuchos::RCP<MV> motion = rows_.makeVector(), left = rows_.makeVector(), image = rows_.makeVector(),
                         v = MVT::Clone(*problem_.solution(), 1);
  rows_.setRandom(*motion);
  MVT::Assign(*motion, *left);
  for (int pass = 0; pass < 2; ++pass) { // r ← r − C̄C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r
    solveRows(*left, *v);
    rows_.apply(*v, *image);
    MVT::MvAddMv(1.0, *left, -1.0, *image, *left);
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

// n ← n − (C̄_FC̄_Fᵀ)⁻C̄_FC̄_Fᵀn.
template<class Scalar, class MV, class OP>
void FaceSystem<Scalar, MV, OP>::keepMotions(MV& multiplier) const {
  const Teuchos::RCP<MV> part = rows_.makeVector(), v = MVT::Clone(*problem_.solution(), 1);
  for (int pass = 0; pass < 2; ++pass) {
    MVT::MvInit(*v, 0.0);
    rows_.addTransposed(1.0, multiplier, *v);
    mask(*v);
    rows_.apply(*v, *part);
    faceGram_->solve(*part);
    MVT::MvAddMv(1.0, multiplier, -1.0, *part, multiplier);
  }
}

} // namespace Harmos::qp
