// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver_def.hpp"
#include "Harmos_MprgpSolver_def.hpp"
#include "Harmos_SmalbeSolver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
ParameterSpec SmalbeSolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("SMALBE", "Semimonotonic augmented Lagrangians for bounds and equalities.");
  spec.choice(
      "Update rule", "precision",
      {{"precision", "SMALBE-M: fixed penalty ρ; M is reduced if the Lagrangian does not rise enough"},
       {"penalty", "Algorithm 4.1 of Dostál, Horák, Vlach: fixed M; ρ grows if feasibility improves slowly"},
       {"both", "both M and ρ are adapted, each by its own rule"}},
      "Quantity that the outer iterations adapt.");
  spec.choice("Parameter scaling", "relative",
              {{"relative", "Initial penalty and M are multiples of ‖A‖, equality tolerances of ‖b‖/‖A‖ and "
                            "gradient tolerances of ‖b‖"},
               {"absolute", "absolute values"}},
              "Units of the parameters below.");
  spec.real("Initial penalty", 1.0, Range::above(0.0), "ρ₀.");
  spec.real("M", 10.0, Range::above(0.0), "Inner precision ‖g^P‖ ≤ M‖Cx − c‖.");
  spec.real("Inner tolerance", 0.1, Range::above(0.0),
            "Rules `precision` and `both`: η, the largest ‖g^P‖ at the end of an inner loop.");
  spec.real("Precision factor", 0.1, Range::strictlyWithin(0.0, 1.0),
            "Rules `precision` and `both`: θ, M ← θM.");
  spec.real("Equality tolerance", 0.1, Range::above(0.0),
            "Rules `penalty` and `both`: η₀, the first bound on ‖Cx − c‖.");
  spec.real("Tolerance factor", 0.1, Range::strictlyWithin(0.0, 1.0),
            "Rules `penalty` and `both`: α, η ← αη.");
  spec.real("Penalty factor", 10.0, Range::above(1.0), "Rules `penalty` and `both`: β, ρ ← βρ.");
  spec.real("Maximum penalty", 1000.0, Range::above(0.0),
            "Largest ρ. The rounding errors of the gradient grow with ρ, and the method converges for any "
            "fixed ρ.");
  spec.integer("Slow iterations", 4, 1, 1000000,
               "All rules: ρ ← βρ after this number of outer iterations in a row that did not halve "
               "‖Cx − c‖, as with rows that are nearly dependent in the free entries.");
  spec.integer("Maximum outer iterations", 10000, 1, 1000000000, "Largest number of outer iterations.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& SmalbeSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("SMALBE", "The solver for bounds and equalities.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::doSolve() {
  if (!this->problem_->hasEqualities()) {
    this->log_.info("Note: without equalities, SMALBE is MPRGP");
    MprgpSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (!rows.is_null())
    Run(*this, *rows).go();
}

template<class Scalar, class MV, class OP>
SmalbeSolver<Scalar, MV, OP>::Run::Run(SmalbeSolver& solver, EqualityRows<Scalar, MV, OP>& rows)
    : solver_(solver),
      rows_(rows),
      list_(solver.methodParameters("SMALBE")),
      byPenalty_(list_.get<std::string>("Update rule") != "precision"),
      byPrecision_(list_.get<std::string>("Update rule") != "penalty"),
      lagrangian_(*solver.problem_, rows, MprgpOptions::fromList(solver.methodParameters("MPRGP")),
                  solver.result_.counters, solver.resumes()) {
  const Scales scale = scales();
  penalty_ = scale.norm / scale.row * list_.get<double>("Initial penalty");
  precision_ = scale.norm * list_.get<double>("M");
  innerTolerance_ = byPrecision_ ? scale.gradient * list_.get<double>("Inner tolerance")
                                 : std::numeric_limits<double>::infinity();
  equalityTolerance_ = scale.equality * list_.get<double>("Equality tolerance");
  largestPenalty_ = std::max(penalty_, scale.norm / scale.row * list_.get<double>("Maximum penalty"));
}

template<class Scalar, class MV, class OP>
typename SmalbeSolver<Scalar, MV, OP>::Run::Scales SmalbeSolver<Scalar, MV, OP>::Run::scales() const {
  Scales scale;
  scale.row = std::sqrt(rows_.norm2());
  if (list_.get<std::string>("Parameter scaling") != "relative")
    return scale;
  scale.gradient = norm<Scalar>(*solver_.problem_->rhs());
  // Without a Hessian (a linear program) the load over the distance to the equalities is all there is.
  const double distance = rows_.valuesNorm() / scale.row;
  scale.norm = lagrangian_.hessianNorm();
  if (!(scale.norm > 0.0))
    scale.norm = scale.gradient > 0.0 ? scale.gradient / (distance > 0.0 ? distance : 1.0) : 1.0;
  if (scale.gradient == 0.0) // what holds x on the equalities is the load
    scale.gradient = scale.norm * distance;
  scale.equality = scale.gradient / scale.norm * scale.row;
  scale.norm /= scale.row;
  return scale;
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::exchange(StateArchive<MV>& archive) {
  archive.number("smalbe penalty", penalty_);
  archive.number("smalbe precision", precision_);
  archive.number("smalbe inner tolerance", innerTolerance_);
  archive.number("smalbe equality tolerance", equalityTolerance_);
  archive.number("smalbe largest penalty", largestPenalty_);
  archive.number("smalbe previous value", previous_.value);
  archive.number("smalbe previous residual", previous_.residual);
  archive.number("smalbe feasible", watch_.feasible);
  archive.number("smalbe slow", watch_.slow);
  archive.number("smalbe patience", watch_.patience);
  archive.number("smalbe previous inner", previous_.inner);
  archive.number("smalbe stretch", stretch_);
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::go() {
  state_ = solver_.begin(lagrangian_, penalty_, precision_,
                         [this](StateArchive<MV>& archive) { exchange(archive); });
  const auto precise = [this](const IterationState<MV>& state) { return isPrecise(state); };
  // Step 1: the inner loop; Step 2, the stop, is part of it.
  while (solver_.minimise(lagrangian_, state_, precise, precision_)) {
    solver_.result_.penalty = lagrangian_.penalty();
    if (isSpent() || isInfeasible())
      break;
    // Steps 3 and 4.
    adaptPenalty();
    if (byPrecision_)
      adaptPrecision();
    updateMultiplier();
  }
  finish();
}

template<class Scalar, class MV, class OP>
bool SmalbeSolver<Scalar, MV, OP>::Run::isSpent() {
  const int limit = list_.get<int>("Maximum outer iterations");
  if (state_.outer < limit)
    return false;
  solver_.stop(Reason::IterationLimit, Explanations::limit(std::to_string(limit) + " outer iterations"),
               state_);
  return true;
}

// Where feasible points exist, ‖r‖ falls from one outer iteration to the next; where it does not, the
// multiplier grows without end.
template<class Scalar, class MV, class OP>
bool SmalbeSolver<Scalar, MV, OP>::Run::isInfeasible() {
  const bool isSlow = lagrangian_.residual() > 0.5 * previous_.residual;
  if (watch_.suspects(isSlow) && solver_.stopIfInfeasible(rows_, mostProbeSteps, watch_.feasible))
    return true;
  previous_.residual = lagrangian_.residual();
  return false;
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::adaptPenalty() {
  const double grown = std::min(penalty_ * list_.get<double>("Penalty factor"), largestPenalty_);
  if (watch_.slow >= list_.get<int>("Slow iterations")) {
    watch_.slow = 0;
    penalty_ = grown;
  } else if (byPenalty_) {
    if (lagrangian_.residual() <= equalityTolerance_)
      equalityTolerance_ *= list_.get<double>("Tolerance factor");
    else
      penalty_ = grown;
  }
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::adaptPrecision() {
  const double value = lagrangian_.value();
  const double rise = 0.5 * lagrangian_.penalty() * lagrangian_.residual() * lagrangian_.residual();
  // Below the rounding errors of the value the comparison means nothing.
  const double noise = 100.0 * std::numeric_limits<double>::epsilon() * std::abs(value);
  if (rise > noise && value < previous_.value + rise)
    precision_ *= list_.get<double>("Precision factor");
  previous_.value = value;
}

// An iterate held by its bounds alone, which the new multiplier has left where it was, stays there until the
// multiplier has grown to the size of what presses on the bounds: by ρ‖r‖ at a time that may take for ever.
template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::updateMultiplier() {
  const bool held =
      state_.inner == previous_.inner && state_.projectedGradient <= lagrangian_.attainableGradient();
  stretch_ = held ? 2.0 * stretch_ : 1.0;
  previous_.inner = state_.inner;
  lagrangian_.updateMultiplier(penalty_, stretch_);
  solver_.result_.counters.outerIterations = state_.outer + 1;
  state_ = lagrangian_.evaluate(state_.outer + 1, state_.inner);
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::Run::finish() {
  Result& result = solver_.result_;
  result.penalty = lagrangian_.penalty();
  lagrangian_.storeMultiplier();
  // Of a problem without feasible points, neither a descent without end nor a limit is the reason.
  if (result.reason == Reason::Unbounded || result.reason == Reason::IterationLimit ||
      result.reason == Reason::Stagnation)
    if (!watch_.feasible)
      solver_.stopIfInfeasible(rows_, mostProbeSteps, watch_.feasible);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> SmalbeSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
