// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_QpProblem.hpp"

#include <BelosMultiVecTraits.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
Problem<Scalar, MV, OP>::Problem(Teuchos::RCP<const OP> hessian, Teuchos::RCP<MV> solution,
                                 Teuchos::RCP<const MV> rhs)
    : hessian_(hessian), rhs_(rhs), solution_(solution) {}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessian(Teuchos::RCP<const OP> hessian) {
  hessian_ = hessian;
  hessianNorm_ = 0.0;
  refuse("setProblem() was not called after setHessian()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setRhs(Teuchos::RCP<const MV> rhs) {
  rhs_ = rhs;
  refuse("setProblem() was not called after setRhs()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setSolution(Teuchos::RCP<MV> solution) {
  solution_ = solution;
  refuse("setProblem() was not called after setSolution()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setLowerBound(Teuchos::RCP<const MV> lower) {
  lower_ = lower;
  refuse("setProblem() was not called after setLowerBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setUpperBound(Teuchos::RCP<const MV> upper) {
  upper_ = upper;
  refuse("setProblem() was not called after setUpperBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setDiscs(std::shared_ptr<const LocalDiscs> discs) {
  discs_ = std::move(discs);
  refuse("setProblem() was not called after setDiscs()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setFollowingLimits(std::shared_ptr<const FollowingLimits> limits) {
  following_ = std::move(limits);
  refuse("setProblem() was not called after setFollowingLimits()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setSoftBounds(std::shared_ptr<const LocalSoftBounds> bounds) {
  soft_ = std::move(bounds);
  refuse("setProblem() was not called after setSoftBounds()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::follow(const FollowUpdate& how, const MV* gradient) {
  FollowingOps<Scalar, MV>::follow(*solution_, gradient, how, *following_, *ownLower_, ownUpper_.get(),
                                   ownDiscs_.get());
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::moveToLimits(const LocalActiveSet& active) {
  FollowingOps<Scalar, MV>::moveToLimits(*solution_, feasibleSet(), *following_, active);
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::limits(MV& radii) const {
  FollowingOps<Scalar, MV>::limitsToVector(*following_, feasibleSet(), radii);
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setLimits(const MV& radii) {
  FollowingOps<Scalar, MV>::vectorToLimits(*following_, radii, *ownLower_, ownUpper_.get(), ownDiscs_.get());
}

// What follows must not be what others hold.
template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::ownLimits() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (lower_ != ownLower_)
    lower_ = ownLower_ = MVT::CloneCopy(*lower_);
  if (!upper_.is_null() && upper_ != ownUpper_)
    upper_ = ownUpper_ = MVT::CloneCopy(*upper_);
  if (discs_ && discs_ != ownDiscs_)
    discs_ = ownDiscs_ = std::make_shared<LocalDiscs>(*discs_);
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setEquality(Teuchos::RCP<const OP> rows, Teuchos::RCP<const MV> values,
                                          Teuchos::RCP<MV> multiplier, EqualityStructure structure) {
  equality_ = rows;
  equalityValues_ = values;
  multiplier_ = multiplier;
  structure_ = structure;
  refuse("setProblem() was not called after setEquality()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessianNorm(double norm) {
  hessianNorm_ = norm;
  refuse("setProblem() was not called after setHessianNorm()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setUnprojectedHessian(Teuchos::RCP<const OP> hessian) {
  unprojectedHessian_ = hessian;
  refuse("setProblem() was not called after setUnprojectedHessian()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setPreconditioner(Teuchos::RCP<const OP> preconditioner) {
  preconditioner_ = preconditioner;
  refuse("setProblem() was not called after setPreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setFacePreconditioner(Teuchos::RCP<FacePreconditioner<MV, OP>> maker) {
  facePreconditioner_ = maker;
  refuse("setProblem() was not called after setFacePreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setNullSpace(Teuchos::RCP<const MV> kernel) {
  nullSpace_ = kernel;
  refuse("setProblem() was not called after setNullSpace()");
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::refuse(const std::string& fault) {
  set_ = false;
  fault_ = fault;
  return false;
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::isFollowable() const {
  return std::all_of(following_->begin(), following_->end(), [this](const FollowingLimit& limit) {
    const auto length = static_cast<int>(discs_ ? discs_->length() : std::numeric_limits<int>::max());
    const bool isPlace = limit.isDisc ? discs_ && limit.place < static_cast<int>(discs_->discs().size())
                                      : !upper_.is_null() && limit.place < length;
    return limit.place >= 0 && isPlace && limit.source >= 0 && limit.source < length && limit.factor >= 0.0 &&
           std::isfinite(limit.factor);
  });
}

// Whether soft bounds are such, on entries without others. Local.
template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::areSoft() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<char> isTaken(soft_->length(), 0);
  if (hasDiscs())
    for (const Disc& disc : discs_->discs())
      for (int entry : {disc.first, disc.second})
        isTaken[static_cast<std::size_t>(entry)] = 1;
  if (hasFollowingLimits())
    for (const FollowingLimit& limit : *following_)
      if (!limit.isDisc && limit.place >= 0 && static_cast<std::size_t>(limit.place) < isTaken.size())
        isTaken[static_cast<std::size_t>(limit.place)] = 1;
  const auto markBounded = [&](const Teuchos::RCP<const MV>& bound) {
    if (bound.is_null())
      return;
    const double* const values = BoundTraits<Scalar, MV>::read(*bound);
    for (std::size_t i = 0; i < isTaken.size(); ++i)
      if (std::abs(values[i]) != infinity)
        isTaken[i] = 1;
  };
  markBounded(lower_);
  markBounded(upper_);
  return std::all_of(soft_->bounds().begin(), soft_->bounds().end(), [&](const SoftBound& bound) {
    return bound.lower <= bound.upper && bound.lower < infinity && bound.upper > -infinity &&
           bound.curvature >= 0.0 && std::isfinite(bound.curvature) &&
           isTaken[static_cast<std::size_t>(bound.entry)] == 0;
  });
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::setProblem() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (hessian_.is_null() || rhs_.is_null() || solution_.is_null())
    return refuse("the Hessian, the right-hand side or the solution vector is missing");
  if (MVT::GetNumberVecs(*rhs_) != 1 || MVT::GetNumberVecs(*solution_) != 1)
    return refuse("the right-hand side and the solution must have one column each");
  const auto length = MVT::GetGlobalLength(*solution_);
  if (MVT::GetGlobalLength(*rhs_) != length)
    return refuse("the right-hand side and the solution differ in length");
  for (const Teuchos::RCP<const MV>& bound : {lower_, upper_})
    if (!bound.is_null() && MVT::GetGlobalLength(*bound) != length)
      return refuse("a bound and the solution differ in length");
  const auto onAnyRank = [&](bool is) {
    return BoundTraits<Scalar, MV>::maximum(*solution_, is ? 1.0 : 0.0) > 0.0;
  };
  if (onAnyRank(hasDiscs()) && onAnyRank(!hasDiscs()))
    return refuse("discs are given on some ranks only; give empty ones on the others");
  if (hasDiscs() && onAnyRank(!BoundOps<Scalar, MV>::isFit(*solution_, *discs_)))
    return refuse("discs do not match the length of the solution on a rank");
  if (onAnyRank(hasSoftBounds()) && onAnyRank(!hasSoftBounds()))
    return refuse("soft bounds are given on some ranks only; give empty ones on the others");
  if (hasSoftBounds() && onAnyRank(!BoundOps<Scalar, MV>::isFit(*solution_, *soft_)))
    return refuse("soft bounds do not match the length of the solution on a rank");
  if (hasSoftBounds() && onAnyRank(!areSoft()))
    return refuse(
        "a soft bound is not a number, its lower end exceeds the upper one, its curvature is negative or not "
        "finite, or its entry has another bound, a disc or a solution-dependent limit");
  const BoundFault fault = BoundOps<Scalar, MV>::findBoundFault(*solution_, feasibleSet());
  if (fault.found && !(fault.lower > fault.upper))
    return refuse("the bounds of entry " + std::to_string(fault.entry) +
                  " are not numbers, a lower one is +infinity or an upper one -infinity, or the entry is in "
                  "a disc and also has bounds, or its disc has a centre or radius that is not finite");
  if (onAnyRank(hasFollowingLimits()) && onAnyRank(!hasFollowingLimits()))
    return refuse("solution-dependent limits are given on some ranks only; give empty ones on the others");
  if (hasFollowingLimits()) {
    if (lower_.is_null() || onAnyRank(!isFollowable()))
      return refuse("a solution-dependent limit belongs to no interval or disc, depends on an entry without "
                    "lower bound, or has a factor that is negative or not a number");
    ownLimits();
  }
  if (!nullSpace_.is_null() && MVT::GetGlobalLength(*nullSpace_) != length)
    return refuse("the null space and the solution differ in length");
  if (!equality_.is_null() && (equalityValues_.is_null() || multiplier_.is_null()))
    return refuse("equality rows need their right-hand side and a multiplier vector");
  if (!equality_.is_null() && MVT::GetGlobalLength(*equalityValues_) != MVT::GetGlobalLength(*multiplier_))
    return refuse("the right-hand side of the equalities and the multiplier differ in length");
  if (!unprojectedHessian_.is_null() &&
      (equality_.is_null() || structure_ != EqualityStructure::OrthonormalInvariant))
    return refuse("a Hessian that is not yet projected needs equality rows with A = PFP; declare them with "
                  "EqualityStructure::OrthonormalInvariant");
  if (!(hessianNorm_ >= 0.0))
    return refuse("the given norm of the Hessian is negative or not a number");
  set_ = true;
  fault_.clear();
  return true;
}

} // namespace Harmos::qp
