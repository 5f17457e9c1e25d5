// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PdasSolver.hpp"

#include <cmath>

namespace Harmos::qp {

// What PDAS does about soft bounds.

// By the side where x is; where nothing is known, by that of the nearest feasible point, see FirstActiveSet.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::guessSprings() {
  Teuchos::RCP<MV> at = MVT::CloneCopy(x_);
  if (isCold_) {
    FirstActiveSet<Scalar, MV, OP> nearest(problem_, rows_, counters_);
    LocalActiveSet set = set_;
    long long active = 0;
    if (nearest.find(set, active))
      MVT::Assign(nearest.x(), *at);
  }
  sides_.update(*at, 0.0, set_);
  if (!isCold_)
    cg_.knowSprings(set_);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::lookAtSprings(double noise) {
  LocalActiveSet next = springsOf(set_);
  const SpringChange change = sides_.update(x_, noise, next);
  wrongSprings_ = 0.0;
  if (sides_.areFrozen())
    return;
  wrongSprings_ = std::sqrt(change.wrong2);
  set_.springs = next.springs;
  change_.changed += change.changed;
  for (int k : {0, 1})
    change_.signature[k] += change.signature[k];
}

// From the best iterate on, sides are those of points from which the cost falls.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::freezeSides(const std::string& why) {
  if (!hasNoOther() || sides_.areFrozen())
    return false;
  MVT::Assign(*best_.x, x_);
  sides_.freeze(x_, set_);
  progress_.forget();
  ++counters_.descents;
  solver_.log_.detail("PDAS: " + why +
                      "; sides of soft bounds frozen at the best iterate until the rest has converged");
  return true;
}

// x is the answer for these sides, y_ the true gradient. @return whether there are others, at a point below.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::moveSides() {
  if (!sides_.move(x_, *y_, set_))
    return false;
  progress_.forget();
  descent_.end();
  isMoved_ = true;
  return true;
}

} // namespace Harmos::qp
