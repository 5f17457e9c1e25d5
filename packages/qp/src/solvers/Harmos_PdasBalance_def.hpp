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
      balance_.paths > 0 ? std::max(stiffAtFirst, cg_.curvatureBound() / cg_.stiffness()) : stiffAtFirst;
  if (!mayBalance() || balance_.stiffening >= stiffest)
    return false;
  balance_.stiffening *= balance_.isOn || hasFollowing() ? factor : 1.0;
  balance_.isOn = true;
  if (!best_.gradient.is_null()) {
    MVT::Assign(*best_.x, x_);
    set_ = best_.set;
    next_.aim(x_, *best_.gradient, balance_.stiffening * cg_.stiffness());
  }
  progress_.forget();
  solver_.log_.detail("PDAS: " + why + "; balanced active sets with springs " +
                      scientific(balance_.stiffening, 1) + " times as stiff");
  return true;
}

// To the set of the end of a path through interior points; the second one goes further.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::restartFromInteriorPoint(const std::string& why) {
  constexpr int mostPaths = 2;
  const double q = cg_.stiffness();
  const int most = solver_.maximumIterations() - state_.inner;
  if (!(hasFollowing() || problem_.hasDiscs()) || balance_.paths >= mostPaths || !(q > 0.0) || most <= 0)
    return false;
  ++balance_.paths;
  solver_.log_.detail("PDAS: " + why + "; restart from an interior point");
  InteriorPath<Scalar, MV, OP> path(problem_, rows_, CgOptions::fromList(solver_.methodParameters("PCPG")),
                                    cg_.kept(), options_.mostKept, counters_, springsOf(set_));
  const bool isThrough = path.run(*best_.x, q, balance_.paths == 1 ? 1e-8 : 1e-11, most, [&] {
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
  options_.budget = std::min(options_.budget + path.steps(), solver_.maximumIterations());
  balance_.isOn = false;
  balance_.stiffening = 1.0;
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
  if (!(balance_.isOn && isFit) && cg_.start(set_, isFit ? hardly : 0.0))
    return true;
  if (!isFit)
    return false;
  if (!next_.isAimed()) // the first set is none that can hold bodies
    next_.aim(x_, *y_, cg_.stiffness());
  return (next_.find(set_, active_) && cg_.start(set_)) || cg_.start(set_);
}

} // namespace Harmos::qp
