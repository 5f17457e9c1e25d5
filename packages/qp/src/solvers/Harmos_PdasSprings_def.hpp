// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PdasSolver.hpp"

#include <algorithm>
#include <limits>

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
  SpringOps<Scalar, MV>::update(*at, *problem_.softBounds(), 0.0, *random_, set_);
  if (!isCold_)
    cg_.knowSprings(set_);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::lookAtSprings(double noise) {
  LocalActiveSet next = springsOf(set_);
  const SpringChange change =
      SpringOps<Scalar, MV>::update(x_, *problem_.softBounds(), noise, *random_, next);
  wrongSprings_ = 0.0;
  if (sidesFrozen_)
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
  if (!hasNoOther() || sidesFrozen_)
    return false;
  sidesFrozen_ = true;
  sidesAt_ = Teuchos::null;
  MVT::Assign(*best_, x_);
  SpringOps<Scalar, MV>::update(x_, *problem_.softBounds(), 0.0, *random_, set_);
  progress_.forget();
  ++counters_.descents;
  solver_.log_.detail("PDAS: " + why +
                      "; sides of soft bounds frozen at the best iterate until the rest has converged");
  return true;
}

// x is the answer for these sides, y_ the true gradient. With the quadratic that has the gradient of the cost
// at the point before, what leads from there to its least point leads downwards; along that line the slope of
// the cost rises, and is known from both ends.
// @return whether there is another set of sides, at a point below.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::moveSides() {
  constexpr int mostSteps = 1000, mostHalvings = 60;
  const LocalSoftBounds& bounds = *problem_.softBounds();
  const Teuchos::RCP<MV> smooth = MVT::Clone(x_, 1); // y without springs
  MVT::MvInit(*smooth, 0.0);
  SpringOps<Scalar, MV>::addForces(&bounds, x_, *smooth);
  MVT::MvAddMv(1.0, *y_, -1.0, *smooth, *smooth);
  if (!sidesAt_.is_null()) {
    const Teuchos::RCP<MV> d = MVT::Clone(x_, 1), at = MVT::Clone(x_, 1);
    MVT::MvAddMv(1.0, x_, -1.0, *sidesAt_, *d);
    const double first = dot<Scalar>(*d, *sidesGradient_), last = dot<Scalar>(*d, *smooth);
    const auto slope = [&](double t) {
      MVT::MvAddMv(1.0, *sidesAt_, t, *d, *at);
      return (1.0 - t) * first + t * last + SpringOps<Scalar, MV>::power(bounds, *at, *d);
    };
    if (!(slope(0.0) < 0.0))
      return false;
    double below = 0.0, above = 1.0;
    if (slope(1.0) > 0.0) {
      for (int k = 0; k < mostHalvings; ++k) {
        const double middle = 0.5 * (below + above);
        (slope(middle) > 0.0 ? above : below) = middle;
      }
      MVT::MvAddMv(1.0, *sidesAt_, below, *d, x_);
      MVT::MvAddMv(1.0 - below, *sidesGradient_, below, *smooth, *smooth);
    }
  }
  const SpringChange change = SpringOps<Scalar, MV>::update(
      x_, bounds, 10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(x_), *random_, set_);
  if (change.changed == 0 || ++sideSteps_ > mostSteps)
    return false;
  sidesAt_ = MVT::CloneCopy(x_);
  sidesGradient_ = smooth;
  progress_.forget();
  descent_.end();
  isMoved_ = true;
  return true;
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::exchangeSides(StateArchive<MV>& archive) {
  exchangeSprings<Scalar>(archive, "pdas", problem_.softBounds(), x_, set_);
  archive.number("pdas holds sides", sidesFrozen_);
  archive.number("pdas side steps", sideSteps_);
  bool isThere = !sidesAt_.is_null();
  archive.number("pdas has sides", isThere);
  if (!isThere)
    return;
  if (sidesAt_.is_null()) {
    sidesAt_ = MVT::Clone(x_, 1);
    sidesGradient_ = MVT::Clone(x_, 1);
  }
  archive.vector("pdas sides at", *sidesAt_);
  archive.vector("pdas sides gradient", *sidesGradient_);
}

} // namespace Harmos::qp
