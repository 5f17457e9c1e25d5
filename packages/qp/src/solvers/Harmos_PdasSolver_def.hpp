// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceSolver_def.hpp"
#include "Harmos_FeasibilityProbe.hpp"
#include "Harmos_FirstFace.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasSolver.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
ParameterSpec PdasSolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("PDAS", "Primal-dual active sets.");
  spec.real("Inner reduction", 0.5, Range::strictlyWithin(0.0, 1.0),
            "Reduction of the residual on a face between two updates of the active set, until the set is "
            "stationary. A fifth of it, and again a fifth, if active sets bring no progress; half of it with "
            "discs.");
  spec.choice(
      "First active set", "auto",
      {{"auto", "nearest if the initial guess is at all bounds, as in contact without a resultant load on a "
                "body; else gradient. A scene with a body from a mesh file uses tried"},
       {"tried", "as auto; but before gradient, nearest is tried at one application of the Hessian, and kept "
                 "if its residual is small beside the load"},
       {"nearest", "the one of the feasible point nearest to the scaled right-hand side"},
       {"gradient", "entries that the gradient pushes against their bounds"}},
      "First active set of a solve without an initial guess.");
  spec.integer("Maximum active sets", 200, 1, 1000000,
               "Largest number of active sets before the fallback to a globally convergent method. Active "
               "sets that descend are not limited.");
  spec.integer("Active sets without progress", 10, 1, 1000000,
               "Largest number of active sets in a row that do not halve the bound on the projected "
               "gradient. Then the solver iterates longer on each face and, in the end, descends from the "
               "best iterate.");
  spec.integer("Kept directions", 60, 0, 1000,
               "Largest number of directions of slow faces that all later faces use, at an application each; "
               "0: none. Needs a preconditioner and stored directions (PCPG/Reorthogonalisation not none).");
  spec.real("Share of iterations", 0.5, Range{0.0, 1.0, true, false},
            "Share of \"Maximum Iterations\" before the fallback to a globally convergent method; all of "
            "them if there are at most 100.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& PdasSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("PDAS", "The primal-dual active set solver.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(methodSpec());
    spec.expert().list(CgOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
NewtonOptions PdasSolver<Scalar, MV, OP>::options() const {
  using First = NewtonOptions::FirstFace;
  const Teuchos::ParameterList& list = this->methodParameters("PDAS");
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  const bool turns = !problem.kind().isPiecewiseLinear || !problem.kind().isCost;
  const std::string first = list.get<std::string>("First active set");
  NewtonOptions options;
  // Where pairs turn, faces take a product and bring less.
  options.innerReduction = (turns ? 0.5 : 1.0) * list.get<double>("Inner reduction");
  options.patience = list.get<int>("Active sets without progress");
  options.mostFaces = list.get<int>("Maximum active sets");
  options.mostKept = list.get<int>("Kept directions");
  options.firstFace = problem.feasibleSet().anyBound() == nullptr ? First::Gradient
                      : first == "tried"                          ? First::Tried
                      : first == "nearest"                        ? First::Nearest
                      : first == "auto"                           ? First::Auto
                                                                  : First::Gradient;
  options.mostIterations = this->maximumIterations();
  options.cg = CgOptions::fromList(this->methodParameters("PCPG"));
  // Another method makes nothing of a handful of iterations.
  constexpr int fewIterations = 100;
  const int left = options.mostIterations - this->firstInner_;
  const bool isShared = this->hasSuccessor() && left > fewIterations;
  options.budget = this->firstInner_ +
                   (isShared ? static_cast<int>(list.get<double>("Share of iterations") * left) : left);
  return options;
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::doSolve() {
  if (this->problem_->blocks().empty()) {
    this->log_.info("Note: without bounds, PDAS is PCPG");
    PcpgSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  if (rows->isPresent() && !rows->isOrthonormal())
    throw InputError("PDAS needs equality rows with CCᵀ = I, but there are more rows than \"Orthonormalised "
                     "Rows\" allows to orthonormalise. Use SMALBE or raise that parameter");
  Run(*this, *rows).go();
}

template<class Scalar, class MV, class OP>
PdasSolver<Scalar, MV, OP>::Run::Run(PdasSolver& solver, EqualityRows<Scalar, MV, OP>& rows)
    : solver_(solver),
      state_(*solver.problem_, rows, solver.options(), solver.result_.counters, solver.log_),
      ways_(state_,
            [&solver](const IterationState<MV>& state) {
              const std::optional<Reason> reason = solver.judge(state);
              return reason && (*reason == Reason::TimeLimit || *reason == Reason::IterationLimit);
            }),
      inner_(solver.firstInner_) {}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::go() {
  begin();
  Next next = Next::NewFace;
  if (onFace_.isResumed)
    next = Next::GoOn;
  while (next != Next::Stopped) {
    if (next == Next::NewFace && enterFace() == Next::Stopped)
      return;
    aim();
    next = follow();
    if (next != Next::GoOn)
      continue;
    update();
    isMoved_ = false;
    if (!std::isfinite(state_.expected))
      return solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_.now);
    if (isCandidate() && confirmAnswer())
      return;
    settled_ = state_.change.changed == 0;
    if (!settled_ || isMoved_)
      next = goOn();
  }
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::begin() {
  EqualityRows<Scalar, MV, OP>& rows = state_.rows;
  const Problem<Scalar, MV, OP>& problem = state_.problem;
  const bool isCold =
      norm<Scalar>(state_.x) == 0.0 && (!rows.isPresent() || norm<Scalar>(*problem.multiplier()) == 0.0);
  if (!isCold)
    state_.problem.follow();
  Terms::project(problem.blocks(), state_.x);
  state_.best.x = MVT::CloneCopy(state_.x);
  state_.best.gradient = MVT::Clone(state_.x, 1);
  if (rows.isPresent()) {
    state_.best.multiplier = rows.makeVector();
    MVT::MvInit(*state_.best.multiplier, 0.0);
  }
  describeState();
  if (solver_.resumes()) {
    solver_.resume();
    onFace_.isResumed = true;
  } else {
    onFace_.isStarted = FirstFace<Scalar, MV, OP>(state_, isCold).find();
    state_.solver.lookAtRows();
  }
  state_.now = evaluate(
      onFace_.isResumed ? state_.solver.residualNorm() : std::numeric_limits<double>::infinity(), inner_);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::describeState() {
  solver_.describeState([this](StateArchive<MV>& archive) {
    archive.number("inner", inner_);
    archive.number("pdas settled", settled_);
    archive.number("pdas target", onFace_.target);
    archive.number("pdas stepped", onFace_.isStepped);
    archive.number("pdas face steps", onFace_.steps);
    ways_.exchange(archive);
    state_.exchange(archive);
  });
}

template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next PdasSolver<Scalar, MV, OP>::Run::enterFace() {
  // A face that took so long has outlying eigenvalues, and so have the others.
  constexpr int slow = 10;
  if (!onFace_.isStarted && state_.solver.staleness() >= slow)
    if (const int found = state_.solver.keepOutliers(state_.options.mostKept); found > 0)
      solver_.log_.detail("PDAS: " + std::to_string(found) + " search directions kept for all faces");
  if (!onFace_.isStarted && !ways_.enterFace()) {
    if (ways_.isAtEnd())
      return giveUp("no step decreases the cost");
    const std::string why = "the equalities are infeasible on a face";
    if (!ways_.findWayOn(Trouble::NoFace, why))
      return giveUp(why);
  }
  onFace_.isStarted = false;
  ++state_.counters.faces;
  state_.now = evaluate(state_.solver.residualNorm(), state_.now.inner);
  solver_.record(state_.now, solver_.result_.history.empty() ? StepKind::Start : StepKind::ActiveSet, 0.0,
                 0.0, state_.active);
  return Next::GoOn;
}

// How far this face is followed.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::aim() {
  state_.counters.outerIterations = state_.counters.activeSetUpdates + 1;
  if (!onFace_.isResumed) {
    onFace_.target = settled_ && state_.change.slips == 0
                         ? 0.0
                         : state_.options.innerReduction * state_.solver.slipping().residual;
    onFace_.isStepped = false;
    onFace_.steps = 0;
  }
  onFace_.isResumed = false;
}

// Steps on the face, until its target or the tests are met.
template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next PdasSolver<Scalar, MV, OP>::Run::follow() {
  FaceSolver<Scalar, MV, OP>& solver = state_.solver;
  while (true) {
    inner_ = state_.now.inner;
    if (!std::isfinite(solver.residualNorm())) {
      solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_.now);
      return Next::Stopped;
    }
    if (solver.returnToRows(state_.now.equalityDistance))
      state_.now = evaluate(solver.residualNorm(), state_.now.inner);
    // What is wrong with tangents adds to the residual.
    IterationState<MV> judged = state_.now;
    if (state_.turns())
      judged.projectedGradient *= 2.0;
    std::optional<Reason> reason = solver_.judge(judged);
    // No end is believed by an old distance from the equalities.
    const bool isAttained = solver.residualNorm() <= solver.attainable();
    if ((reason == Reason::Converged || isAttained) && !solver.hasLooked()) {
      solver.lookAtRows();
      state_.now = evaluate(solver.residualNorm(), state_.now.inner);
      continue;
    }
    if (const Reason end = reason.value_or(Reason::Converged); end != Reason::Converged) {
      solver_.keepState(end);
      state_.now = measure(state_.now.inner, false);
      solver_.stopFor(end, state_.now);
      return Next::Stopped;
    }
    if (reason || isFarEnough() || isAttained || (onFace_.isStepped && ways_.isAstray()))
      return Next::GoOn;
    if (isInterrupted())
      return Next::Stopped;
    if (const Next next = advance(); next != Next::GoOn)
      return next;
  }
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isInterrupted() {
  if (!solver_.isInterrupted(state_.now))
    return false;
  state_.solver.lookAtRows();
  state_.now = evaluate(state_.solver.residualNorm(), state_.now.inner);
  solver_.stop(Reason::Interrupted, Explanations::interrupted(), state_.now);
  return true;
}

// Pairs that are off their rims by more than radii would turn to anywhere.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isFarEnough() const {
  constexpr double mostOvershoot = 0.2;
  const typename FaceSolver<Scalar, MV, OP>::Slipping slipping = state_.solver.slipping();
  return slipping.residual <= onFace_.target && slipping.overshoot <= mostOvershoot;
}

template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next PdasSolver<Scalar, MV, OP>::Run::advance() {
  // Exact conjugate gradients end within the dimension of the face.
  const auto length = static_cast<long long>(MVT::GetGlobalLength(state_.x));
  const int budget = state_.options.budget;
  if (state_.now.inner >= budget && budget < state_.options.mostIterations)
    return giveUp("its share of the iterations is used up");
  if (onFace_.steps++ > 2 * (length - state_.active) + 10)
    return giveUp("conjugate gradients stagnate on a face");
  const Outcome outcome = state_.solver.step();
  if (outcome == Outcome::Flat)
    return otherWay(Trouble::BadFace, "the Hessian is singular on a face");
  if (outcome == Outcome::Breakdown) {
    // Where pairs slip or limits follow, the equations of a face are those of a guess, and may be bad ones.
    if (ways_.findWayOn(Trouble::BadFace, "conjugate gradients break down on a face"))
      return Next::NewFace;
    solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_.now);
    return Next::Stopped;
  }
  onFace_.isStepped = true;
  state_.now = evaluate(state_.solver.residualNorm(), state_.now.inner + 1);
  solver_.record(state_.now, StepKind::Projected, 0.0, 0.0, state_.active);
  return Next::GoOn;
}

// The next face, and what the present iterate is worth.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::update() {
  FaceSolver<Scalar, MV, OP>& solver = state_.solver;
  const bool isPlain = !state_.turns() && state_.problem.kind().isSet;
  if (state_.active > 0 || !isPlain) // multipliers of held bounds are all that it is asked for
    solver.lagrangianGradient(*state_.y);
  ways_.beforeUpdate();
  const double curvature = solver.curvatureBound();
  // Slipping pairs go on along their tangents until what is wrong with all of these counts beside the
  // residual: of gradients and of distances half of it each at most, so that follow() can judge by twice the
  // residual.
  constexpr double part = 0.5;
  FaceUpdate how;
  how.xNoise = 10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(state_.x);
  how.gradientNoise = 10.0 * solver.attainable();
  how.stepLength = curvature > 0.0 ? 1.0 / curvature : 0.0;
  if (!state_.problem.kind().isCost) {
    // By far less than what an inexact solution leaves open nothing is decided: where symmetry makes forces
    // zero it would be by the order of sums. Composite of 6 × 6 fibres, μ = 1, on five kinds of kernels: 64
    // applications each, and 123 on two of them without; 224 scenes with friction: 223 converge, 222 without.
    // With discs included, a third of it changes nothing (123, 222), three times as much loses three scenes.
    constexpr double undecided = 1e-4;
    const double noise = undecided * solver.slipping().residual;
    how.xNoise = std::max(how.xNoise, how.stepLength * noise);
    how.gradientNoise = std::max(how.gradientNoise, noise);
  }
  how.turn =
      part * solver.slipping().residual / std::sqrt(std::max(1.0, static_cast<double>(state_.change.slips)));
  how.keepsSprings = ways_.keepsSprings();
  before_ = state_.face;
  FaceChange& change = state_.change;
  change = Terms::update(state_.problem.blocks(), state_.x, *state_.y, how, state_.face);
  // Limits that have moved by what counts beside the residual make another face.
  if (change.changed == 0 && std::sqrt(change.distance2) > part * how.stepLength * solver.residualNorm())
    change.changed = 1;
  change.violation2 += change.distance2;
  ways_.afterUpdate();
  state_.expected = expectedAt(curvature);
  state_.active = change.active;
  if (state_.expected < state_.progress.least())
    keepBest();
}

// ‖g^P‖ at the projection of x is at most ‖w‖ + ‖multipliers of the wrong sign‖ + ‖A‖‖x − Π(x)‖.
template<class Scalar, class MV, class OP>
double PdasSolver<Scalar, MV, OP>::Run::expectedAt(double stiffness) const {
  const FaceChange& change = state_.change;
  return state_.solver.residualNorm() + std::sqrt(change.wrongSign2) +
         stiffness * std::sqrt(change.violation2) + std::sqrt(change.wrongForces2);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::keepBest() {
  BestIterate<Scalar, MV>& best = state_.best;
  state_.progress.setLeast(state_.expected);
  MVT::Assign(state_.x, *best.x);
  Terms::project(state_.problem.blocks(), *best.x);
  if (state_.rows.isPresent())
    state_.solver.multiplier(*best.multiplier);
  MVT::Assign(*state_.y, *best.gradient);
  best.face = state_.face;
  best.isFound = true;
}

// A settled face that the tests send back without a step would be sent back for ever: what is left of wrong
// signs and violations is rounding errors.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isExhausted() const {
  return state_.solver.residualNorm() <= state_.solver.attainable() || (settled_ && !onFace_.isStepped);
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isCandidate() {
  if (state_.change.changed == 0 && isExhausted())
    return true;
  // What is beyond limits that follow counts by the stiffness that there is.
  const bool follows = !state_.problem.kind().isCost && state_.problem.kind().isPiecewiseLinear;
  const double expected = follows ? expectedAt(state_.solver.stiffness()) : state_.expected;
  return solver_.judge(evaluate(expected, state_.now.inner)) == Reason::Converged;
}

// Whether the projection of x is the answer, or as near to it as rounding errors allow.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::confirmAnswer() {
  const bool exhausted = isExhausted();
  FaceSolver<Scalar, MV, OP>& solver = state_.solver;
  const FaceChange& change = state_.change;
  isMoved_ = !state_.problem.kind().isCost;
  state_.now = measure(state_.now.inner, change.violation2 == 0.0);
  bool sentBack = false;
  while (solver_.judge(state_.now) == Reason::Converged) {
    if (solver_.accepted()) {
      solver_.stopFor(Reason::Converged, state_.now);
      return true;
    }
    sentBack = true; // the test is stricter now
  }
  if (change.changed == 0 && !sentBack && ways_.moveFromAnswer()) {
    isMoved_ = true;
    return false;
  }
  if (change.changed != 0 || (solver.residualNorm() > solver.attainable() && (!exhausted || sentBack)))
    return false;
  isMoved_ = solver.isRefinable(); // the same face, from where x is now
  if (isMoved_)
    return false;
  solver_.stop(Reason::Stagnation,
               Explanations::stagnation(state_.now.projectedGradient, solver.attainable(),
                                        state_.now.equalityDistance),
               state_.now);
  return true;
}

// To another face.
template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next PdasSolver<Scalar, MV, OP>::Run::goOn() {
  ++state_.counters.activeSetUpdates;
  if (!ways_.seesToProgress() && state_.counters.activeSetUpdates >= state_.options.mostFaces) {
    const std::string limit = "limit of " + std::to_string(state_.options.mostFaces) + " active sets";
    return ways_.findWayOn(Trouble::ManyFaces, limit) ? Next::NewFace
                                                      : giveUp("the " + limit + " was reached");
  }
  if (ways_.descends())
    return ways_.leaveFace(before_) ? Next::NewFace : giveUp("no feasible point nearby");
  const std::string trouble = ways_.troubleOfFaces();
  return trouble.empty() ? Next::NewFace : otherWay(Trouble::NoProgress, trouble);
}

template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next
PdasSolver<Scalar, MV, OP>::Run::otherWay(Trouble trouble, const std::string& why) {
  return ways_.findWayOn(trouble, why) ? Next::NewFace : giveUp(why);
}

template<class Scalar, class MV, class OP>
IterationState<MV> PdasSolver<Scalar, MV, OP>::Run::evaluate(double gradientNorm, int inner) {
  return state_.solver.evaluate(gradientNorm, state_.counters.activeSetUpdates + 1, inner);
}

// What is reported and believed is the gradient at the projection of x, computed anew; or the one that was
// carried along, where x is within the bounds to the last bit and the rounding errors that may have gathered
// are below a tenth of it.
template<class Scalar, class MV, class OP>
IterationState<MV> PdasSolver<Scalar, MV, OP>::Run::measure(int inner, bool feasible) {
  FaceSolver<Scalar, MV, OP>& solver = state_.solver;
  const Blocks& blocks = state_.problem.blocks();
  MV &x = state_.x, &y = *state_.y;
  if (feasible && solver.staleness() > 0) {
    solver.trueGradient(y);
    const double carried = Terms::projectedGradientNorm(state_.problem.feasibleSet(), blocks, x, y);
    if (10.0 * solver.attainable() <= carried) {
      solver.storeMultiplier();
      if (!solver.hasLooked())
        solver.lookAtRows();
      return evaluate(carried, inner);
    }
  }
  if (!state_.problem.kind().isCost) {
    state_.problem.follow();
    state_.problem.moveToLimits(state_.face);
  }
  Terms::project(blocks, x);
  ++state_.counters.confirmations;
  ++state_.counters.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*state_.problem.hessian(), x, y);
  MVT::MvAddMv(1.0, y, -1.0, *state_.problem.rhs(), y);
  Terms::addForces(blocks, x, y);
  if (state_.rows.isPresent()) {
    const Teuchos::RCP<MV> mu = state_.rows.makeVector();
    solver.multiplier(*mu);
    state_.rows.addTransposed(1.0, *mu, y);
  }
  solver.storeMultiplier();
  solver.lookAtRows(); // x was moved
  return evaluate(Terms::projectedGradientNorm(state_.problem.feasibleSet(), blocks, x, y), inner);
}

// Another method may go on from the best iterate.
template<class Scalar, class MV, class OP>
typename PdasSolver<Scalar, MV, OP>::Run::Next
PdasSolver<Scalar, MV, OP>::Run::giveUp(const std::string& why) {
  MVT::Assign(*state_.best.x, state_.x);
  if (state_.rows.isPresent() && state_.best.isFound)
    state_.rows.toUser(*state_.best.multiplier, *state_.problem.multiplier());
  if (!solver_.hasSuccessor()) {
    if (isInfeasible())
      return Next::Stopped;
    state_.now = measure(state_.now.inner, false);
  }
  solver_.giveUp(why, state_.now);
  return Next::Stopped;
}

// Whether bounds, discs and equalities contradict each other, whatever other terms there are; with the proof.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isInfeasible() {
  constexpr int mostSteps = 1000; // each a product with C and Cᵀ
  using Probe = FeasibilityProbe<Scalar, MV, OP>;
  if (!state_.rows.isPresent())
    return false;
  const Teuchos::RCP<MV> y = state_.rows.makeVector();
  Certificate certificate;
  if (Probe(state_.problem, state_.rows).run(mostSteps, *y, certificate) != Probe::Verdict::Infeasible)
    return false;
  solver_.stopInfeasible(y, certificate);
  return true;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PdasSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
