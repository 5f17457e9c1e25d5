// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_MprgpSolver_def.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasSolver.hpp"
#include "Harmos_ProjectedCg_def.hpp"
#include "Harmos_SmalbeSolver_def.hpp"

#include <cmath>
#include <set>
#include <utility>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
ParameterSpec PdasSolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("PDAS", "Primal-dual active sets.");
  spec.real("Inner reduction", 0.5, Range::strictlyWithin(0.0, 1.0),
            "Reduction of the residual on a face after which the active set is looked at again, until it "
            "settles.");
  spec.integer("Maximum active sets", 200, 1, 1000000,
               "Active sets tried before a globally convergent method takes over.");
  spec.integer(
      "Active sets without progress", 10, 1, 1000000,
      "Active sets tried in a row, none of which halves the bound on the projected gradient, before a "
      "globally convergent method takes over.");
  spec.real("Share of iterations", 0.5, Range{0.0, 1.0, true, false},
            "Part of \"Maximum Iterations\" after which a globally convergent method takes over; all of them "
            "if there "
            "are no more than 100.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& PdasSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("PDAS", "The primal-dual active set solver.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.list(methodSpec());
    spec.list(CgOptions::parameterSpec());
    spec.list(SmalbeSolver<Scalar, MV, OP>::methodSpec());
    spec.list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::fallBack(const std::string& why) {
  ++this->result_.counters.safeguards;
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> solver;
  if (this->problem_->hasEqualities())
    solver = Teuchos::rcp(new SmalbeSolver<Scalar, MV, OP>);
  else
    solver = Teuchos::rcp(new MprgpSolver<Scalar, MV, OP>);
  this->log_.detail("PDAS: " + why + "; " + solver->name() + " takes over");
  this->delegate(*solver);
}

template<class Scalar, class MV, class OP>
void PdasSolver<Scalar, MV, OP>::doSolve() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  using Cg = ProjectedCg<Scalar, MV, OP>;
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  if (!problem.hasBounds()) {
    this->log_.info("Note: without bounds, PDAS is PCPG");
    PcpgSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  if (this->resumesDelegate())
    return fallBack("in the run before this one");
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  if (rows->isPresent() && !rows->isOrthonormal())
    throw InputError("PDAS needs equality rows with CCᵀ = I; there are more than \"Orthonormalised Rows\" "
                     "allows to make so. Use SMALBE, or raise that parameter");
  const Teuchos::ParameterList& list = this->parameters_->sublist("PDAS");
  const double innerReduction = list.get<double>("Inner reduction");
  const int patience = list.get<int>("Active sets without progress");
  const int mostSets = list.get<int>("Maximum active sets");
  const int left = this->maximumIterations() - this->firstInner_;
  // Another method makes nothing of a handful of iterations.
  constexpr int fewIterations = 100;
  const int budget =
      this->firstInner_ +
      (left <= fewIterations ? left : static_cast<int>(list.get<double>("Share of iterations") * left));
  const auto length = static_cast<long long>(MVT::GetGlobalLength(*problem.solution()));
  const MV* lower = problem.lowerBound().get();
  const MV* upper = problem.upperBound().get();
  MV& x = *problem.solution();
  Counters& counters = this->result_.counters;
  const Teuchos::RCP<MV> y = MVT::Clone(x, 1),
                         residual = rows->isPresent() ? rows->makeVector() : Teuchos::null;
  long long active = 0;

  const auto evaluate = [&](double gradientNorm, int inner) {
    IterationState<MV> state;
    state.x = &x;
    state.projectedGradient = gradientNorm;
    if (rows->isPresent()) {
      rows->residual(x, *residual);
      state.equalityResidual = rows->residualNorm();
      state.equalityDistance = rows->distance();
    }
    state.decrease = std::numeric_limits<double>::quiet_NaN();
    state.outer = counters.activeSetUpdates + 1;
    state.inner = inner;
    state.counters = &counters;
    return state;
  };
  const auto storeMultiplier = [&](const Cg& cg) {
    if (!rows->isPresent())
      return;
    const Teuchos::RCP<MV> mu = rows->makeVector();
    cg.multiplier(*mu);
    rows->toUser(*mu, *problem.multiplier());
  };

  // What is reported and believed is the gradient at the projection of x, computed anew; or the one that was
  // carried along, where x is within the bounds to the last bit and the rounding errors that may have
  // gathered are below a tenth of it.
  const auto measure = [&](const Cg& cg, int inner, bool feasible) {
    if (feasible && cg.staleness() > 0) {
      cg.lagrangianGradient(*y);
      const double carried = BT::projectedGradientNorm(x, *y, lower, upper);
      if (10.0 * cg.attainable() <= carried) {
        storeMultiplier(cg);
        return evaluate(carried, inner);
      }
    }
    BT::project(x, lower, upper);
    ++counters.confirmations;
    ++counters.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem.hessian(), x, *y);
    MVT::MvAddMv(1.0, *y, -1.0, *problem.rhs(), *y);
    if (rows->isPresent()) {
      const Teuchos::RCP<MV> mu = rows->makeVector();
      cg.multiplier(*mu);
      rows->addTransposed(1.0, *mu, *y);
    }
    storeMultiplier(cg);
    return evaluate(BT::projectedGradientNorm(x, *y, lower, upper), inner);
  };

  Cg cg(problem, *rows, CgOptions::fromList(this->parameters_->sublist("PCPG")), counters);
  BT::project(x, lower, upper);
  const Teuchos::RCP<MV> initial = MVT::CloneCopy(x);
  LocalActiveSet set;
  // The first active set: entries at a bound that the gradient pushes against it. The gradient costs a
  // product where x is not zero. If that at zero, which costs nothing, mostly pushes against these bounds,
  // the product is made on the face where all of them are active, as the first one of its solution.
  const auto addMultiplier = [&] {
    if (!rows->isPresent())
      return;
    const Teuchos::RCP<MV> mu = rows->makeVector();
    rows->toInternal(*problem.multiplier(), *mu);
    rows->addTransposed(1.0, *mu, *y);
  };
  ActiveSetChange change;
  bool started = false;
  const auto guess = [&] {
    MVT::MvAddMv(-1.0, *problem.rhs(), 0.0, *problem.rhs(), *y);
    addMultiplier();
    BT::split(x, *y, lower, upper, 1.0, nullptr, set);
    LocalActiveSet pushed = set;
    change = BT::updateActiveSet(x, *y, lower, upper, 0.0, 0.0, pushed);
    if (norm<Scalar>(x) > 0.0) {
      const Teuchos::RCP<MV> projected = MVT::CloneCopy(x), free = MVT::CloneCopy(*y);
      BT::maskActive(*free, set);
      const double atBounds2 = dot<Scalar>(*y, *y) - dot<Scalar>(*free, *free);
      started = change.wrongSign2 <= 0.1 * atBounds2 && cg.start(set);
      if (started) {
        cg.lagrangianGradient(*y);
        change = BT::updateActiveSet(x, *y, lower, upper,
                                     10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(x),
                                     10.0 * cg.attainable(), set);
        started = change.changed == 0;
      } else {
        MVT::Assign(*projected, x);
        ++counters.hessianApplications;
        Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem.hessian(), x, *y);
        MVT::MvAddMv(1.0, *y, -1.0, *problem.rhs(), *y);
        addMultiplier();
        change = BT::updateActiveSet(x, *y, lower, upper, 0.0, 0.0, set);
      }
    } else {
      set = pushed;
    }
    active = change.active;
  };

  std::set<std::pair<double, double>> seen;
  bool settled = false, newFace = true;
  // Inexact solves may come back to a set on their way; exact ones that do so go round in circles.
  constexpr int mostRepeats = 3;
  int repeats = 0;
  // The least bound on ‖g^P‖ so far, and what it was when it had last fallen by half. Newton's method on sets
  // has no such decrease far from the solution: it may wander for hundreds of sets, where matrices are far
  // from M-matrices (elements of second order in contact).
  double least = std::numeric_limits<double>::infinity(), mark = least;
  int setsSinceMark = 0;
  // On a face.
  double target = 0.0;
  bool stepped = false, resumed = false;
  long long faceSteps = 0;
  int inner = this->firstInner_;
  this->describeState([&](StateArchive<MV>& archive) {
    archive.number("inner", inner);
    archive.number("pdas active", active);
    archive.number("pdas settled", settled);
    archive.number("pdas target", target);
    archive.number("pdas stepped", stepped);
    archive.number("pdas face steps", faceSteps);
    archive.number("pdas repeats", repeats);
    archive.number("pdas least", least);
    archive.number("pdas mark", mark);
    archive.number("pdas sets since mark", setsSinceMark);
    std::vector<double> signatures;
    for (const auto& [first, second] : seen)
      signatures.insert(signatures.end(), {first, second});
    archive.numbers("pdas sets seen", signatures);
    for (std::size_t k = 0; k + 1 < signatures.size(); k += 2)
      seen.insert({signatures[k], signatures[k + 1]});
    archive.vector("pdas initial", *initial);
    const Teuchos::RCP<MV> states = MVT::Clone(x, 1);
    BT::activeToVector(set, *states);
    archive.vector("pdas active set", *states);
    if (archive.isReading())
      BT::vectorToActive(*states, set);
    cg.exchange(archive);
  });
  if (this->resumes()) {
    this->resume();
    resumed = true;
    newFace = false;
  } else {
    guess();
  }
  IterationState<MV> state =
      evaluate(resumed ? cg.residualNorm() : std::numeric_limits<double>::infinity(), inner);
  while (true) {
    if (newFace) {
      if (!started && !cg.start(set))
        return fallBack("the equalities cannot be met on a face");
      started = false;
      ++counters.faces;
      state = evaluate(cg.residualNorm(), state.inner);
      this->record(state, this->result_.history.empty() ? StepKind::Start : StepKind::ActiveSet, 0.0, 0.0,
                   active);
    }
    counters.outerIterations = counters.activeSetUpdates + 1;
    if (!resumed) {
      target = settled ? 0.0 : innerReduction * cg.residualNorm();
      stepped = false;
      faceSteps = 0;
    }
    resumed = false;
    std::optional<Reason> reason;
    while (true) {
      inner = state.inner;
      if (!std::isfinite(cg.residualNorm()))
        return this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      reason = this->judge(state);
      if (reason || cg.residualNorm() <= std::max(target, cg.attainable()))
        break;
      if (this->isInterrupted(state))
        return;
      // Exact conjugate gradients end within the dimension of the face.
      const bool isSpent = state.inner >= budget && budget < this->maximumIterations();
      if (isSpent || faceSteps++ > 2 * (length - active) + 10) {
        BT::project(x, lower, upper);
        storeMultiplier(cg);
        return fallBack(isSpent ? "its share of the iterations is used up"
                                : "conjugate gradients crawl on a face");
      }
      const typename Cg::Outcome outcome = cg.step();
      if (outcome == Cg::Outcome::Flat)
        return fallBack("the Hessian is singular on a face");
      if (outcome == Cg::Outcome::Breakdown)
        return this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      stepped = true;
      state = evaluate(cg.residualNorm(), state.inner + 1);
      this->record(state, StepKind::Projected, 0.0, 0.0, active);
    }
    if (reason && *reason != Reason::Converged) {
      this->keepState(*reason);
      state = measure(cg, state.inner, false);
      return this->stopFor(*reason, state);
    }

    if (active > 0) // multipliers of active bounds are all that it is asked for
      cg.lagrangianGradient(*y);
    const double epsilon = std::numeric_limits<double>::epsilon();
    const double curvature = cg.curvatureBound();
    change = BT::updateActiveSet(x, *y, lower, upper, 10.0 * epsilon * norm<Scalar>(x),
                                 10.0 * cg.attainable(), set);
    active = change.active;
    // ‖g^P‖ at the projection of x is at most ‖w‖ + ‖multipliers of the wrong sign‖ + ‖A‖‖x − Π(x)‖.
    const double expected =
        cg.residualNorm() + std::sqrt(change.wrongSign2) + curvature * std::sqrt(change.violation2);
    if (!std::isfinite(expected))
      return this->stop(Reason::Breakdown, Explanations::breakdown(), state);
    // A settled face that the tests send back without a step would be sent back for ever: what is left of
    // wrong signs and violations is rounding errors.
    const bool exhausted = cg.residualNorm() <= cg.attainable() || (settled && !stepped);
    if (this->judge(evaluate(expected, state.inner)) == Reason::Converged ||
        (change.changed == 0 && exhausted)) {
      state = measure(cg, state.inner, change.violation2 == 0.0);
      bool sentBack = false;
      while (this->judge(state) == Reason::Converged) {
        if (this->accepted())
          return this->stopFor(Reason::Converged, state);
        sentBack = true; // the test is stricter now
      }
      if (change.changed == 0 && (cg.residualNorm() <= cg.attainable() || (exhausted && !sentBack)))
        return this->stop(
            Reason::Stagnation,
            Explanations::stagnation(state.projectedGradient, cg.attainable(), state.equalityDistance),
            state);
    }
    settled = change.changed == 0;
    newFace = !settled;
    if (settled)
      continue;
    ++counters.activeSetUpdates;
    if (counters.activeSetUpdates >= mostSets) {
      BT::project(x, lower, upper);
      storeMultiplier(cg);
      return fallBack("the limit of " + std::to_string(mostSets) + " active sets was reached");
    }
    least = std::min(least, expected);
    if (least < 0.5 * mark) {
      mark = least;
      setsSinceMark = 0;
    } else if (++setsSinceMark >= patience) {
      // Where it has wandered to is further from the solution than where it began.
      MVT::Assign(*initial, x);
      return fallBack(std::to_string(patience) + " active sets brought no progress");
    }
    if (!seen.insert({change.signature[0], change.signature[1]}).second && ++repeats > mostRepeats) {
      BT::project(x, lower, upper);
      storeMultiplier(cg);
      return fallBack("an active set came back");
    }
  }
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PdasSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
