// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedLagrangian_def.hpp"
#include "Harmos_BoundedSolver.hpp"
#include "Harmos_DualPenaltySolver.hpp"
#include "Harmos_MprgpIteration_def.hpp"
#include "Harmos_MprgpSolver.hpp"
#include "Harmos_PcpgSolver.hpp"
#include "Harmos_SmalbeSolver.hpp"
#include "Harmos_SolverFactory.hpp"
#include "Harmos_SolverManager_def.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace Harmos::qp {

namespace Details {

inline std::string breakdownText() {
  return "a number is not finite or the Hessian has a negative curvature: is the operator symmetric positive "
         "semidefinite, and are its data finite?";
}

inline std::string limitText(const std::string& limit) {
  return "the limit of " + limit +
         " iterations was reached; raise the limit, loosen the tolerance, or look at the history for a "
         "residual "
         "that no longer falls (a badly conditioned Hessian, or constraints that cannot be met together: in "
         "the "
         "dual problem of contact, a body that is pulled away from all that could hold it)";
}

inline std::string unboundedText() {
  return "the cost falls without end along a feasible direction of zero curvature: the problem has no "
         "solution (in the dual problem of contact: constraints or gaps that contradict each other)";
}

inline std::string stagnationText() {
  return "the residuals are at the level of rounding errors and cannot be reduced to the tolerance asked "
         "for; "
         "loosen the tolerance";
}

template<class Iteration>
StepKind stepKind(typename Iteration::Outcome outcome) {
  switch (outcome) {
  case Iteration::Outcome::Expansion:
    return StepKind::Expansion;
  case Iteration::Outcome::Proportioning:
    return StepKind::Proportioning;
  default:
    return StepKind::ConjugateGradient;
  }
}

} // namespace Details

// ------------------------------------------------------------------------------------ BoundedSolver

template<class Scalar, class MV, class OP>
IterationState<MV> BoundedSolver<Scalar, MV, OP>::begin(Lagrangian& lagrangian, double penalty,
                                                        double precision) {
  lagrangian.start(penalty);
  this->result_.hessianNorm = lagrangian.hessianNorm();
  this->result_.counters.outerIterations = 1;
  State state = lagrangian.evaluate(1, 0);
  this->record(state, StepKind::Start, penalty, precision, lagrangian.active());
  return state;
}

template<class Scalar, class MV, class OP>
bool BoundedSolver<Scalar, MV, OP>::minimise(Lagrangian& lagrangian, State& state,
                                             const std::function<bool(const State&)>& precise,
                                             double precision) {
  using Iteration = typename Lagrangian::Iteration;
  using Outcome = typename Iteration::Outcome;
  // Whatever ends the solver, what it reports is the state it ended in.
  const auto stop = [&](Reason reason, const std::string& explanation) {
    this->result_.projectedGradientNorm = state.projectedGradient;
    this->result_.equalityNorm = state.equalityResidual;
    this->stop(reason, explanation);
  };
  const int limit = this->maximumIterations();
  while (true) {
    if (!std::isfinite(state.projectedGradient) || !std::isfinite(state.equalityResidual)) {
      stop(Reason::Breakdown, Details::breakdownText());
      return false;
    }
    if (this->converged(state)) {
      // Believe the recurrence only as far as rounding errors allow.
      if (lagrangian.confirmGradient(state.projectedGradient)) {
        state = lagrangian.evaluate(state.outer, state.inner);
        continue;
      }
      stop(Reason::Converged, "the convergence test passed");
      return false;
    }
    if (precise && precise(state))
      return true;
    if (state.projectedGradient <= lagrangian.attainableGradient()) {
      if (lagrangian.confirmGradient(0.0)) {
        state = lagrangian.evaluate(state.outer, state.inner);
        continue;
      }
      if (precise && state.equalityResidual > lagrangian.attainableEquality())
        return true; // the multiplier can still improve
      stop(Reason::Stagnation, Details::stagnationText());
      return false;
    }
    if (state.inner >= limit) {
      stop(Reason::IterationLimit, Details::limitText(std::to_string(limit) + " inner"));
      return false;
    }
    const Outcome outcome = lagrangian.step();
    if (outcome == Outcome::Unbounded || outcome == Outcome::Breakdown) {
      const bool unbounded = outcome == Outcome::Unbounded;
      stop(unbounded ? Reason::Unbounded : Reason::Breakdown,
           unbounded ? Details::unboundedText() : Details::breakdownText());
      return false;
    }
    state = lagrangian.evaluate(state.outer, state.inner + 1);
    this->record(state, Details::stepKind<Iteration>(outcome), lagrangian.penalty(), precision,
                 lagrangian.active());
  }
}

// -------------------------------------------------------------------------------------------- MPRGP

template<class Scalar, class MV, class OP>
const ParameterSpec& MprgpSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("MPRGP", "The solver for bounds alone.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void MprgpSolver<Scalar, MV, OP>::doSolve() {
  if (this->problem_->hasEqualities())
    throw InputError("MPRGP is for bounds alone, but the problem has equalities; use SMALBE");
  BoundedLagrangian<Scalar, MV, OP> lagrangian(
      *this->problem_, MprgpOptions::fromList(this->parameters_->sublist("MPRGP")), this->result_.counters);
  IterationState<MV> state = this->begin(lagrangian, 0.0, 0.0);
  this->minimise(lagrangian, state, nullptr, 0.0);
}

// ------------------------------------------------------------------------------------------- SMALBE

template<class Scalar, class MV, class OP>
ParameterSpec SmalbeSolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("SMALBE", "Semimonotonic augmented Lagrangians for bounds and equalities.");
  spec.choice(
      "Update rule", "precision",
      {{"precision", "SMALBE-M: fixed penalty ρ; M is reduced when the Lagrangian does not rise enough"},
       {"penalty", "Algorithm 4.1 of Dostál, Horák, Vlach: fixed M; ρ grows when feasibility lags"}},
      "What is adapted from one outer iteration to the next.");
  spec.choice("Parameter scaling", "relative",
              {{"relative", "Initial penalty and M are multiples of ‖A‖, equality tolerances of ‖b‖/‖A‖ and "
                            "gradient tolerances of ‖b‖"},
               {"absolute", "they are taken as they stand"}},
              "Units of the parameters below.");
  spec.real("Initial penalty", 1.0, Range::above(0.0), "ρ₀.");
  spec.real("M", 10.0, Range::above(0.0), "Inner precision ‖g^P‖ ≤ M‖Cx − c‖.");
  spec.real("Inner tolerance", 0.1, Range::above(0.0),
            "Rule `precision`: η, the largest ‖g^P‖ at the end of an inner loop.");
  spec.real("Precision factor", 0.1, Range::strictlyWithin(0.0, 1.0), "Rule `precision`: θ, M ← θM.");
  spec.real("Equality tolerance", 0.1, Range::above(0.0), "Rule `penalty`: η₀, ‖Cx − c‖ expected at first.");
  spec.real("Tolerance factor", 0.1, Range::strictlyWithin(0.0, 1.0), "Rule `penalty`: α, η ← αη.");
  spec.real("Penalty factor", 10.0, Range::above(1.0), "Rule `penalty`: β, ρ ← βρ.");
  spec.integer("Maximum Outer Iterations", 10000, 1, 1000000000,
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
  if (!this->problem_->hasEqualities())
    throw InputError("SMALBE is for problems with equalities, but this one has none; use MPRGP");
  const Teuchos::ParameterList& list = this->parameters_->sublist("SMALBE");
  const bool byPenalty = list.get<std::string>("Update rule") == "penalty";
  BoundedLagrangian<Scalar, MV, OP> lagrangian(
      *this->problem_, MprgpOptions::fromList(this->parameters_->sublist("MPRGP")), this->result_.counters);

  double normScale = 1.0, gradientScale = 1.0, equalityScale = 1.0;
  if (list.get<std::string>("Parameter scaling") == "relative" && lagrangian.hessianNorm() > 0.0) {
    normScale = lagrangian.hessianNorm();
    gradientScale = norm<Scalar>(*this->problem_->rhs());
    equalityScale = gradientScale / normScale;
  }
  double penalty = normScale * list.get<double>("Initial penalty");
  double precision = normScale * list.get<double>("M");
  const double innerTolerance = byPenalty ? std::numeric_limits<double>::infinity()
                                          : gradientScale * list.get<double>("Inner tolerance");
  double equalityTolerance = equalityScale * list.get<double>("Equality tolerance");
  const double toleranceFactor = list.get<double>("Tolerance factor");
  const double penaltyFactor = list.get<double>("Penalty factor");
  const double precisionFactor = list.get<double>("Precision factor");
  const int outerLimit = list.get<int>("Maximum Outer Iterations");

  const auto precise = [&](const IterationState<MV>& state) {
    return state.projectedGradient <= std::min(precision * state.equalityResidual, innerTolerance);
  };

  IterationState<MV> state = this->begin(lagrangian, penalty, precision);
  double previousValue = -std::numeric_limits<double>::infinity();
  // Step 1: the inner loop; Step 2, the stop, is part of it.
  while (this->minimise(lagrangian, state, precise, precision)) {
    this->result_.penalty = lagrangian.penalty();
    if (state.outer >= outerLimit)
      return this->stop(Reason::IterationLimit, Details::limitText(std::to_string(outerLimit) + " outer"));
    // Steps 3 and 4.
    if (byPenalty) {
      if (state.equalityResidual <= equalityTolerance)
        equalityTolerance *= toleranceFactor;
      else
        penalty *= penaltyFactor;
    } else {
      const double value = lagrangian.value();
      const double rise = 0.5 * penalty * state.equalityResidual * state.equalityResidual;
      // Below the rounding errors of the value the comparison means nothing.
      const double noise = 100.0 * std::numeric_limits<double>::epsilon() * std::abs(value);
      if (rise > noise && value < previousValue + rise)
        precision *= precisionFactor;
      previousValue = value;
    }
    lagrangian.updateMultiplier(penalty);
    this->result_.counters.outerIterations = state.outer + 1;
    state = lagrangian.evaluate(state.outer + 1, state.inner);
  }
  this->result_.penalty = lagrangian.penalty();
  lagrangian.finish();
}

// ------------------------------------------------------------------------------------- Dual Penalty

template<class Scalar, class MV, class OP>
ParameterSpec DualPenaltySolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("Dual Penalty", "Equalities enforced by a fixed penalty alone.");
  spec.choice(
      "Parameter scaling", "relative",
      {{"relative", "the penalty is a multiple of ‖A‖"}, {"absolute", "the penalty is taken as it stands"}},
      "Unit of the penalty.");
  spec.real("Penalty", 1e4, Range::above(0.0), "ρ; the equality residual falls like 1/ρ.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& DualPenaltySolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("Dual Penalty", "The penalty method for bounds and equalities.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.list(methodSpec());
    spec.list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<StatusTest<MV>> DualPenaltySolver<Scalar, MV, OP>::defaultTest() const {
  return Teuchos::rcp(
      new StatusTestProjectedGradient<MV>(this->parameters_->template get<double>("Convergence Tolerance"),
                                          norm<Scalar>(*this->problem_->rhs())));
}

template<class Scalar, class MV, class OP>
void DualPenaltySolver<Scalar, MV, OP>::doSolve() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (!this->problem_->hasEqualities())
    throw InputError("Dual Penalty is for problems with equalities, but this one has none; use MPRGP");
  const Teuchos::ParameterList& list = this->parameters_->sublist("Dual Penalty");
  MVT::MvInit(*this->problem_->multiplier(), 0.0);
  BoundedLagrangian<Scalar, MV, OP> lagrangian(
      *this->problem_, MprgpOptions::fromList(this->parameters_->sublist("MPRGP")), this->result_.counters);
  const bool relative = list.get<std::string>("Parameter scaling") == "relative";
  const double penalty = list.get<double>("Penalty") *
                         (relative && lagrangian.hessianNorm() > 0.0 ? lagrangian.hessianNorm() : 1.0);
  IterationState<MV> state = this->begin(lagrangian, penalty, 0.0);
  this->minimise(lagrangian, state, nullptr, 0.0);
  this->result_.penalty = penalty;
  lagrangian.finish();
}

// --------------------------------------------------------------------------------------------- PCPG

template<class Scalar, class MV, class OP>
const ParameterSpec& PcpgSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("PCPG", "The solver for equalities alone.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::doSolve() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  if (problem.hasBounds())
    throw InputError("PCPG is for equalities alone, but the problem has bounds; use SMALBE or MPRGP");
  const bool constrained = problem.hasEqualities();
  if (constrained && problem.equalityStructure() == EqualityStructure::General)
    throw InputError("PCPG needs equality rows with CCᵀ = I, but they are not known to be orthonormal; "
                     "orthonormalise them and say so with EqualityStructure::Orthonormal");
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  Counters& counters = this->result_.counters;
  AugmentedHessian<Scalar, MV, OP> hessian(problem, counters);
  MV& x = *problem.solution();
  const Teuchos::RCP<MV> w = MVT::Clone(x, 1), p = MVT::Clone(x, 1), image = MVT::Clone(x, 1);
  Teuchos::RCP<MV> rows, removed, residual;
  if (constrained) {
    rows = MVT::Clone(*problem.equalityValues(), 1);
    removed = MVT::Clone(*problem.equalityValues(), 1);
    residual = MVT::Clone(*problem.equalityValues(), 1);
    hessian.equalityResidual(x, *residual);
    hessian.addTransposed(-1.0, *residual, x);
  }
  // w ← (I − CᵀC)w. The gradient is carried along projected: its other part, which stays large while this one
  // vanishes, would spoil it by cancellation. What is removed adds up to −μ.
  const auto project = [&] {
    if (!constrained)
      return;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem.equalityRows(), *w, *rows);
    hessian.addTransposed(-1.0, *rows, *w);
    MVT::MvAddMv(1.0, *removed, 1.0, *rows, *removed);
  };
  const auto evaluate = [&](double gradientNorm, int inner) {
    IterationState<MV> state;
    state.x = &x;
    state.projectedGradient = gradientNorm;
    if (constrained) {
      hessian.equalityResidual(x, *residual);
      state.equalityResidual = norm<Scalar>(*residual);
    }
    state.outer = 1;
    state.inner = inner;
    state.counters = &counters;
    return state;
  };
  // w = P(Ax − b) and p = w, anew; returns ‖w‖².
  const auto begin = [&] {
    if (norm<Scalar>(x) > 0.0) {
      hessian.apply(x, *w);
      MVT::MvAddMv(1.0, *w, -1.0, *problem.rhs(), *w);
    } else {
      MVT::MvAddMv(-1.0, *problem.rhs(), 0.0, *problem.rhs(), *w);
    }
    if (constrained)
      MVT::MvInit(*removed, 0.0);
    project();
    project(); // the first projection left rounding errors of the size of the part that it removed
    MVT::Assign(*w, *p);
    return dot<Scalar>(*w, *w);
  };

  counters.outerIterations = 1;
  double norm2 = begin();
  IterationState<MV> state = evaluate(std::sqrt(norm2), 0);
  this->record(state, StepKind::Start, 0.0, 0.0, 0);
  double curvatureBound = problem.hessianNorm();
  int staleness = 0;
  while (true) {
    const double attainable = epsilon * (curvatureBound * norm<Scalar>(x) + norm<Scalar>(*problem.rhs()));
    const bool done = this->converged(state);
    const bool stagnant = state.projectedGradient <= attainable;
    if (done || stagnant) {
      if (staleness > 0 &&
          std::sqrt(static_cast<double>(staleness)) * attainable > 0.1 * state.projectedGradient) {
        ++counters.confirmations;
        norm2 = begin();
        staleness = 0;
        state = evaluate(std::sqrt(norm2), state.inner);
        continue;
      }
      this->stop(done ? Reason::Converged : Reason::Stagnation,
                 done ? "the convergence test passed" : Details::stagnationText());
      break;
    }
    if (!std::isfinite(norm2)) {
      this->stop(Reason::Breakdown, Details::breakdownText());
      break;
    }
    if (state.inner >= this->maximumIterations()) {
      this->stop(Reason::IterationLimit,
                 Details::limitText(std::to_string(this->maximumIterations()) + " inner"));
      break;
    }
    hessian.apply(*p, *image);
    const double directionNorm2 = dot<Scalar>(*p, *p);
    const double curvature = dot<Scalar>(*p, *image) / directionNorm2;
    curvatureBound = std::max(curvatureBound, curvature);
    if (!std::isfinite(curvature) || curvature < -100.0 * epsilon * curvatureBound) {
      this->stop(Reason::Breakdown, Details::breakdownText());
      break;
    }
    if (curvature <= 100.0 * epsilon * curvatureBound) {
      this->stop(Reason::Unbounded, Details::unboundedText());
      break;
    }
    const double step = dot<Scalar>(*p, *w) / (curvature * directionNorm2);
    MVT::MvAddMv(1.0, x, -step, *p, x);
    MVT::MvAddMv(1.0, *w, -step, *image, *w);
    project();
    const double nextNorm2 = dot<Scalar>(*w, *w);
    MVT::MvAddMv(1.0, *w, nextNorm2 / norm2, *p, *p);
    norm2 = nextNorm2;
    ++counters.cgSteps;
    ++staleness;
    state = evaluate(std::sqrt(norm2), state.inner + 1);
    this->record(state, StepKind::Projected, 0.0, 0.0, 0);
  }
  this->result_.projectedGradientNorm = state.projectedGradient;
  this->result_.equalityNorm = state.equalityResidual;
  // Ax − b + Cᵀμ = 0 at the solution.
  if (constrained)
    MVT::MvAddMv(-1.0, *removed, 0.0, *removed, *problem.multiplier());
}

// ----------------------------------------------------------------------------------- clone, factory

namespace Details {

template<class Solver>
Teuchos::RCP<Solver> cloneOf(const Solver& solver) {
  Teuchos::RCP<Solver> copy = Teuchos::rcp(new Solver);
  if (!solver.getCurrentParameters().is_null())
    copy->setParameters(Teuchos::rcp(new Teuchos::ParameterList(*solver.getCurrentParameters())));
  return copy;
}

inline std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

} // namespace Details

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> MprgpSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> SmalbeSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> DualPenaltySolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PcpgSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

template<class Scalar, class MV, class OP>
std::vector<std::string> SolverFactory<Scalar, MV, OP>::supportedSolverNames() const {
  return {"MPRGP", "SMALBE", "Dual Penalty", "PCPG"};
}

template<class Scalar, class MV, class OP>
bool SolverFactory<Scalar, MV, OP>::isSupported(const std::string& name) const {
  for (const std::string& candidate : supportedSolverNames())
    if (Details::lowered(candidate) == Details::lowered(name))
      return true;
  return false;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>>
SolverFactory<Scalar, MV, OP>::create(const std::string& name,
                                      const Teuchos::RCP<Teuchos::ParameterList>& parameters) const {
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> solver;
  const std::string key = Details::lowered(name);
  if (key == "mprgp")
    solver = Teuchos::rcp(new MprgpSolver<Scalar, MV, OP>);
  else if (key == "smalbe")
    solver = Teuchos::rcp(new SmalbeSolver<Scalar, MV, OP>);
  else if (key == "dual penalty")
    solver = Teuchos::rcp(new DualPenaltySolver<Scalar, MV, OP>);
  else if (key == "pcpg")
    solver = Teuchos::rcp(new PcpgSolver<Scalar, MV, OP>);
  else {
    const std::string nearest = nearestName(name, supportedSolverNames());
    std::string known;
    for (const std::string& candidate : supportedSolverNames())
      known += (known.empty() ? "\"" : ", \"") + candidate + "\"";
    throw InputError("there is no solver \"" + name + "\"" +
                     (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") + " Known: " + known +
                     ".");
  }
  solver->setParameters(parameters);
  return solver;
}

template<class Scalar, class MV, class OP>
std::string SolverFactory<Scalar, MV, OP>::automaticChoice(const Problem<Scalar, MV, OP>& problem) {
  if (!problem.hasBounds())
    return "PCPG";
  return problem.hasEqualities() ? "SMALBE" : "MPRGP";
}

} // namespace Harmos::qp
