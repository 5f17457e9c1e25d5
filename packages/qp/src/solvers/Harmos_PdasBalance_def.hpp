// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PdasSolver.hpp"

namespace Harmos::qp {

// How PDAS gets on where forces have limits on all sides: sets that balance, see BalancedActiveSet.

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::mayBalance() const {
  return next_.isFit() && (hasFollowing() || problem_.hasDiscs());
}

// Where limits follow, or pairs turn: from the best iterate on, all sets are balanced; then springs are
// stiffer, and steps shorter with them, which leads out of circles.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::balances(const std::string& why) {
  constexpr double factor = 4.0, stiffest = 256.0;
  if (!mayBalance() || stiffening_ >= stiffest)
    return false;
  stiffening_ *= balances_ ? factor : 1.0;
  balances_ = true;
  if (!bestGradient_.is_null()) {
    MVT::Assign(*best_, x_);
    set_ = bestSet_;
    next_.aim(x_, *bestGradient_, stiffening_ * cg_.stiffness());
  }
  progress_.forget();
  solver_.log_.detail("PDAS: " + why + "; sets are balanced, with springs " + scientific(stiffening_, 1) +
                      " times as stiff");
  return true;
}

// Onto the face. Where all that holds a body is at its limit, these forces need not balance, and where what
// is left holds it hardly, as the facets of a round body do, it is no better: another set does.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::startsOnFace() {
  constexpr double hardly = 1e-4; // of all forces that there are; a few points that touch have some 1e-3
  const bool isFit = next_.isFit() && !descent_.isOn();
  if (!(balances_ && isFit) && cg_.start(set_, isFit ? hardly : 0.0))
    return true;
  if (!isFit)
    return false;
  if (!next_.isAimed()) // the first set is none that can hold bodies
    next_.aim(x_, *y_, cg_.stiffness());
  return (next_.find(set_, active_) && cg_.start(set_)) || cg_.start(set_);
}

// What sets are balanced from.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::exchangeBest(StateArchive<MV>& archive) {
  bool isThere = !bestGradient_.is_null();
  archive.number("pdas has best gradient", isThere);
  if (!isThere)
    return;
  const Teuchos::RCP<MV> states = MVT::Clone(x_, 1);
  if (bestGradient_.is_null())
    bestGradient_ = MVT::Clone(x_, 1);
  archive.vector("pdas best gradient", *bestGradient_);
  BT::activeToVector(bestSet_, *states);
  archive.vector("pdas best set", *states);
  if (archive.isReading())
    BT::vectorToActive(*states, bestSet_);
  if (problem_.hasDiscs())
    exchangeSlips<Scalar>(archive, "pdas best", feasible_, x_, bestSet_);
}

} // namespace Harmos::qp
