// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PdasSolver.hpp"

#include <cmath>
#include <limits>

namespace Harmos::qp {

// The first active set of PDAS.

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::begin() {
  isCold_ = norm<Scalar>(x_) == 0.0 && (!rows_.isPresent() || norm<Scalar>(*problem_.multiplier()) == 0.0);
  if (hasFollowing() && !isCold_)
    solver_.problem_->follow();
  Bounds::project(x_, feasible_);
  best_.x = MVT::CloneCopy(x_);
  if (rows_.isPresent()) {
    best_.multiplier = rows_.makeVector();
    MVT::MvInit(*best_.multiplier, 0.0);
  }
  describeState();
  if (solver_.resumes()) {
    solver_.resume();
    resumed_ = true;
    newFace_ = false;
  } else {
    guess();
    cg_.lookAtRows();
  }
  state_ = evaluate(resumed_ ? cg_.residualNorm() : std::numeric_limits<double>::infinity(), inner_);
}

// Whether x is at each bound there is: in contact, no load acts on a body as a whole. Elsewhere the gradient
// knows the elasticity of what is pushed against the bounds. Where loads cancel, what is left of them on a
// whole body is rounding errors.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isAtAllBounds(double scale) {
  const auto count = [this](const MV& x) {
    const Teuchos::RCP<MV> none = MVT::Clone(x_, 1);
    MVT::MvInit(*none, 0.0);
    LocalActiveSet active;
    const FeasibleSet<MV> bounds = {feasible_.lower, feasible_.upper, nullptr};
    return Sets::updateActiveSet(x, *none, bounds, 0.0, 0.0, active).active;
  };
  constexpr double beyond = 1e100, rounding = 1e-10; // all bounds; of an entry
  const double slack = std::max(std::numeric_limits<double>::min(),
                                rounding * scale / std::sqrt(static_cast<double>(MVT::GetGlobalLength(x_))));
  const Teuchos::RCP<MV> below = MVT::CloneCopy(x_), outside = MVT::Clone(x_, 1);
  // Just outside, those that x is at; far outside, all.
  MVT::MvInit(*outside, -slack);
  MVT::MvAddMv(1.0, x_, 1.0, *outside, *below);
  const long long here = count(*below);
  MVT::MvInit(*outside, -beyond);
  const long long all = count(*outside);
  return all > 0 && here == all;
}

// The first active set. From a solution nearby, or where there is no better guess: entries at a bound that
// the gradient pushes against it. The gradient costs a product where x is not zero.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::guess() {
  guessBounds();
  if (isCold_ && hasFollowing())
    freeFollowing();
}

// Without limits there are forces that hold whatever can be held, and the face has a solution.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::freeFollowing() {
  for (const FollowingLimit& limit : problem_.followingLimits()) {
    if (!limit.isDisc) {
      set_[static_cast<std::size_t>(limit.place)] = 0;
      continue;
    }
    const Disc& disc = feasible_.discs->discs()[static_cast<std::size_t>(limit.place)];
    for (int entry : {disc.first, disc.second})
      set_[static_cast<std::size_t>(entry)] = 0;
  }
  set_.slipping.clear();
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::guessBounds() {
  MVT::MvAddMv(-1.0, *problem_.rhs(), 0.0, *problem_.rhs(), *y_);
  addMultiplier();
  Bounds::split(x_, *y_, feasible_, 1.0, nullptr, set_);
  if (problem_.hasSoftBounds())
    guessSprings();
  if (isCold_ && options_.firstSet != FirstSet::Gradient) {
    FirstActiveSet<Scalar, MV, OP> nearest(problem_, rows_, counters_);
    if (options_.firstSet == FirstSet::Nearest || isAtAllBounds(nearest.scale())) {
      if (nearest.find(set_, active_))
        return;
    } else if (options_.firstSet == FirstSet::Tried && triesNearest(nearest)) {
      return;
    }
  }
  LocalActiveSet pushed = set_;
  change_ = Sets::updateActiveSet(x_, *y_, feasible_, 0.0, 0.0, pushed);
  if (norm<Scalar>(x_) > 0.0)
    started_ = startsWithActive();
  else
    set_ = pushed;
  active_ = change_.active;
}

// Loads on bodies as a whole: the set of the nearest point is much the better one for solids, and none at all
// for membranes pushed evenly against others. The residual on its face tells.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::triesNearest(FirstActiveSet<Scalar, MV, OP>& nearest) {
  LocalActiveSet set = set_;
  long long active = 0;
  if (!nearest.find(set, active))
    return false;
  const Teuchos::RCP<MV> load = MVT::CloneCopy(*problem_.rhs()), before = MVT::CloneCopy(x_);
  if (rows_.isPresent()) { // its part in the kernel of the rows
    const Teuchos::RCP<MV> removed = rows_.makeVector();
    rows_.apply(*load, *removed);
    rows_.addTransposed(-1.0, *removed, *load);
  }
  // On solids 0.01 to 0.12 was measured, where the set was none 0.2 to 1.
  constexpr double good = 0.15;
  started_ = cg_.start(set) && cg_.residualNorm() <= good * norm<Scalar>(*load);
  if (!started_) {
    MVT::Assign(*before, x_);
    return false;
  }
  set_ = set;
  active_ = active;
  return true;
}

// If the gradient at zero, which costs nothing, mostly pushes against the bounds that x is at, its product is
// made on the face where all of them are active, as the first one of that face's solution.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::startsWithActive() {
  const Teuchos::RCP<MV> projected = MVT::CloneCopy(x_), free = MVT::CloneCopy(*y_);
  Sets::maskActive(*free, set_);
  const double atBounds2 = dot<Scalar>(*y_, *y_) - dot<Scalar>(*free, *free);
  if (change_.wrongSign2 <= 0.1 * atBounds2 && cg_.start(set_)) {
    cg_.lagrangianGradient(*y_);
    change_ = Sets::updateActiveSet(x_, *y_, feasible_,
                                    10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(x_),
                                    10.0 * cg_.attainable(), set_);
    return change_.changed == 0;
  }
  MVT::Assign(*projected, x_);
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), x_, *y_);
  MVT::MvAddMv(1.0, *y_, -1.0, *problem_.rhs(), *y_);
  addMultiplier();
  change_ = Sets::updateActiveSet(x_, *y_, feasible_, 0.0, 0.0, set_);
  return false;
}

// Cᵀμ of the problem's multiplier.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::addMultiplier() {
  if (!rows_.isPresent())
    return;
  const Teuchos::RCP<MV> mu = rows_.makeVector();
  rows_.toInternal(*problem_.multiplier(), *mu);
  rows_.addTransposed(1.0, *mu, *y_);
}

} // namespace Harmos::qp
