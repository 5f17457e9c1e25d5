// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FaceArchive.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_ProjectedCg.hpp"
#include "Harmos_ProjectedCgCoupled_def.hpp"
#include "Harmos_ProjectedCgStep_def.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

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
      curvatureBound_(problem.hessianNorm()),
      rhsNorm_(norm<Scalar>(*problem.rhs())) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  for (Teuchos::RCP<MV>* vector : {&w_, &p_, &image_})
    *vector = MVT::Clone(*problem.solution(), 1);
  z_ = preconditioner_.isPresent() || problem.hasSoftBounds() ? MVT::Clone(*w_, 1) : w_;
  if (rows_.isPresent()) {
    rowWork_ = rows_.makeVector();
    removed_ = rows_.makeVector();
    unused_ = rows_.makeVector();
  }
  isUnprojected_ = rows_.isPresent() && !problem.unprojectedHessian().is_null() && !problem.hasDiscs() &&
                   !problem.hasSoftBounds() && !problem.hasFollowingLimits();
  onFace_ = image_;
  if (!isUnprojected_ || !problem.hasBounds())
    return;
  rowsOfLoad_ = rows_.makeVector();
  rows_.apply(*problem.rhs(), *rowsOfLoad_);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::makeFaceVectors() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (!hasFace_ || !gradient_.is_null())
    return;
  gradient_ = MVT::Clone(*w_, 1);
  onFace_ = MVT::Clone(*w_, 1);
}

template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::start(const LocalActiveSet& active, double leastHold) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MV& x = *problem_.solution();
  LocalActiveSet known;
  known.springs = active_.springs;
  active_ = active;
  hasFace_ = problem_.hasBounds() || problem_.hasSoftBounds();
  preconditioner_.invalidate();
  findSlips();
  isDeficient_ = false;
  if (hasSprings_ && isSoftened_)
    SpringOps<Scalar, MV>::move(known, active_, stiffness_, x);
  makeFaceVectors();
  if (hasFace_) {
    Sets::moveToBounds(x, problem_.feasibleSet(), active_);
    findFollowing();
    if (isCoupled_)
      Limits::moveToFollowing(following_, *problem_.lowerBound(), x);
  }
  if (rows_.isPresent()) {
    makeFaceGram();
    const double held = isCoupled_ ? hold() : 1.0;
    if (held < leastHold)
      return false;
    isDeficient_ = held == 0.0;
    // x_F ← x_F − C_Fᵀ(C_FC_Fᵀ)⁻(C̄x − c̄), a second time for what rounding left.
    const Teuchos::RCP<MV> correction = MVT::Clone(x, 1);
    double scale = norm<Scalar>(x) + rows_.valuesNorm(); // a guess may be nothing but what goes
    for (int pass = 0; pass < 2; ++pass) {
      rows_.residual(x, *unused_);
      if (isCoupled_) {
        solveRowsThatFollow(*unused_, *correction);
        MVT::MvAddMv(1.0, x, -1.0, *correction, x);
        continue;
      }
      // What springs hold is to stay.
      const Teuchos::RCP<const FaceGram<MV>> gram = hasSprings_ && isSoftened_ ? softGram_ : faceGram_;
      if (!gram.is_null())
        gram->solve(*unused_);
      MVT::MvInit(*correction, 0.0);
      rows_.addTransposed(-1.0, *unused_, *correction);
      if (hasFace_)
        Sets::maskActive(*correction, active_);
      if (hasSprings_ && isSoftened_)
        soften(*correction);
      MVT::MvAddMv(1.0, x, 1.0, *correction, x);
    }
    rows_.residual(x, *unused_);
    keepRowResidual();
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

// Without active entries C_FC_Fᵀ = I.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::makeFaceGram() {
  const bool isWhole =
      std::all_of(active_.begin(), active_.end(), [](signed char side) { return side == 0; });
  const double anyActive = BT::maximum(*problem_.solution(), isWhole ? 0.0 : 1.0);
  faceGram_ = anyActive > 0.0 ? rows_.faceGram(active_) : Teuchos::null;
  if (isSoftened_)
    softGram_ = rows_.faceGram(active_, stiffness_);
}

// Whether pairs slip, and q = bᵀb/bᵀM⁻¹b, about that of the solution.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::findSlips() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  isSoftened_ = problem_.hasDiscs() && preconditioner_.isPresent() &&
                BT::maximum(*problem_.solution(), active_.slipping.empty() ? 0.0 : 1.0) > 0.0;
  hasSprings_ = problem_.hasSoftBounds() && isAnywhere(!active_.springs.empty());
  isSoftened_ = isSoftened_ || hasSprings_;
  softGram_ = Teuchos::null;
  const bool isAsked = isSoftened_ || ((problem_.hasFollowingLimits() || problem_.isTwoSided()) &&
                                       preconditioner_.isPresent());
  if (!isAsked || stiffness_ > 0.0)
    return;
  const MV& b = *problem_.rhs();
  if (!preconditioner_.isPresent()) { // the quotient of the load
    const Teuchos::RCP<MV> image = MVT::Clone(b, 1);
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), b, *image);
    stiffness_ = dot<Scalar>(b, *image) / dot<Scalar>(b, b);
    isSoftened_ = stiffness_ > 0.0 && std::isfinite(stiffness_);
    return;
  }
  const Teuchos::RCP<MV> y = MVT::Clone(b, 1);
  preconditioner_.apply(b, LocalActiveSet{}, *y);
  preconditioner_.invalidate();
  stiffness_ = dot<Scalar>(b, b) / dot<Scalar>(b, *y);
  isSoftened_ = isSoftened_ && stiffness_ > 0.0 && std::isfinite(stiffness_);
}

template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::isAnywhere(bool isHere) const {
  return BT::maximum(*problem_.solution(), isHere ? 1.0 : 0.0) > 0.0;
}

// v ← Tv, where pairs slip and at springs.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::soften(MV& v) const {
  const double q = stiffness_;
  const Teuchos::RCP<MV> whole = Belos::MultiVecTraits<Scalar, MV>::CloneCopy(v);
  Sets::addAtSlips(
      active_, [q](double curvature) { return -curvature / (q + curvature); }, *whole, v);
  SpringOps<Scalar, MV>::share(active_, q, v);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::exchange(StateArchive<MV>& archive) {
  archive.vector("x", *problem_.solution());
  archive.vector("cg gradient on the face", *w_);
  archive.vector("cg direction", *p_);
  archive.number("cg has a face", hasFace_);
  makeFaceVectors();
  if (hasFace_) {
    archive.vector("cg gradient", *gradient_);
    exchangeFace(archive, "cg", problem_, *w_, active_);
    if (archive.isReading()) {
      isSettled_ = !isUnprojected_;
      // Bounds that another number of ranks has rounded differently. What follows is where its source had
      // it: limits themselves stay behind within a face, or are ahead after a look.
      LocalActiveSet still = active_;
      if (problem_.hasFollowingLimits())
        Kernels::leaveOut(problem_.followingLimits(), problem_.feasibleSet().discs, still);
      Sets::moveToBounds(*problem_.solution(), problem_.feasibleSet(), still);
    }
  }
  if (rows_.isPresent())
    archive.rowVector("cg projected away", *removed_);
  archive.number("cg equality residual", equalityResidual_);
  archive.number("cg equality distance", equalityDistance_);
  archive.number("cg has looked", hasLooked_);
  archive.number("cg residual", residual2_);
  archive.number("cg curvature bound", curvatureBound_);
  archive.number("cg load", rhsNorm_);
  if (problem_.hasFollowingLimits() || problem_.hasDiscs())
    archive.number("cg quotient", rayleigh_);
  if (problem_.hasSoftBounds()) {
    archive.number("cg stiffness", stiffness_);
    archive.number("cg springs", springNorm_);
  }
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
    isDeficient_ = isCoupled_ && hold() == 0.0;
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
    if (!preconditioner_.isPresent() && (problem_.hasFollowingLimits() || problem_.hasDiscs()))
      rayleigh_ = dot<Scalar>(x, *w_) / dot<Scalar>(x, x);
    MVT::MvAddMv(1.0, *w_, -1.0, *problem_.rhs(), *w_);
  } else {
    MVT::MvAddMv(-1.0, *problem_.rhs(), 0.0, *problem_.rhs(), *w_);
  }
  if (!isCoupled_) {
    kept_.minimise(x, *w_);
    if (kept_.size() > 0) // they are in the kernel to fewer digits
      lookAtRows();
  }
  if (hasFace_) {
    Sets::addCurvature(active_, 1.0, x, true, *w_);
    addSprings(x);
    MVT::Assign(*w_, *gradient_);
    isSettled_ = true;
    Sets::maskActive(*w_, active_);
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
  const double length = iterateNorm_ + rows_.valuesNorm();
  if (distance <= rounding * length || distance * rhsNorm_ <= residualNorm() * length)
    return false;
  ++counters_.confirmations;
  const LocalActiveSet active = active_;
  return start(active);
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
void ProjectedCg<Scalar, MV, OP>::raiseLevel(double iterateNorm2) {
  iterateNorm_ = std::sqrt(iterateNorm2);
  level_ = std::max(level_, std::numeric_limits<double>::epsilon() *
                                (curvatureBound_ * iterateNorm_ + rhsNorm_ + springNorm_));
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::residualNorm() const {
  return std::sqrt(residual2_);
}

template<class Scalar, class MV, class OP>
typename ProjectedCg<Scalar, MV, OP>::Slipping ProjectedCg<Scalar, MV, OP>::slipping() const {
  const double q = stiffness_ > 0.0 ? stiffness_ : curvatureBound_;
  if (!(problem_.hasDiscs() || hasSprings_) || !(q > 0.0))
    return {residualNorm(), 0.0};
  const SlipSums sums = Sets::slipSums(active_, q, *w_);
  return {std::sqrt(std::max(0.0, residual2_ - sums.along2 - sums.springs2) + sums.softened2 +
                    sums.softenedSprings2),
          sums.rims2 > 0.0 ? std::sqrt(sums.along2 / sums.rims2) : 0.0};
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::attainable() const {
  return level_;
}

template<class Scalar, class MV, class OP>
bool ProjectedCg<Scalar, MV, OP>::isRefinable() const {
  constexpr double most = 0.1;
  if (!hasSprings_ || staleness_ == 0)
    return false;
  const double epsilon = std::numeric_limits<double>::epsilon();
  const double springs = norm<Scalar>(*springForces(*problem_.solution()));
  return epsilon * (curvatureBound_ * iterateNorm_ + rhsNorm_ + springs) < most * level_;
}

template<class Scalar, class MV, class OP>
double ProjectedCg<Scalar, MV, OP>::cost() {
  const MV& x = *problem_.solution();
  if (rows_.isPresent() && rows_.valuesNorm() > 0.0) // else of no account
    settle();
  double ofSprings = 0.0; // ½κ(x − c)² − ½xκ(x − c)
  if (hasSprings_) {
    const Teuchos::RCP<MV> forces = Belos::MultiVecTraits<Scalar, MV>::Clone(x, 1);
    Belos::MultiVecTraits<Scalar, MV>::MvInit(*forces, 0.0);
    SpringOps<Scalar, MV>::add(active_, 1.0, x, true, *forces);
    ofSprings = -0.5 * SpringOps<Scalar, MV>::atCentres(active_, *forces);
  }
  return 0.5 * (dot<Scalar>(x, *gradient_) - dot<Scalar>(x, *problem_.rhs())) + ofSprings;
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::lagrangianGradient(MV& y) {
  settle();
  Belos::MultiVecTraits<Scalar, MV>::Assign(*gradient_, y);
  Sets::addCurvature(active_, -1.0, *problem_.solution(), true, y);
  if (rows_.isPresent())
    rows_.addTransposed(-1.0, *removed_, y);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::trueGradient(MV& y) {
  lagrangianGradient(y);
  SpringOps<Scalar, MV>::correct(problem_.softBounds(), active_, *problem_.solution(), y);
}

// To w, and how large what cancels there is.
template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::addSprings(const MV& x) {
  if (!hasSprings_)
    return;
  springNorm_ = norm<Scalar>(*springForces(x));
  SpringOps<Scalar, MV>::add(active_, 1.0, x, true, *w_);
}

// κx.
template<class Scalar, class MV, class OP>
Teuchos::RCP<MV> ProjectedCg<Scalar, MV, OP>::springForces(const MV& x) const {
  const Teuchos::RCP<MV> forces = Belos::MultiVecTraits<Scalar, MV>::Clone(x, 1);
  Belos::MultiVecTraits<Scalar, MV>::MvInit(*forces, 0.0);
  SpringOps<Scalar, MV>::add(active_, 1.0, x, false, *forces);
  return forces;
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::multiplier(MV& mu) {
  settle();
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(-1.0, *removed_, 0.0, *removed_, mu);
}

template<class Scalar, class MV, class OP>
void ProjectedCg<Scalar, MV, OP>::storeMultiplier() {
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
  state.equalityResidual = equalityResidual_;
  state.equalityDistance = equalityDistance_;
  state.decrease = std::numeric_limits<double>::quiet_NaN(); // not known
  state.outer = outer;
  state.inner = inner;
  state.counters = &counters_;
  return state;
}

} // namespace Harmos::qp
