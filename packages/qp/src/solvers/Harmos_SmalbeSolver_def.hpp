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
      {{"precision", "SMALBE-M: fixed penalty ρ; M is reduced when the Lagrangian does not rise enough"},
       {"penalty", "Algorithm 4.1 of Dostál, Horák, Vlach: fixed M; ρ grows when feasibility lags"},
       {"both", "each of the two adapts its own parameter"}},
      "What is adapted from one outer iteration to the next.");
  spec.choice("Parameter scaling", "relative",
              {{"relative", "Initial penalty and M are multiples of ‖A‖, equality tolerances of ‖b‖/‖A‖ and "
                            "gradient tolerances of ‖b‖"},
               {"absolute", "they are taken as they stand"}},
              "Units of the parameters below.");
  spec.real("Initial penalty", 1.0, Range::above(0.0), "ρ₀.");
  spec.real("M", 10.0, Range::above(0.0), "Inner precision ‖g^P‖ ≤ M‖Cx − c‖.");
  spec.real("Inner tolerance", 0.1, Range::above(0.0),
            "Rules `precision` and `both`: η, the largest ‖g^P‖ at the end of an inner loop.");
  spec.real("Precision factor", 0.1, Range::strictlyWithin(0.0, 1.0),
            "Rules `precision` and `both`: θ, M ← θM.");
  spec.real("Equality tolerance", 0.1, Range::above(0.0),
            "Rules `penalty` and `both`: η₀, ‖Cx − c‖ expected at first.");
  spec.real("Tolerance factor", 0.1, Range::strictlyWithin(0.0, 1.0),
            "Rules `penalty` and `both`: α, η ← αη.");
  spec.real("Penalty factor", 10.0, Range::above(1.0), "Rules `penalty` and `both`: β, ρ ← βρ.");
  spec.real(
      "Maximum penalty", 1000.0, Range::above(0.0),
      "ρ does not grow beyond; the rounding errors of the gradient grow with it, and the method converges "
      "with any fixed ρ.");
  spec.integer("Slow iterations", 4, 1, 1000000,
               "All rules: ρ ← βρ after so many outer iterations in a row that did not halve ‖Cx − c‖, which "
               "rows that nearly depend on each other in the free entries bring about.");
  spec.integer("Maximum outer iterations", 10000, 1, 1000000000,
               "Outer iterations after which the solver gives up.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& SmalbeSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("SMALBE", "The solver for bounds and equalities.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.list(methodSpec());
    spec.list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void SmalbeSolver<Scalar, MV, OP>::doSolve() {
  constexpr int mostProbeSteps = 1000; // each a product with C and Cᵀ
  // Asks for a probe when feasibility has not improved twice in a row, the next time after twice as long.
  struct InfeasibilityWatch {
    bool feasible = false;
    int slow = 0;
    int patience = 2;
    bool suspects(bool isSlow) {
      slow = isSlow ? slow + 1 : 0;
      if (feasible || slow < patience)
        return false;
      patience *= 2;
      return true;
    }
  };
  if (!this->problem_->hasEqualities()) {
    this->log_.info("Note: without equalities, SMALBE is MPRGP");
    MprgpSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  const Teuchos::ParameterList& list = this->parameters_->sublist("SMALBE");
  const std::string rule = list.get<std::string>("Update rule");
  const bool byPenalty = rule != "precision", byPrecision = rule != "penalty";
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  BoundedLagrangian<Scalar, MV, OP> lagrangian(*this->problem_, *rows,
                                               MprgpOptions::fromList(this->parameters_->sublist("MPRGP")),
                                               this->result_.counters, this->resumes());

  double normScale = 1.0, gradientScale = 1.0, equalityScale = 1.0;
  const double rowScale = std::sqrt(rows->norm2()); // 1 but for rows used as they stand
  if (list.get<std::string>("Parameter scaling") == "relative") {
    gradientScale = norm<Scalar>(*this->problem_->rhs());
    // Without a Hessian (a linear program) the load over the distance to the equalities is all there is.
    const double distance = norm<Scalar>(rows->values()) / rowScale;
    normScale = lagrangian.hessianNorm();
    if (!(normScale > 0.0))
      normScale = gradientScale > 0.0 ? gradientScale / (distance > 0.0 ? distance : 1.0) : 1.0;
    equalityScale = gradientScale / normScale * rowScale;
    normScale /= rowScale;
  }
  double penalty = normScale / rowScale * list.get<double>("Initial penalty");
  double precision = normScale * list.get<double>("M");
  double innerTolerance = byPrecision ? gradientScale * list.get<double>("Inner tolerance")
                                      : std::numeric_limits<double>::infinity();
  double equalityTolerance = equalityScale * list.get<double>("Equality tolerance");
  const double toleranceFactor = list.get<double>("Tolerance factor");
  const double penaltyFactor = list.get<double>("Penalty factor");
  const double precisionFactor = list.get<double>("Precision factor");
  double largestPenalty = std::max(penalty, normScale / rowScale * list.get<double>("Maximum penalty"));
  const int slowLimit = list.get<int>("Slow iterations");
  const int outerLimit = list.get<int>("Maximum outer iterations");

  const auto precise = [&](const IterationState<MV>& state) {
    return state.projectedGradient <= std::min(precision * lagrangian.residual(), innerTolerance);
  };

  double previousValue = -std::numeric_limits<double>::infinity();
  double previousResidual = std::numeric_limits<double>::infinity();
  InfeasibilityWatch watch;
  int previousInner = -1;
  double stretch = 1.0;
  const auto own = [&](StateArchive<MV>& archive) {
    archive.number("smalbe penalty", penalty);
    archive.number("smalbe precision", precision);
    archive.number("smalbe inner tolerance", innerTolerance);
    archive.number("smalbe equality tolerance", equalityTolerance);
    archive.number("smalbe largest penalty", largestPenalty);
    archive.number("smalbe previous value", previousValue);
    archive.number("smalbe previous residual", previousResidual);
    archive.number("smalbe feasible", watch.feasible);
    archive.number("smalbe slow", watch.slow);
    archive.number("smalbe patience", watch.patience);
    archive.number("smalbe previous inner", previousInner);
    archive.number("smalbe stretch", stretch);
  };
  IterationState<MV> state = this->begin(lagrangian, penalty, precision, own);
  // Step 1: the inner loop; Step 2, the stop, is part of it.
  while (this->minimise(lagrangian, state, precise, precision)) {
    const double residual = lagrangian.residual();
    this->result_.penalty = lagrangian.penalty();
    if (state.outer >= outerLimit) {
      this->stop(Reason::IterationLimit,
                 Explanations::limit(std::to_string(outerLimit) + " outer iterations"), state);
      break;
    }
    // Where feasible points exist, ‖r‖ falls from one outer iteration to the next; where it does not, the
    // multiplier grows without end.
    if (watch.suspects(residual > 0.5 * previousResidual) &&
        this->stopIfInfeasible(*rows, mostProbeSteps, watch.feasible))
      break;
    previousResidual = residual;
    // Steps 3 and 4.
    if (watch.slow >= slowLimit) {
      watch.slow = 0;
      penalty = std::min(penalty * penaltyFactor, largestPenalty);
    } else if (byPenalty) {
      if (residual <= equalityTolerance)
        equalityTolerance *= toleranceFactor;
      else
        penalty = std::min(penalty * penaltyFactor, largestPenalty);
    }
    if (byPrecision) {
      const double value = lagrangian.value();
      const double rise = 0.5 * lagrangian.penalty() * residual * residual;
      // Below the rounding errors of the value the comparison means nothing.
      const double noise = 100.0 * std::numeric_limits<double>::epsilon() * std::abs(value);
      if (rise > noise && value < previousValue + rise)
        precision *= precisionFactor;
      previousValue = value;
    }
    // An iterate held by its bounds alone, which the new multiplier has left where it was, stays there until
    // the multiplier has grown to the size of what presses on the bounds: by ρ‖r‖ at a time that may take for
    // ever.
    const bool held =
        state.inner == previousInner && state.projectedGradient <= lagrangian.attainableGradient();
    stretch = held ? 2.0 * stretch : 1.0;
    previousInner = state.inner;
    lagrangian.updateMultiplier(penalty, stretch);
    this->result_.counters.outerIterations = state.outer + 1;
    state = lagrangian.evaluate(state.outer + 1, state.inner);
  }
  this->result_.penalty = lagrangian.penalty();
  lagrangian.storeMultiplier();
  // Of a problem without feasible points, neither a descent without end nor a limit is the reason.
  if (this->result_.reason == Reason::Unbounded || this->result_.reason == Reason::IterationLimit ||
      this->result_.reason == Reason::Stagnation)
    if (!watch.feasible)
      this->stopIfInfeasible(*rows, mostProbeSteps, watch.feasible);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> SmalbeSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
