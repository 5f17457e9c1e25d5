// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceSolver_def.hpp"
#include "Harmos_PcpgSolver.hpp"
#include "Harmos_SolverManager_def.hpp"

#include <cmath>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
const ParameterSpec& PcpgSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("PCPG", "The solver for equalities alone.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(CgOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::doSolve() {
  if (!this->problem_->blocks().empty())
    throw InputError("PCPG handles equalities only, but the problem has bounds; use SMALBE or MPRGP");
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  if (rows->isPresent() && !rows->isOrthonormal())
    throw InputError("PCPG needs equality rows with CCᵀ = I, but there are more rows than \"Orthonormalised "
                     "Rows\" allows to orthonormalise. Pass orthonormal rows with "
                     "EqualityStructure::Orthonormal or raise that parameter");
  Run(*this, *rows).go();
}

template<class Scalar, class MV, class OP>
PcpgSolver<Scalar, MV, OP>::Run::Run(PcpgSolver& solver, EqualityRows<Scalar, MV, OP>& rows)
    : solver_(solver),
      rows_(rows),
      problem_(*solver.problem_),
      counters_(solver.result_.counters),
      cg_(problem_, rows, CgOptions::fromList(solver.methodParameters("PCPG")), counters_),
      inner_(solver.firstInner_) {}

template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::Run::begin() {
  solver_.describeState([this](StateArchive<MV>& archive) {
    archive.number("inner", inner_);
    cg_.exchange(archive);
  });
  if (solver_.resumes()) {
    solver_.resume();
    state_ = evaluate(inner_);
    return;
  }
  // Without a face there is nothing the equalities could contradict: the rows are consistent.
  cg_.start({});
  counters_.outerIterations = 1;
  state_ = evaluate(inner_);
  solver_.record(state_, StepKind::Start, 0.0, 0.0, 0);
}

template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::Run::go() {
  begin();
  while (true) {
    inner_ = state_.inner;
    if (!std::isfinite(state_.projectedGradient)) {
      solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_);
      break;
    }
    if (cg_.returnToRows(state_.equalityDistance))
      state_ = evaluate(inner_);
    const std::optional<Reason> reason = solver_.judge(state_);
    const bool isStagnant = !reason && state_.projectedGradient <= cg_.attainable();
    if ((reason == Reason::Converged || isStagnant) && !cg_.hasLooked()) {
      look();
      continue;
    }
    if ((reason == Reason::Converged || isStagnant) && !isConfirmed())
      continue;
    if (isStagnant) {
      solver_.stop(
          Reason::Stagnation,
          Explanations::stagnation(state_.projectedGradient, cg_.attainable(), state_.equalityDistance),
          state_);
      break;
    }
    if (reason == Reason::Converged) {
      cg_.storeMultiplier();
      if (!solver_.accepted())
        continue; // the test is stricter now
    }
    if (reason) {
      solver_.keepState(*reason);
      look();
      solver_.stopFor(*reason, state_);
      break;
    }
    if (isInterrupted() || !advance())
      break;
  }
  cg_.storeMultiplier();
}

// No end is believed by an old distance from the equalities.
template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::Run::look() {
  if (!cg_.hasLooked())
    cg_.lookAtRows();
  state_ = evaluate(state_.inner);
}

template<class Scalar, class MV, class OP>
bool PcpgSolver<Scalar, MV, OP>::Run::isInterrupted() {
  if (!solver_.isInterrupted(state_))
    return false;
  look();
  solver_.stop(Reason::Interrupted, Explanations::interrupted(), state_);
  return true;
}

// Whether the recurrence can be believed; if not, the gradient is computed anew.
template<class Scalar, class MV, class OP>
bool PcpgSolver<Scalar, MV, OP>::Run::isConfirmed() {
  if (cg_.staleness() <= 0 ||
      std::sqrt(static_cast<double>(cg_.staleness())) * cg_.attainable() <= 0.1 * state_.projectedGradient)
    return true;
  ++counters_.confirmations;
  cg_.restart();
  state_ = evaluate(state_.inner);
  return false;
}

template<class Scalar, class MV, class OP>
bool PcpgSolver<Scalar, MV, OP>::Run::advance() {
  const typename Cg::Outcome outcome = cg_.step();
  if (outcome == Cg::Outcome::Breakdown) {
    solver_.stop(Reason::Breakdown, Explanations::breakdown(), state_);
    return false;
  }
  if (outcome == Cg::Outcome::Flat) {
    stopFlat();
    return false;
  }
  state_ = evaluate(state_.inner + 1);
  solver_.record(state_, StepKind::Projected, 0.0, 0.0, 0);
  return true;
}

template<class Scalar, class MV, class OP>
IterationState<MV> PcpgSolver<Scalar, MV, OP>::Run::evaluate(int inner) {
  return cg_.evaluate(cg_.residualNorm(), 1, inner);
}

// The cost falls without end along the last direction.
template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::Run::stopFlat() {
  const Teuchos::RCP<MV> d = MVT::CloneCopy(cg_.direction());
  MVT::MvScale(*d, -1.0 / norm<Scalar>(*d));
  Certificate certificate;
  certificate.gap = dot<Scalar>(*problem_.rhs(), *d);
  if (cg_.curvatureBound() > 0.0)
    certificate.defect = norm<Scalar>(cg_.image()) / (norm<Scalar>(cg_.direction()) * cg_.curvatureBound());
  solver_.stopUnbounded(d, certificate);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PcpgSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
