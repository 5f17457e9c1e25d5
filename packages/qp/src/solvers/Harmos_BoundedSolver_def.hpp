// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedLagrangian_def.hpp"
#include "Harmos_BoundedSolver.hpp"
#include "Harmos_FeasibilityProbe.hpp"
#include "Harmos_SolverManager_def.hpp"

#include <cmath>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
IterationState<MV> BoundedSolver<Scalar, MV, OP>::begin(Lagrangian& lagrangian, double penalty,
                                                        double precision,
                                                        const std::function<void(StateArchive<MV>&)>& own) {
  this->describeState([&lagrangian, own, this](StateArchive<MV>& archive) {
    archive.number("outer", outer_);
    archive.number("inner", inner_);
    lagrangian.exchange(archive);
    if (own)
      own(archive);
  });
  if (this->resumes()) {
    this->resume();
    return lagrangian.evaluate(outer_, inner_);
  }
  lagrangian.start(penalty);
  this->result_.hessianNorm = lagrangian.hessianNorm();
  this->result_.counters.outerIterations = 1;
  State state = lagrangian.evaluate(1, this->firstInner_);
  this->record(state, StepKind::Start, penalty, precision, lagrangian.active());
  return state;
}

template<class Scalar, class MV, class OP>
bool BoundedSolver<Scalar, MV, OP>::minimise(Lagrangian& lagrangian, State& state,
                                             const std::function<bool(const State&)>& precise,
                                             double precision) {
  using Iteration = typename Lagrangian::Iteration;
  using Outcome = typename Iteration::Outcome;
  while (true) {
    outer_ = state.outer;
    inner_ = state.inner;
    if (!std::isfinite(state.projectedGradient) || !std::isfinite(state.equalityResidual)) {
      this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      return false;
    }
    if (const std::optional<Reason> reason = this->judge(state)) {
      // Believe the recurrence only as far as rounding errors allow.
      if (*reason == Reason::Converged && lagrangian.confirmGradient(state.projectedGradient)) {
        state = lagrangian.evaluate(state.outer, state.inner);
        continue;
      }
      if (*reason == Reason::Converged) {
        lagrangian.storeMultiplier();
        if (!this->accepted())
          continue; // the test is stricter now
      }
      this->keepState(*reason);
      this->stopFor(*reason, state);
      return false;
    }
    if (precise && precise(state))
      return true;
    const double attainable = lagrangian.attainableGradient();
    if (state.projectedGradient <= attainable) {
      if (lagrangian.confirmGradient(0.0)) {
        state = lagrangian.evaluate(state.outer, state.inner);
        continue;
      }
      if (precise && lagrangian.residual() > lagrangian.attainableEquality())
        return true; // the multiplier can still improve
      this->stop(Reason::Stagnation,
                 Explanations::stagnation(state.projectedGradient, attainable, state.equalityDistance),
                 state);
      return false;
    }
    if (this->isInterrupted(state))
      return false;
    const Outcome outcome = lagrangian.step();
    if (outcome == Outcome::Unbounded) {
      Certificate certificate;
      const Teuchos::RCP<MV> d = lagrangian.unboundedDirection(certificate);
      this->stopUnbounded(d, certificate);
      return false;
    }
    if (outcome == Outcome::Breakdown) {
      this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      return false;
    }
    state = lagrangian.evaluate(state.outer, state.inner + 1);
    const StepKind step = outcome == Outcome::Expansion       ? StepKind::Expansion
                          : outcome == Outcome::Proportioning ? StepKind::Proportioning
                                                              : StepKind::ConjugateGradient;
    this->record(state, step, lagrangian.penalty(), precision, lagrangian.active());
  }
}

template<class Scalar, class MV, class OP>
bool BoundedSolver<Scalar, MV, OP>::stopIfInfeasible(Rows& rows, int mostSteps, bool& feasible) {
  FeasibilityProbe<Scalar, MV, OP> probe(*this->problem_, rows);
  using Verdict = typename FeasibilityProbe<Scalar, MV, OP>::Verdict;
  const Teuchos::RCP<MV> y = rows.makeVector();
  Certificate certificate;
  const Verdict verdict = probe.run(mostSteps, *y, certificate);
  feasible = verdict == Verdict::Feasible;
  if (verdict != Verdict::Infeasible)
    return false;
  this->stopInfeasible(y, certificate);
  return true;
}

} // namespace Harmos::qp
