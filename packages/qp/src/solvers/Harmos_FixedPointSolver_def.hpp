// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConeProbe.hpp"
#include "Harmos_FixedPointSolver.hpp"
#include "Harmos_SolverManager_def.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> FixedPointSolver<Scalar, MV, OP>::clone() const {
  const auto copy = Teuchos::rcp(new FixedPointSolver(inner_));
  if (!this->parameters_.is_null())
    copy->setParameters(Teuchos::rcp(new Teuchos::ParameterList(*this->parameters_)));
  return copy;
}

template<class Scalar, class MV, class OP>
void FixedPointSolver<Scalar, MV, OP>::doSolve() {
  constexpr int mostUpdates = 100;
  rows_ = this->makeRows();
  if (rows_.is_null())
    return;
  begin();
  while (true) {
    solveFrozen();
    if (this->result_.reason == Reason::Infeasible) {
      if (!findsLimits())
        return;
      continue;
    }
    if (this->result_.reason != Reason::Converged)
      return;
    if (isAnswer())
      return tellContraction();
    if (++updates_ > mostUpdates)
      return this->stop(Reason::Stagnation, Explanations::limitsDoNotSettle(mostUpdates));
    relax();
  }
}

template<class Scalar, class MV, class OP>
void FixedPointSolver<Scalar, MV, OP>::begin() {
  const MV& x = *this->problem_->solution();
  radii_ = MVT::Clone(x, 1);
  step_ = MVT::Clone(x, 1);
  lastStep_ = MVT::Clone(x, 1);
  MVT::MvInit(*step_, 0.0);
  MVT::MvInit(*lastStep_, 0.0);
  // Without a guess limits are open: what sticks everywhere tells the first ones.
  if (norm<Scalar>(x) > 0.0)
    this->problem_->follow();
  this->problem_->limits(*radii_);
  this->describeDelegation([this](StateArchive<MV>& archive) {
    archive.vector("fixed point radii", *radii_);
    archive.vector("fixed point last step", *lastStep_);
    archive.number("fixed point share", share_);
    archive.number("fixed point wrong", wrong_);
    archive.number("fixed point updates", updates_);
    archive.number("fixed point retreats", retreats_);
    archive.number("fixed point growth", growth_);
    if (archive.isReading())
      this->problem_->setLimits(*radii_);
  });
}

// Nobody is asked whether to accept what is no answer yet.
template<class Scalar, class MV, class OP>
void FixedPointSolver<Scalar, MV, OP>::solveFrozen() {
  this->resumeDelegation();
  const Teuchos::RCP<Solver> inner = inner_->clone();
  // A tenth of what was wrong with the limits before.
  constexpr double share = 0.1, ofEqualities = 1e-3;
  using Test = Teuchos::RCP<StatusTest<MV>>;
  Test enough;
  if (wrong_ > 0.0) {
    const Test gradient = Teuchos::rcp(new StatusTestProjectedGradient<MV>(share, wrong_)),
               equality = Teuchos::rcp(new StatusTestEqualityDistance<MV, Scalar>(ofEqualities, 0.0));
    enough = Teuchos::rcp(new StatusTestCombo<MV>(StatusTestCombo<MV>::Type::And, {gradient, equality}));
  }
  this->delegate(*inner, {this->problem_->frozen(), enough, false});
}

// That these limits cannot hold says nothing of others: towards those of the last program that had a
// solution, or to those of forces that hold; if there are none, that is proven.
template<class Scalar, class MV, class OP>
bool FixedPointSolver<Scalar, MV, OP>::findsLimits() {
  constexpr int mostRetreats = 10, mostSteps = 5000;
  if (++retreats_ > mostRetreats) {
    this->stop(Reason::Stagnation, Explanations::limitsDoNotSettle(updates_));
    return false;
  }
  if (updates_ > 0 && retreats_ % 2 == 1) {
    share_ *= 0.5;
    MVT::MvAddMv(1.0, *radii_, -share_, *lastStep_, *radii_);
    this->problem_->setLimits(*radii_);
    return true;
  }
  ConeProbe<Scalar, MV, OP> probe(*this->problem_, *rows_);
  const Teuchos::RCP<MV> y = rows_->makeVector();
  Certificate certificate;
  if (probe.run(mostSteps, *y, certificate) == ConeProbe<Scalar, MV, OP>::Verdict::Infeasible) {
    this->stopInfeasible(y, certificate);
    return false;
  }
  MVT::Assign(probe.x(), *this->problem_->solution());
  this->problem_->follow();
  this->problem_->limits(*radii_);
  MVT::MvInit(*lastStep_, 0.0);
  return true;
}

// Whether the answer to these limits is one to the limits that belong to it.
template<class Scalar, class MV, class OP>
bool FixedPointSolver<Scalar, MV, OP>::isAnswer() {
  MV& x = *this->problem_->solution();
  const Teuchos::RCP<MV> gradient = MVT::Clone(x, 1);
  MVT::MvInit(*gradient, 0.0);
  ActiveFace set;
  Bounds::split(x, *gradient, this->problem_->feasibleSet(), 1.0, nullptr, set);
  this->problem_->follow();
  this->problem_->limits(*step_);
  MVT::MvAddMv(1.0, *step_, -1.0, *radii_, *step_);
  this->problem_->moveToLimits(set);
  IterationState<MV> state = measure();
  wrong_ = state.projectedGradient;
  while (this->judge(state) == Reason::Converged) {
    if (this->accepted()) {
      this->stopFor(Reason::Converged, state);
      return true;
    }
  }
  return false;
}

// x as it is returned, and its gradient computed anew.
template<class Scalar, class MV, class OP>
IterationState<MV> FixedPointSolver<Scalar, MV, OP>::measure() {
  Problem<Scalar, MV, OP>& problem = *this->problem_;
  Counters& counters = this->result_.counters;
  MV& x = *problem.solution();
  Terms::project(problem.blocks(), x);
  const Teuchos::RCP<MV> gradient = MVT::Clone(x, 1);
  ++counters.confirmations;
  ++counters.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem.hessian(), x, *gradient);
  MVT::MvAddMv(1.0, *gradient, -1.0, *problem.rhs(), *gradient);
  Terms::addForces(problem.blocks(), x, *gradient);
  IterationState<MV> state;
  if (rows_->isPresent()) {
    const Teuchos::RCP<MV> mu = rows_->makeVector(), residual = rows_->makeVector();
    rows_->toInternal(*problem.multiplier(), *mu);
    rows_->addTransposed(1.0, *mu, *gradient);
    rows_->residual(x, *residual);
    state.equalityResidual = rows_->residualNorm();
    state.equalityDistance = rows_->distance();
  }
  state.x = &x;
  state.projectedGradient =
      Terms::projectedGradientNorm(problem.feasibleSet(), problem.blocks(), x, *gradient);
  state.decrease = std::numeric_limits<double>::quiet_NaN(); // not known
  state.outer = updates_ + 1;
  state.inner = this->result_.lastRecord().inner;
  state.counters = &counters;
  return state;
}

// Where limits do not contract another start may lead elsewhere; where they do it cannot nearby.
template<class Scalar, class MV, class OP>
void FixedPointSolver<Scalar, MV, OP>::tellContraction() {
  if (growth_ >= 1.0)
    this->log_.info("Note: solution-dependent limits changed by up to " + scientific(growth_, 1) +
                    " times the previous change, so the solution need not be unique. Check with another "
                    "initial guess or smaller load steps");
}

// s by Aitken's rule.
template<class Scalar, class MV, class OP>
void FixedPointSolver<Scalar, MV, OP>::relax() {
  constexpr double leastShare = 0.05, open = 1e50;
  const double size = norm<Scalar>(*step_);
  if (!(size < open)) { // of limits that were open
    this->problem_->limits(*radii_);
    MVT::MvInit(*lastStep_, 0.0);
    return;
  }
  const Teuchos::RCP<MV> change = MVT::Clone(*step_, 1);
  MVT::MvAddMv(1.0, *step_, -1.0, *lastStep_, *change);
  const double change2 = dot<Scalar>(*change, *change), last = norm<Scalar>(*lastStep_);
  constexpr double significant = 1e-3; // what is less may be errors of the solutions
  if (last > significant * norm<Scalar>(*radii_) && share_ == 1.0)
    growth_ = std::max(growth_, size / last);
  if (last > 0.0 && change2 > 0.0)
    share_ = std::clamp(-share_ * dot<Scalar>(*lastStep_, *change) / change2, leastShare, 1.0);
  this->log_.detail(this->name() + ": limits changed by " + scientific(size) +
                    (last > 0.0 ? ", " + scientific(size / last, 2) + " of the previous change" : "") +
                    "; relaxation factor " + scientific(share_, 2));
  MVT::MvAddMv(1.0, *radii_, share_, *step_, *radii_);
  MVT::Assign(*step_, *lastStep_);
  this->problem_->setLimits(*radii_);
}

} // namespace Harmos::qp
