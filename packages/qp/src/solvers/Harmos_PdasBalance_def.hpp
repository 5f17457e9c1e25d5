// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PdasSolver.hpp"

namespace Harmos::qp {

// How PDAS gets on where forces have limits on all sides: sets that balance, see BalancedActiveSet.

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::mayBalance() const {
  return next_.isFit() && (hasFollowing() || problem_.hasDiscs());
}

// Where limits follow, or pairs turn: from the best iterate on, all sets are balanced; springs are stiffer,
// and steps shorter with them, which leads out of circles. As stiff as A they have no say any more. Where
// limits follow, springs as soft as the solution lead back into the circle: sets that nothing holds were
// balanced with these before.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::balanceSets(const std::string& why) {
  constexpr double factor = 10.0, stiffAtFirst = 100.0;
  const double stiffest =
      paths_ > 0 ? std::max(stiffAtFirst, cg_.curvatureBound() / cg_.stiffness()) : stiffAtFirst;
  if (!mayBalance() || stiffening_ >= stiffest)
    return false;
  stiffening_ *= balances_ || hasFollowing() ? factor : 1.0;
  balances_ = true;
  if (!bestGradient_.is_null()) {
    MVT::Assign(*best_, x_);
    set_ = bestSet_;
    next_.aim(x_, *bestGradient_, stiffening_ * cg_.stiffness());
  }
  progress_.forget();
  solver_.log_.detail("PDAS: " + why + "; balanced active sets with springs " + scientific(stiffening_, 1) +
                      " times as stiff");
  return true;
}

// To the set of the end of a path through interior points; the second one goes further.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::restartFromInteriorPoint(const std::string& why) {
  constexpr int mostPaths = 2;
  const double q = cg_.stiffness();
  const int most = solver_.maximumIterations() - state_.inner;
  if (!(hasFollowing() || problem_.hasDiscs()) || paths_ >= mostPaths || !(q > 0.0) || most <= 0)
    return false;
  ++paths_;
  solver_.log_.detail("PDAS: " + why + "; restart from an interior point");
  InteriorPath<Scalar, MV, OP> path(problem_, rows_, CgOptions::fromList(solver_.methodParameters("PCPG")),
                                    cg_.kept(), mostKept_, counters_, springsOf(set_));
  const bool isThrough = path.run(*best_, q, paths_ == 1 ? 1e-8 : 1e-11, most, [&] {
    IterationState<MV> now = state_;
    now.inner += path.steps();
    const std::optional<Reason> reason = solver_.judge(now);
    return reason && (*reason == Reason::TimeLimit || *reason == Reason::IterationLimit);
  });
  if (!std::isfinite(norm<Scalar>(path.x()) + norm<Scalar>(path.y())))
    return false;
  MVT::Assign(path.x(), x_);
  if (hasFollowing())
    solver_.problem_->follow();
  findSetBeside(path.x(), path.y(), q);
  cg_.knowSprings(set_);
  state_.inner += path.steps();
  // Its share is that of sets: what would take over where limits follow has no better way.
  budget_ = std::min(budget_ + path.steps(), solver_.maximumIterations());
  balances_ = false;
  stiffening_ = 1.0;
  progress_ = {};
  solver_.log_.detail("PDAS: " + std::to_string(path.steps()) + " steps, " +
                      (isThrough ? "path complete" : "path incomplete") + "; its active set is next");
  return true;
}

// That of x − y/q: what is outside is active.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::findSetBeside(const MV& x, const MV& y, double q) {
  constexpr double touching = 1e-9;
  const Teuchos::RCP<MV> v = MVT::Clone(x, 1), inside = MVT::Clone(x, 1), gradient = MVT::Clone(x, 1);
  MVT::MvAddMv(1.0, x, -1.0 / q, y, *v);
  set_.assign(set_.size(), 0);
  set_.slipping.clear();
  const double noise = touching * norm<Scalar>(x);
  for (int pass = 0; pass < 2; ++pass) { // the second for what was at its other bound
    MVT::Assign(*v, *inside);
    Sets::moveToBounds(*inside, feasible_, set_);
    MVT::MvAddMv(q, *inside, -q, *v, *gradient);
    active_ =
        Sets::updateActiveSet(*inside, *gradient, feasible_, noise, q * noise, set_, {1.0 / q, 0.0}).active;
  }
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
  Sets::activeToVector(bestSet_, *states);
  archive.vector("pdas best set", *states);
  if (archive.isReading())
    Sets::vectorToActive(*states, bestSet_);
  if (problem_.hasDiscs())
    exchangeSlips<Scalar>(archive, "pdas best", feasible_, x_, bestSet_);
  exchangeSprings<Scalar>(archive, "pdas best", problem_.softBounds(), x_, bestSet_);
}

} // namespace Harmos::qp
