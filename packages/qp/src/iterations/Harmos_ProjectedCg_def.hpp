// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_ProjectedCg.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

/// The slipping pairs of an active set whose states are exchanged already.
template<class Scalar, class MV>
void exchangeSlips(StateArchive<MV>& archive, const std::string& name, const FeasibleSet<MV>& feasible,
                   const MV& like, LocalActiveSet& set) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Teuchos::RCP<MV> normals = MVT::Clone(like, 1), curvatures = MVT::Clone(like, 1);
  BoundTraits<Scalar, MV>::slipsToVectors(set, *normals, *curvatures);
  archive.vector(name + " slips", *normals);
  archive.vector(name + " curvatures", *curvatures);
  if (archive.isReading())
    BoundTraits<Scalar, MV>::vectorsToSlips(feasible, *normals, *curvatures, set);
}

template<class Scalar, class MV, class OP>
ProjectedCg<Scalar, MV, OP>::ProjectedCg(const Problem<Scalar, MV, OP>& problem,
                                         EqualityRows<Scalar, MV, OP>& rows, const CgOptions& options,
                                         Counters& counters)
    : problem_(problem),
      rows_(rows),
      counters_(counters),
      preconditioner_(problem, counters),
      directions_(options),
      kept_(problem, rows),
      curvatureBound_(problem.hessianNorm()) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  for (Teuchos::RCP<MV>* vector : {&w_, &p_, &image_})
    *vector = MVT::Clone(*problem.solution(), 1);
  z_ = preconditioner_.isPresent() ? MVT::Clone(*w_, 1) : w_;
  if (rows_.isPresent()) {
    rowWork_ = rows_.makeVector();
    removed_ = rows_.makeVector();
    unused_ = rows_.makeVector();
  }
}

// w ← P_F w; what C̄ᵀ took away is added to `removed`.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::project(MV& w, MV* removed) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  if (!rows_.isPresent())
    return;
  rows_.apply(w, *rowWork_);
  if (!faceGram_.is_null())
    BT::scatter(faceGram_->solve(BT::gather(*rowWork_)), *rowWork_);
  rows_.addTransposed(-1.0, *rowWork_, w);
  if (hasFace_)
    BT::maskActive(w, active_);
  if (removed != nullptr)
    MVT::MvAddMv(1.0, *removed, 1.0, *rowWork_, *removed);
}

template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::start(const LocalActiveSet& active) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  MV& x = *problem_.solution();
  active_ = active;
  hasFace_ = problem_.hasBounds();
  preconditioner_.invalidate();
  findSlips();
  isDeficient_ = false;
  if (hasFace_) {
    if (gradient_.is_null())
      gradient_ = MVT::Clone(x, 1);
    BT::moveToBounds(x, problem_.feasibleSet(), active_);
    findFollowing();
    if (isCoupled_)
      BT::moveToFollowing(following_, *problem_.lowerBound(), x);
  }
  if (rows_.isPresent()) {
    makeFaceGram();
    if (isCoupled_ && !slipsBalance())
      return false;
    // x_F ← x_F − C_Fᵀ(C_FC_Fᵀ)⁻(C̄x − c̄), a second time for what rounding left.
    const Teuchos::RCP<MV> correction = MVT::Clone(x, 1);
    double scale = norm<Scalar>(x) + norm<Scalar>(rows_.values()); // a guess may be nothing but what goes
    for (int pass = 0; pass < 2; ++pass) {
      rows_.residual(x, *unused_);
      if (!faceGram_.is_null())
        BT::scatter(faceGram_->solve(BT::gather(*unused_)), *unused_);
      MVT::MvInit(*correction, 0.0);
      rows_.addTransposed(-1.0, *unused_, *correction);
      if (hasFace_)
        BT::maskActive(*correction, active_);
      letFollow(*correction);
      MVT::MvAddMv(1.0, x, 1.0, *correction, x);
    }
    rows_.residual(x, *unused_);
    // A face that misses the equalities does so by more than rounding errors.
    scale = std::max(scale, norm<Scalar>(x));
    if (isCoupled_) {
      MVT::Assign(*unused_, *rowResidual_);
    } else if (norm<Scalar>(*unused_) > std::sqrt(std::numeric_limits<double>::epsilon()) * scale)
      return false;
  }
  const Teuchos::RCP<MV> before = isDeficient_ ? MVT::CloneCopy(*removed_) : Teuchos::null;
  restart();
  if (isDeficient_)
    keepMotions(*before);
  return true;
}

// Motions on which no force of the face acts are those of before: gradients at what slips tell slips with them.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::keepMotions(const MV& before) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Teuchos::RCP<MV> kept = rows_.makeVector(), part = rows_.makeVector();
  const Teuchos::RCP<MV> v = MVT::Clone(*w_, 1);
  MVT::MvAddMv(1.0, before, -1.0, *removed_, *kept);
  for (int pass = 0; pass < 2; ++pass) { // n ← n − (C̄_FC̄_Fᵀ)⁻C̄_FC̄_Fᵀn
    MVT::MvInit(*v, 0.0);
    rows_.addTransposed(1.0, *kept, *v);
    BoundTraits<Scalar, MV>::maskActive(*v, active_);
    rows_.apply(*v, *part);
    BoundTraits<Scalar, MV>::scatter(faceGram_->solve(BoundTraits<Scalar, MV>::gather(*part)), *part);
    MVT::MvAddMv(1.0, *kept, -1.0, *part, *kept);
  }
  MVT::MvAddMv(1.0, *removed_, 1.0, *kept, *removed_);
}

// Without active entries C_FC_Fᵀ = I.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::makeFaceGram() {
  const bool isWhole =
      std::all_of(active_.begin(), active_.end(), [](signed char side) { return side == 0; });
  const double anyActive = BoundTraits<Scalar, MV>::maximum(*problem_.solution(), isWhole ? 0.0 : 1.0);
  faceGram_ = anyActive > 0.0 ? rows_.faceGram(active_) : Teuchos::null;
  if (isSoftened_)
    softGram_ = rows_.faceGram(active_, stiffness_);
}

// Whether pairs slip, and q = bᵀb/bᵀM⁻¹b, about that of the solution.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::findSlips() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  isSoftened_ =
      problem_.hasDiscs() && preconditioner_.isPresent() &&
      BoundTraits<Scalar, MV>::maximum(*problem_.solution(), active_.slipping.empty() ? 0.0 : 1.0) > 0.0;
  softGram_ = Teuchos::null;
  if (!(isSoftened_ || (problem_.hasFollowingLimits() && preconditioner_.isPresent())) || stiffness_ > 0.0)
    return;
  const MV& b = *problem_.rhs();
  const Teuchos::RCP<MV> y = MVT::Clone(b, 1);
  preconditioner_.apply(b, LocalActiveSet{}, *y);
  preconditioner_.invalidate();
  stiffness_ = dot<Scalar>(b, b) / dot<Scalar>(b, *y);
  isSoftened_ = isSoftened_ && stiffness_ > 0.0 && std::isfinite(stiffness_);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::exchange(StateArchive<MV>& archive) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  archive.vector("x", *problem_.solution());
  archive.vector("cg gradient on the face", *w_);
  archive.vector("cg direction", *p_);
  archive.number("cg has a face", hasFace_);
  if (hasFace_) {
    if (gradient_.is_null())
      gradient_ = MVT::Clone(*w_, 1);
    archive.vector("cg gradient", *gradient_);
    const Teuchos::RCP<MV> active = MVT::Clone(*w_, 1);
    BT::activeToVector(active_, *active);
    archive.vector("cg active set", *active);
    if (archive.isReading())
      BT::vectorToActive(*active, active_);
    if (problem_.hasDiscs())
      exchangeSlips<Scalar>(archive, "cg", problem_.feasibleSet(), *w_, active_);
    if (archive.isReading()) {
      // Bounds that another number of ranks has rounded differently.
      BT::moveToBounds(*problem_.solution(), problem_.feasibleSet(), active_);
    }
  }
  if (rows_.isPresent())
    archive.rowVector("cg projected away", *removed_);
  archive.number("cg residual", residual2_);
  archive.number("cg curvature bound", curvatureBound_);
  archive.number("cg load", rhsNorm_);
  archive.number("cg iterate", iterateNorm_);
  archive.number("cg rounding level", level_);
  archive.number("cg staleness", staleness_);
  directions_.exchange(archive, *w_);
  kept_.exchange(archive, *w_);
  if (problem_.hasFollowingLimits()) {
    bool isCoupled = isCoupled_;
    archive.number("cg coupled", isCoupled);
    if (archive.isReading()) {
      findFollowing();
      isCoupled_ = isCoupled;
    }
    if (isCoupled_) {
      coupled_.exchange(archive, *w_, rowWork_.get());
      if (rows_.isPresent())
        archive.rowVector("cg rows", *rowResidual_);
    }
  }
  if (!archive.isReading())
    return;
  preconditioner_.invalidate();
  findSlips();
  if (rows_.isPresent()) {
    makeFaceGram();
    if (isCoupled_)
      slipsBalance();
  }
  if (!isCoupled_)
    following_.clear();
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::restart() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MV& x = *problem_.solution();
  double imageNorm = 0.0;
  if (norm<Scalar>(x) > 0.0) {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), x, *w_);
    imageNorm = isCoupled_ ? norm<Scalar>(*w_) : 0.0;
    MVT::MvAddMv(1.0, *w_, -1.0, *problem_.rhs(), *w_);
  } else {
    MVT::MvAddMv(-1.0, *problem_.rhs(), 0.0, *problem_.rhs(), *w_);
  }
  if (!isCoupled_)
    kept_.minimise(x, *w_);
  if (hasFace_) {
    BoundTraits<Scalar, MV>::addCurvature(active_, 1.0, x, true, *w_);
    MVT::Assign(*w_, *gradient_);
    BoundTraits<Scalar, MV>::maskActive(*w_, active_);
  }
  if (rows_.isPresent())
    MVT::MvInit(*removed_, 0.0);
  project(*w_, removed_.get());
  project(*w_, removed_.get()); // the first projection left rounding errors of the size of what it removed
  coupled_.clear();
  if (isCoupled_) {
    if (norm<Scalar>(x) > 0.0)
      curvatureBound_ = std::max(curvatureBound_, imageNorm / norm<Scalar>(x));
    coupled_.setRowWeight(curvatureBound_);
  }
  sumResidual();
  staleness_ = 0;
  rhsNorm_ = norm<Scalar>(*problem_.rhs());
  level_ = 0.0;
  raiseLevel(dot<Scalar>(x, x));
  directions_.clear();
  if (isCoupled_)
    return;
  precondition();
  MVT::Assign(*z_, *p_);
}

template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::returnToRows(double distance) {
  constexpr double rounding = 1e4 * std::numeric_limits<double>::epsilon();
  if (staleness_ == 0 || distance == 0.0 || isCoupled_)
    return false;
  const double length = iterateNorm_ + norm<Scalar>(rows_.values());
  if (distance <= rounding * length || distance * rhsNorm_ <= residualNorm() * length)
    return false;
  ++counters_.confirmations;
  const LocalActiveSet active = active_;
  return start(active);
}

// z = P_F M⁻¹ w; without a preconditioner z is w.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::precondition() {
  if (!preconditioner_.isPresent())
    return;
  if (isSoftened_) {
    preconditionSoftened();
  } else {
    preconditioner_.apply(*w_, active_, *z_);
    project(*z_, nullptr);
  }
  if (!isCoupled_)
    kept_.conjugate(*z_);
}

// z = P M⁻¹ Pᵀ w, P = I − TC̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻C̄_F: what meets the equalities again is taken from pairs that
// slip by their share T, for there curvatures make it dear.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::preconditionSoftened() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  const double q = stiffness_;
  const auto soften = [&](MV& v) { // v ← Tv
    const Teuchos::RCP<MV> whole = MVT::CloneCopy(v);
    BT::addAtSlips(
        active_, [q](double curvature) { return -curvature / (q + curvature); }, *whole, v);
  };
  if (!rows_.isPresent()) {
    preconditioner_.applySoftened(*w_, active_, q, *z_);
    return;
  }
  const auto addRows = [&](MV& v) { // C̄_Fᵀ(C̄_FTC̄_Fᵀ)⁻ of what is in rowWork_
    BT::scatter(softGram_->solve(BT::gather(*rowWork_)), *rowWork_);
    MVT::MvInit(v, 0.0);
    rows_.addTransposed(1.0, *rowWork_, v);
    BT::maskActive(v, active_);
  };
  const Teuchos::RCP<MV> left = MVT::CloneCopy(*w_), part = MVT::CloneCopy(*w_);
  soften(*part);
  rows_.apply(*part, *rowWork_);
  addRows(*part);
  MVT::MvAddMv(1.0, *left, -1.0, *part, *left);
  preconditioner_.applySoftened(*left, active_, q, *z_);
  for (int pass = 0; pass < 2; ++pass) { // the second for what rounding leaves
    rows_.apply(*z_, *rowWork_);
    addRows(*part);
    soften(*part);
    MVT::MvAddMv(1.0, *z_, -1.0, *part, *z_);
  }
}

template<class Scalar, class MV, class OP>
int ProjectedCg<Scalar, MV, OP>::keepOutliers(int most) {
  const int before = kept_.size();
  // The others are not far enough from the rest to be worth a product.
  constexpr double outlying = 30.0;
  const Teuchos::RCP<MV> vectors = preconditioner_.isPresent() && most > before
                                       ? directions_.ritzVectors(most - before, outlying)
                                       : Teuchos::null;
  if (!vectors.is_null())
    kept_.add(*vectors, counters_);
  return kept_.size() - before;
}

template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::Outcome ProjectedCg<Scalar, MV, OP>::step() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  if (isCoupled_)
    return coupledStep();
  ++counters_.hessianApplications;
  // p lies in the kernel of the rows.
  const Teuchos::RCP<const OP> onKernel = problem_.hessianOnKernel();
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(onKernel.is_null() ? *problem_.hessian() : *onKernel, *p_,
                                               *image_);
  const double ofHessian = problem_.hasDiscs() ? dot<Scalar>(*p_, *image_) : 0.0;
  BoundTraits<Scalar, MV>::addCurvature(active_, 1.0, *p_, false, *image_);
  const CurvatureSums sums = BoundTraits<Scalar, MV>::curvature(*w_, *p_, *image_, active_);
  const double curvature = sums.directionDotImage / sums.directionNorm2;
  if (!std::isfinite(curvature) || !std::isfinite(sums.gradientDotDirection))
    return Outcome::Breakdown;
  curvatureBound_ =
      std::max(curvatureBound_, problem_.hasDiscs() ? ofHessian / sums.directionNorm2 : curvature);
  if (curvature < -100.0 * epsilon * curvatureBound_)
    return Outcome::Breakdown;
  if (curvature <= 100.0 * epsilon * curvatureBound_)
    return Outcome::Flat;
  directionDotImage_ = sums.directionDotImage;
  const double length = sums.gradientDotDirection / directionDotImage_;
  MVT::MvAddMv(1.0, *problem_.solution(), -length, *p_, *problem_.solution());
  directions_.add(*p_, *image_, directionDotImage_, length);
  if (hasFace_) {
    MVT::MvAddMv(1.0, *gradient_, -length, *image_, *gradient_);
    BoundTraits<Scalar, MV>::maskActive(*image_, active_);
  }
  MVT::MvAddMv(1.0, *w_, -length, *image_, *w_);
  project(*w_, removed_.get());
  precondition();
  const ResidualSums after = BoundTraits<Scalar, MV>::residualSums(*w_, *z_, *image_, *problem_.solution());
  residual2_ = after.residualNorm2;
  ++counters_.cgSteps;
  ++staleness_;
  raiseLevel(after.iterateNorm2);
  // Exactly conjugate to the last direction also with a preconditioner that is not quite symmetric.
  const double beta = after.preconditionedDotImage / directionDotImage_;
  MVT::MvAddMv(1.0, *z_, -beta, *p_, *p_);
  directions_.conjugate(*p_);
  return Outcome::Step;
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::findFollowing() {
  isCoupled_ = false;
  if (!problem_.hasFollowingLimits())
    return;
  following_ =
      Kernels::followingEntries(problem_.followingLimits(), problem_.feasibleSet().discs, active_);
  isCoupled_ =
      BoundTraits<Scalar, MV>::maximum(*problem_.solution(), following_.empty() ? 0.0 : 1.0) > 0.0;
  if (isCoupled_ && rows_.isPresent() && rowResidual_.is_null())
    rowResidual_ = rows_.makeVector();
}

// x ← Tx.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::letFollow(MV& x) const {
  if (!isCoupled_)
    return;
  const Teuchos::RCP<MV> free = Belos::MultiVecTraits<Scalar, MV>::CloneCopy(x);
  BoundTraits<Scalar, MV>::addFollowing(following_, *free, x);
}

// x ← C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::solveRows(const MV& residual, MV& x) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  MVT::Assign(residual, *rowWork_);
  if (!faceGram_.is_null())
    BT::scatter(faceGram_->solve(BT::gather(*rowWork_)), *rowWork_);
  MVT::MvInit(x, 0.0);
  rows_.addTransposed(1.0, *rowWork_, x);
  BT::maskActive(x, active_);
}

// Bodies of which all slips: no force of the face acts on their motions, and those that are held have to balance.
// These do not follow, or they would balance no more.
template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::slipsBalance() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  if (faceGram_.is_null())
    return true;
  MV& x = *problem_.solution();
  const double epsilon = std::numeric_limits<double>::epsilon();
  const Teuchos::RCP<MV> left = rows_.makeVector(), v = MVT::Clone(x, 1), g = MVT::Clone(x, 1);
  // r ← r − C̄C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r
  const auto keepUnmet = [&](MV& r) {
    solveRows(r, *v);
    rows_.apply(*v, *unused_);
    MVT::MvAddMv(1.0, r, -1.0, *unused_, r);
  };
  BT::setRandom(*left);
  const double size = norm<Scalar>(*left);
  for (int pass = 0; pass < 2; ++pass)
    keepUnmet(*left);
  isDeficient_ = norm<Scalar>(*left) > std::sqrt(epsilon) * size;
  if (!isDeficient_)
    return true;
  MVT::MvInit(*g, 0.0);
  rows_.addTransposed(1.0, *left, *g);
  BT::dropFollowing(*g, std::sqrt(epsilon) * norm<Scalar>(*g), following_);
  isCoupled_ = BT::maximum(x, following_.empty() ? 0.0 : 1.0) > 0.0;

  rows_.residual(x, *left);
  keepUnmet(*left);
  return norm<Scalar>(*left) <= std::sqrt(epsilon) * (norm<Scalar>(x) + norm<Scalar>(rows_.values()));
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
  using BT = BoundTraits<Scalar, MV>;
  CoupledDirection<MV> d;
  precondition();
  d.p = MVT::CloneCopy(*z_);
  letFollow(*d.p);
  if (rows_.isPresent()) {
    d.removed = rows_.makeVector();
    d.rows = rows_.makeVector();
    const Teuchos::RCP<MV> correction = MVT::Clone(*d.p, 1);
    constexpr int passes = 3; // what T adds is mended by the next, or counts in the residual
    for (int pass = 0; pass < passes; ++pass) {
      rows_.apply(*d.p, *d.rows);
      MVT::MvAddMv(1.0, *rowResidual_, -1.0, *d.rows, *d.rows);
      solveRows(*d.rows, *correction);
      letFollow(*correction);
      MVT::MvAddMv(1.0, *d.p, 1.0, *correction, *d.p);
    }
    rows_.apply(*d.p, *d.rows);
    MVT::MvInit(*d.removed, 0.0);
  }
  d.image = MVT::Clone(*d.p, 1);
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *d.p, *d.image);
  curvatureBound_ = std::max(curvatureBound_, norm<Scalar>(*d.image) / norm<Scalar>(*d.p));
  BT::addCurvature(active_, 1.0, *d.p, false, *d.image);
  d.onFace = MVT::CloneCopy(*d.image);
  BT::maskActive(*d.onFace, active_);
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
  ++counters_.cgSteps;
  ++staleness_;
  raiseLevel(dot<Scalar>(x, x));
  return Outcome::Step;
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::raiseLevel(double iterateNorm2) {
  iterateNorm_ = std::sqrt(iterateNorm2);
  level_ =
      std::max(level_, std::numeric_limits<double>::epsilon() * (curvatureBound_ * iterateNorm_ + rhsNorm_));
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::residualNorm() const {
  return std::sqrt(residual2_);
}

template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::Slipping ProjectedCg<Scalar, MV, OP>::slipping() const {
  const double q = stiffness_ > 0.0 ? stiffness_ : curvatureBound_;
  if (!problem_.hasDiscs() || !(q > 0.0))
    return {residualNorm(), 0.0};
  const SlipSums sums = BoundTraits<Scalar, MV>::slipSums(active_, q, *w_);
  return {std::sqrt(std::max(0.0, residual2_ - sums.along2) + sums.softened2),
          sums.rims2 > 0.0 ? std::sqrt(sums.along2 / sums.rims2) : 0.0};
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::attainable() const {
  return level_;
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::cost() const {
  const MV& x = *problem_.solution();
  return 0.5 * (dot<Scalar>(x, *gradient_) - dot<Scalar>(x, *problem_.rhs()));
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::lagrangianGradient(MV& y) const {
  Belos::MultiVecTraits<Scalar, MV>::Assign(*gradient_, y);
  BoundTraits<Scalar, MV>::addCurvature(active_, -1.0, *problem_.solution(), true, y);
  if (rows_.isPresent())
    rows_.addTransposed(-1.0, *removed_, y);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::multiplier(MV& mu) const {
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(-1.0, *removed_, 0.0, *removed_, mu);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::storeMultiplier() const {
  if (!rows_.isPresent())
    return;
  const Teuchos::RCP<MV> mu = rows_.makeVector();
  multiplier(*mu);
  rows_.toUser(*mu, *problem_.multiplier());
}

template<class Scalar, class MV, class OP>
IterationState<MV> ProjectedCg<Scalar, MV, OP>::evaluate(double gradientNorm, int outer, int inner) {
  IterationState<MV> state;
  state.x = problem_.solution().get();
  state.projectedGradient = gradientNorm;
  if (rows_.isPresent()) {
    rows_.residual(*problem_.solution(), *unused_);
    state.equalityResidual = rows_.residualNorm();
    state.equalityDistance = rows_.distance();
  }
  state.decrease = std::numeric_limits<double>::quiet_NaN(); // not known
  state.outer = outer;
  state.inner = inner;
  state.counters = &counters_;
  return state;
}

} // namespace Harmos::qp
