// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_MprgpSolver_def.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasBalance_def.hpp"
#include "Harmos_PdasBeginning_def.hpp"
#include "Harmos_PdasSolver.hpp"
#include "Harmos_PdasSprings_def.hpp"
#include "Harmos_ProjectedCg_def.hpp"
#include "Harmos_SmalbeSolver_def.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

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
    spec.expert().list(SmalbeSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::fallBack(const std::string& why) {
  ++this->result_.counters.safeguards;
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> solver;
  if (this->problem_->hasFollowingLimits())
    solver = Teuchos::rcp(new FixedPointSolver<Scalar, MV, OP>(Details::cloneOf(*this)));
  else if (this->problem_->hasEqualities())
    solver = Teuchos::rcp(new SmalbeSolver<Scalar, MV, OP>);
  else
    solver = Teuchos::rcp(new MprgpSolver<Scalar, MV, OP>);
  this->log_.detail(
      "PDAS: " + why + "; fallback to " +
      (this->problem_->hasFollowingLimits() ? "fixed-point updates of the limits" : solver->name()));
  solver->setHandsOver(false);
  this->delegate(*solver);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::doSolve() {
  if (!this->problem_->hasBounds() && !this->problem_->hasSoftBounds()) {
    this->log_.info("Note: without bounds, PDAS is PCPG");
    PcpgSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  if (this->resumesDelegate())
    return fallBack("restart of an interrupted fallback");
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
      rows_(rows),
      problem_(*solver.problem_),
      counters_(solver.result_.counters),
      x_(*problem_.solution()),
      feasible_(problem_.feasibleSet()),
      y_(MVT::Clone(x_, 1)),
      cg_(problem_, rows, CgOptions::fromList(solver.methodParameters("PCPG")), counters_),
      descent_(problem_, rows, cg_),
      next_(problem_, rows),
      sides_(problem_),
      inner_(solver.firstInner_) {
  const Teuchos::ParameterList& list = solver.methodParameters("PDAS");
  const std::string first = list.get<std::string>("First active set");
  const bool hasIntervals = feasible_.anyBound() != nullptr;
  // Where pairs turn, sets take a product and bring less.
  options_.innerReduction =
      (problem_.hasDiscs() || hasFollowing() ? 0.5 : 1.0) * list.get<double>("Inner reduction");
  options_.patience = list.get<int>("Active sets without progress");
  options_.mostSets = list.get<int>("Maximum active sets");
  options_.mostKept = list.get<int>("Kept directions");
  options_.firstSet = !hasIntervals        ? FirstSet::Gradient
                      : first == "tried"   ? FirstSet::Tried
                      : first == "nearest" ? FirstSet::Nearest
                      : first == "auto"    ? FirstSet::Auto
                                           : FirstSet::Gradient;
  const int left = solver.maximumIterations() - solver.firstInner_;
  // Another method makes nothing of a handful of iterations.
  constexpr int fewIterations = 100;
  options_.budget =
      solver.firstInner_ + (left <= fewIterations || hasNoOther()
                                ? left
                                : static_cast<int>(list.get<double>("Share of iterations") * left));
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::go() {
  begin();
  while (true) {
    if (newFace_ && !enterFace())
      return;
    aim();
    if (!descend()) {
      if (!std::exchange(restarts_, false))
        return;
      newFace_ = true;
      continue;
    }
    look();
    isMoved_ = false;
    if (!std::isfinite(expected_))
      return solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_);
    if (considerCandidate() && confirmAnswer())
      return;
    settled_ = change_.changed == 0;
    newFace_ = !settled_ || isMoved_;
    if (newFace_ && !advanceOrFallBack())
      return;
  }
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::describeState() {
  solver_.describeState([this](StateArchive<MV>& archive) {
    archive.number("inner", inner_);
    archive.number("pdas active", active_);
    archive.number("pdas settled", settled_);
    archive.number("pdas target", target_);
    archive.number("pdas inner reduction", options_.innerReduction);
    if (hasFollowing())
      archive.number("pdas disproved", disproved_);
    if (mayBalance())
      balance_.exchange(archive);
    archive.number("pdas stepped", stepped_);
    archive.number("pdas face steps", faceSteps_);
    progress_.exchange(archive);
    best_.exchange(archive, problem_);
    descent_.exchange(archive);
    exchangeFace(archive, "pdas", problem_, x_, set_);
    if (problem_.hasDiscs())
      archive.number("pdas slips", change_.slips);
    if (problem_.hasSoftBounds())
      sides_.exchange(archive);
    if (hasFollowing()) {
      const Teuchos::RCP<MV> radii = MVT::Clone(x_, 1);
      problem_.limits(*radii);
      archive.vector("pdas limits", *radii);
      if (archive.isReading())
        solver_.problem_->setLimits(*radii);
    }
    cg_.exchange(archive);
  });
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::Progress::exchange(StateArchive<MV>& archive) {
  archive.number("pdas repeats", repeats);
  archive.number("pdas least", least);
  archive.number("pdas mark", mark);
  archive.number("pdas sets since mark", setsSinceMark);
  archive.number("pdas last set", last.first);
  archive.number("pdas last set's other", last.second);
  std::vector<double> signatures;
  for (const auto& [first, second] : seen)
    signatures.insert(signatures.end(), {first, second});
  archive.numbers("pdas sets seen", signatures);
  for (std::size_t k = 0; k + 1 < signatures.size(); k += 2)
    seen.insert({signatures[k], signatures[k + 1]});
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::Best::exchange(StateArchive<MV>& archive,
                                                     const Problem<Scalar, MV, OP>& problem) {
  archive.vector("pdas best", *x);
  archive.number("pdas has best", isFound);
  if (!multiplier.is_null())
    archive.rowVector("pdas best multiplier", *multiplier);
  bool hasGradient = !gradient.is_null();
  archive.number("pdas has best gradient", hasGradient);
  if (!hasGradient)
    return;
  if (gradient.is_null())
    gradient = MVT::Clone(*x, 1);
  archive.vector("pdas best gradient", *gradient);
  exchangeFace(archive, "pdas best", problem, *x, set);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::Balance::exchange(StateArchive<MV>& archive) {
  archive.number("pdas balances", isOn);
  archive.number("pdas stiffening", stiffening);
  archive.number("pdas paths", paths);
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::Progress::isLost(double bound, int patience) {
  least = std::min(least, bound);
  if (least < 0.5 * mark) {
    mark = least;
    setsSinceMark = 0;
    return false;
  }
  return ++setsSinceMark >= patience;
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::Progress::isCircle(const ActiveSetChange& change) {
  return !seen.insert({change.signature[0], change.signature[1]}).second && ++repeats > mostRepeats;
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::Progress::isBack(const ActiveSetChange& change) {
  const std::pair<double, double> now{change.signature[0], change.signature[1]};
  const bool isSame = now == std::exchange(last, now);
  return !seen.insert(now).second && !isSame;
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::enterFace() {
  // A face that took so long has outlying eigenvalues, and so have the others.
  constexpr int slow = 10;
  if (!started_ && cg_.staleness() >= slow)
    if (const int found = cg_.keepOutliers(options_.mostKept); found > 0)
      solver_.log_.detail("PDAS: " + std::to_string(found) + " search directions kept for all faces");
  const bool isOn = started_ || (startsOnFace() && descent_.enter(set_, active_));
  if (!isOn && descent_.isOn()) {
    handOver("no step decreases the cost");
    return false;
  }
  const std::string why = "the equalities are infeasible on a face";
  if (!isOn && !findWayOn(Trouble::NoFace, why)) {
    handOver(why);
    return false;
  }
  started_ = false;
  ++counters_.faces;
  state_ = evaluate(cg_.residualNorm(), state_.inner);
  solver_.record(state_, solver_.result_.history.empty() ? StepKind::Start : StepKind::ActiveSet, 0.0, 0.0,
                 active_);
  return true;
}

// How far this face is followed.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::aim() {
  counters_.outerIterations = counters_.activeSetUpdates + 1;
  if (!resumed_) {
    target_ = settled_ && change_.slips == 0 ? 0.0 : options_.innerReduction * cg_.slipping().residual;
    stepped_ = false;
    faceSteps_ = 0;
  }
  resumed_ = false;
}

// Conjugate gradients on the face, until its target or the tests are met.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::descend() {
  while (true) {
    inner_ = state_.inner;
    if (!std::isfinite(cg_.residualNorm())) {
      solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_);
      return false;
    }
    if (cg_.returnToRows(state_.equalityDistance))
      state_ = evaluate(cg_.residualNorm(), state_.inner);
    // What is wrong with tangents adds to the residual.
    IterationState<MV> judged = state_;
    if (problem_.hasDiscs() || hasFollowing())
      judged.projectedGradient *= 2.0;
    std::optional<Reason> reason = solver_.judge(judged);
    // What was looked at before and was no answer is not looked at again for a little less.
    if (hasFollowing() && reason == Reason::Converged && cg_.residualNorm() > 0.25 * disproved_)
      reason.reset();
    // No end is believed by an old distance from the equalities.
    const bool isAttained = cg_.residualNorm() <= cg_.attainable();
    if ((reason == Reason::Converged || isAttained) && !cg_.hasLooked()) {
      cg_.lookAtRows();
      state_ = evaluate(cg_.residualNorm(), state_.inner);
      continue;
    }
    if (const Reason end = reason.value_or(Reason::Converged); end != Reason::Converged) {
      solver_.keepState(end);
      state_ = measure(state_.inner, false);
      solver_.stopFor(end, state_);
      return false;
    }
    if (reason || isFarEnough() || isAttained || (stepped_ && descent_.isAstray(set_)))
      return true;
    if (isInterrupted() || !advance())
      return false;
  }
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isInterrupted() {
  if (!solver_.isInterrupted(state_))
    return false;
  cg_.lookAtRows();
  state_ = evaluate(cg_.residualNorm(), state_.inner);
  solver_.stop(Reason::Interrupted, Explanations::interrupted(), state_);
  return true;
}

// Pairs that are off their rims by more than radii would turn to anywhere.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isFarEnough() const {
  constexpr double mostOvershoot = 0.2;
  const typename Cg::Slipping slipping = cg_.slipping();
  return slipping.residual <= target_ && slipping.overshoot <= mostOvershoot;
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::advance() {
  // Exact conjugate gradients end within the dimension of the face.
  const auto length = static_cast<long long>(MVT::GetGlobalLength(x_));
  const bool isSpent = state_.inner >= options_.budget && options_.budget < solver_.maximumIterations();
  if (isSpent || faceSteps_++ > 2 * (length - active_) + 10) {
    const std::string why =
        isSpent ? "its share of the iterations is used up" : "conjugate gradients stagnate on a face";
    handOver(why);
    return false;
  }
  const typename Cg::Outcome outcome = cg_.step();
  if (outcome == Cg::Outcome::Flat) {
    const std::string why = "the Hessian is singular on a face";
    restarts_ = findWayOn(Trouble::BadFace, why);
    if (!restarts_)
      handOver(why);
    return false;
  }
  if (outcome == Cg::Outcome::Breakdown) {
    // Where pairs slip or limits follow, the equations of a face are those of a guess, and may be bad ones.
    restarts_ = findWayOn(Trouble::BadFace, "conjugate gradients break down on a face");
    if (!restarts_)
      solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_);
    return false;
  }
  stepped_ = true;
  state_ = evaluate(cg_.residualNorm(), state_.inner + 1);
  solver_.record(state_, StepKind::Projected, 0.0, 0.0, active_);
  return true;
}

// The next active set, and what the present iterate is worth.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::look() {
  if (active_ > 0 || hasFollowing() || problem_.hasSoftBounds() ||
      problem_.hasDiscs()) // multipliers of active bounds are all that it is asked for, and of discs
    cg_.lagrangianGradient(*y_);
  const double epsilon = std::numeric_limits<double>::epsilon();
  const double curvature = cg_.curvatureBound();
  before_ = set_;
  // Slipping pairs go on along their tangents until what is wrong with all of these counts beside the
  // residual: of gradients and of distances half of it each at most, so that descend() can judge by twice the
  // residual.
  const double turn =
      0.5 * cg_.slipping().residual / std::sqrt(std::max(1.0, static_cast<double>(change_.slips)));
  const double stepLength = curvature > 0.0 ? 1.0 / curvature : 0.0;
  if (hasFollowing())
    solver_.problem_->follow({stepLength, 1.0}, y_.get());
  change_ = Sets::updateActiveSet(x_, *y_, feasible_, 10.0 * epsilon * norm<Scalar>(x_),
                                  10.0 * cg_.attainable(), set_, {stepLength, turn});
  if (hasFollowing())
    lookAtFollowing(stepLength);
  if (problem_.hasSoftBounds())
    lookAtSprings(10.0 * epsilon * norm<Scalar>(x_));
  if (next_.isFit())
    next_.aim(x_, *y_, balance_.stiffening * cg_.stiffness());
  // ‖g^P‖ at the projection of x is at most ‖w‖ + ‖multipliers of the wrong sign‖ + ‖A‖‖x − Π(x)‖.
  expected_ = cg_.residualNorm() + std::sqrt(change_.wrongSign2) + curvature * std::sqrt(change_.violation2) +
              wrongSprings_;
  active_ = change_.active;
  if (descent_.isOn())
    faceCost_ = cg_.cost();
  if (expected_ < progress_.least) {
    progress_.least = expected_;
    MVT::Assign(x_, *best_.x);
    Bounds::project(*best_.x, feasible_);
    if (rows_.isPresent())
      cg_.multiplier(*best_.multiplier);
    if (mayBalance()) {
      if (best_.gradient.is_null())
        best_.gradient = MVT::Clone(x_, 1);
      MVT::Assign(*y_, *best_.gradient);
      best_.set = set_;
    }
    best_.isFound = true;
  }
}

// Limits that have moved by what counts beside the residual make another face.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::lookAtFollowing(double stepLength) {
  const FollowChange more = Limits::updateFollowing(x_, *y_, feasible_, problem_.followingLimits(),
                                                    stepLength, 10.0 * cg_.attainable(), before_, set_);
  change_.active += more.active;
  change_.changed += more.changed;
  if (change_.changed == 0 && std::sqrt(more.distance2) > 0.5 * stepLength * cg_.residualNorm())
    change_.changed = 1;
  change_.violation2 += more.distance2;
}

// A settled face that the tests send back without a step would be sent back for ever: what is left of wrong
// signs and violations is rounding errors.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::isExhausted() const {
  return cg_.residualNorm() <= cg_.attainable() || (settled_ && !stepped_);
}

template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::considerCandidate() {
  if (change_.changed == 0 && isExhausted())
    return true;
  double expected = expected_;
  if (hasFollowing() && !problem_.hasDiscs()) { // what is beyond limits, by the stiffness that there is
    expected = cg_.residualNorm() + std::sqrt(change_.wrongSign2) +
               cg_.stiffness() * std::sqrt(change_.violation2) + wrongSprings_;
    if (change_.changed != 0 && expected > 0.5 * disproved_)
      return false;
  }
  if (solver_.judge(evaluate(expected, state_.inner)) != Reason::Converged)
    return false;
  disproved_ = expected; // unless it is the answer
  return true;
}

// Whether the projection of x is the answer, or as near to it as rounding errors allow.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::confirmAnswer() {
  const bool exhausted = isExhausted();
  isMoved_ = hasFollowing();
  state_ = measure(state_.inner, change_.violation2 == 0.0);
  bool sentBack = false;
  while (solver_.judge(state_) == Reason::Converged) {
    if (solver_.accepted()) {
      solver_.stopFor(Reason::Converged, state_);
      return true;
    }
    sentBack = true; // the test is stricter now
  }
  if (sides_.areFrozen() && change_.changed == 0 && !sentBack && moveSides())
    return false;
  if (change_.changed != 0 || (cg_.residualNorm() > cg_.attainable() && (!exhausted || sentBack)))
    return false;
  isMoved_ = cg_.isRefinable(); // the same face, from where x is now
  if (isMoved_)
    return false;
  solver_.stop(Reason::Stagnation,
               Explanations::stagnation(state_.projectedGradient, cg_.attainable(), state_.equalityDistance),
               state_);
  return true;
}

// The order of escalation: what is tried, and at which troubles. What is found has to lead onto a face where
// there was none.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::findWayOn(Trouble trouble, const std::string& why) {
  struct Way {
    bool (Run::*propose)(const std::string& why);
    std::vector<Trouble> against;
  };
  static const Way ways[] = {
      {&Run::balanceSets, {Trouble::NoProgress}},
      {&Run::restartFromInteriorPoint, {Trouble::NoFace, Trouble::BadFace, Trouble::NoProgress}},
      {&Run::followFaces, {Trouble::NoProgress}},
      {&Run::freezeSides, {Trouble::NoProgress, Trouble::ManySets}},
      {&Run::startDescent, {Trouble::NoFace, Trouble::NoProgress}},
  };
  const auto leadsOntoFace = [&] { return startsOnFace() && descent_.enter(set_, active_); };
  return std::any_of(std::begin(ways), std::end(ways), [&](const Way& way) {
    return std::find(way.against.begin(), way.against.end(), trouble) != way.against.end() &&
           (this->*way.propose)(why) && (trouble != Trouble::NoFace || leadsOntoFace());
  });
}

// Sets that are made of iterates far from the solutions on their faces may wander where A is badly
// conditioned, as in the bending of slender bodies: faces are followed further before anything else is tried.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::followFaces(const std::string& why) {
  if (descent_.isOn() || options_.innerReduction < carefulReduction)
    return false;
  options_.innerReduction *= 0.2; // 0.1, 0.02
  progress_.forget();
  solver_.log_.detail("PDAS: " + why + "; smaller inner residuals on faces");
  return true;
}

// From the best iterate on, sets descend.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::startDescent(const std::string& why) {
  if (descent_.isOn() || problem_.hasDiscs() || hasFollowing() ||
      (problem_.hasSoftBounds() && !sides_.areFrozen()))
    return false;
  const Teuchos::RCP<MV> present = MVT::CloneCopy(x_);
  MVT::Assign(*best_.x, x_);
  if (!descent_.begin(set_, active_)) {
    MVT::Assign(*present, x_);
    return false;
  }
  ++counters_.descents;
  solver_.log_.detail("PDAS: " + why + "; descent of sets from the best iterate");
  return true;
}

// To another set.
template<class Scalar, class MV, class OP>
bool PdasSolver<Scalar, MV, OP>::Run::advanceOrFallBack() {
  ++counters_.activeSetUpdates;
  if (!descent_.isOn() && !sides_.areFrozen() && counters_.activeSetUpdates >= options_.mostSets) {
    const std::string limit = "limit of " + std::to_string(options_.mostSets) + " active sets";
    if (findWayOn(Trouble::ManySets, limit))
      return true;
    handOver("the " + limit + " was reached");
    return false;
  }
  if (descent_.isOn()) {
    if (descent_.leave(faceCost_, change_.violation2 == 0.0, before_, set_, active_))
      return true;
    handOver("no feasible point nearby");
    return false;
  }
  // Motions of bodies that hardly anything holds grow with each set.
  constexpr double blownUp = 1e3;
  const bool isBlownUp = mayBalance() && !balance_.isOn && expected_ > blownUp * progress_.least;
  const bool isLost = progress_.isLost(expected_, options_.patience) || isBlownUp;
  const std::string why = isBlownUp ? "unbalanced forces have grown"
                          : isLost  ? std::to_string(options_.patience) + " active sets without progress"
                                    : "an active set recurred";
  // Where limits follow a set may be the same again and again until these settle; the first that comes back
  // after another one goes in circles, for there is no cost that falls on the way.
  const bool isCircle = hasFollowing() ? progress_.isBack(change_) : progress_.isCircle(change_);
  if (!isLost && !isCircle)
    return true;
  if (findWayOn(Trouble::NoProgress, why))
    return true;
  handOver(why);
  return false;
}

template<class Scalar, class MV, class OP>
IterationState<MV> PdasSolver<Scalar, MV, OP>::Run::evaluate(double gradientNorm, int inner) {
  return cg_.evaluate(gradientNorm, counters_.activeSetUpdates + 1, inner);
}

// What is reported and believed is the gradient at the projection of x, computed anew; or the one that was
// carried along, where x is within the bounds to the last bit and the rounding errors that may have gathered
// are below a tenth of it.
template<class Scalar, class MV, class OP>
IterationState<MV> PdasSolver<Scalar, MV, OP>::Run::measure(int inner, bool feasible) {
  if (feasible && cg_.staleness() > 0) {
    cg_.trueGradient(*y_);
    const double carried = Bounds::projectedGradientNorm(x_, *y_, feasible_);
    if (10.0 * cg_.attainable() <= carried) {
      cg_.storeMultiplier();
      if (!cg_.hasLooked())
        cg_.lookAtRows();
      return evaluate(carried, inner);
    }
  }
  if (hasFollowing()) {
    solver_.problem_->follow();
    solver_.problem_->moveToLimits(set_);
  }
  Bounds::project(x_, feasible_);
  ++counters_.confirmations;
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), x_, *y_);
  MVT::MvAddMv(1.0, *y_, -1.0, *problem_.rhs(), *y_);
  SpringOps<Scalar, MV>::addForces(problem_.softBounds(), x_, *y_);
  if (rows_.isPresent()) {
    const Teuchos::RCP<MV> mu = rows_.makeVector();
    cg_.multiplier(*mu);
    rows_.addTransposed(1.0, *mu, *y_);
  }
  cg_.storeMultiplier();
  cg_.lookAtRows(); // x was moved
  return evaluate(Bounds::projectedGradientNorm(x_, *y_, feasible_), inner);
}

// Another method goes on from the best iterate.
template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::Run::handOver(const std::string& why) {
  MVT::Assign(*best_.x, x_);
  if (rows_.isPresent() && best_.isFound)
    rows_.toUser(*best_.multiplier, *problem_.multiplier());
  if (hasNoOther()) {
    state_ = measure(state_.inner, false);
    return solver_.stop(Reason::Stagnation, Explanations::noOtherMethod(why), state_);
  }
  solver_.fallBack(why);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PdasSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
