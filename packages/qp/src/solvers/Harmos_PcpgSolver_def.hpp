// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PcpgSolver.hpp"
#include "Harmos_ProjectedCg_def.hpp"
#include "Harmos_SolverManager_def.hpp"

#include <cmath>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
const ParameterSpec& PcpgSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("PCPG", "The solver for equalities alone.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.list(CgOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void PcpgSolver<Scalar, MV, OP>::doSolve() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Cg = ProjectedCg<Scalar, MV, OP>;
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  if (problem.hasBounds())
    throw InputError("PCPG is for equalities alone, but the problem has bounds; use SMALBE or MPRGP");
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  if (rows->isPresent() && !rows->isOrthonormal())
    throw InputError("PCPG needs equality rows with CCᵀ = I; there are more than \"Orthonormalised Rows\" "
                     "allows to make so. Orthonormalise them and say so with EqualityStructure::Orthonormal, "
                     "or raise that parameter");
  Counters& counters = this->result_.counters;
  Cg cg(problem, *rows, CgOptions::fromList(this->parameters_->sublist("PCPG")), counters);
  const Teuchos::RCP<MV> residual = rows->isPresent() ? rows->makeVector() : Teuchos::null;
  const auto evaluate = [&](int inner) {
    IterationState<MV> state;
    state.x = problem.solution().get();
    state.projectedGradient = cg.residualNorm();
    if (rows->isPresent()) {
      rows->residual(*problem.solution(), *residual);
      state.equalityResidual = rows->residualNorm();
      state.equalityDistance = rows->distance();
    }
    state.decrease = std::numeric_limits<double>::quiet_NaN();
    state.outer = 1;
    state.inner = inner;
    state.counters = &counters;
    return state;
  };
  const auto storeMultiplier = [&] {
    if (!rows->isPresent())
      return;
    const Teuchos::RCP<MV> mu = rows->makeVector();
    cg.multiplier(*mu);
    rows->toUser(*mu, *problem.multiplier());
  };
  int inner = this->firstInner_;
  this->describeState([&](StateArchive<MV>& archive) {
    archive.number("inner", inner);
    cg.exchange(archive);
  });
  IterationState<MV> state;
  if (this->resumes()) {
    this->resume();
    state = evaluate(inner);
  } else {
    // Without a face there is nothing the equalities could contradict: the rows are consistent.
    cg.start({});
    counters.outerIterations = 1;
    state = evaluate(inner);
    this->record(state, StepKind::Start, 0.0, 0.0, 0);
  }
  while (true) {
    inner = state.inner;
    if (!std::isfinite(state.projectedGradient)) {
      this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      break;
    }
    const std::optional<Reason> reason = this->judge(state);
    const double attainable = cg.attainable();
    const bool done = reason == Reason::Converged, stagnant = state.projectedGradient <= attainable;
    if (done || (!reason && stagnant)) {
      if (cg.staleness() > 0 &&
          std::sqrt(static_cast<double>(cg.staleness())) * attainable > 0.1 * state.projectedGradient) {
        ++counters.confirmations;
        cg.restart();
        state = evaluate(state.inner);
        continue;
      }
      if (!done) {
        this->stop(Reason::Stagnation,
                   Explanations::stagnation(state.projectedGradient, attainable, state.equalityDistance),
                   state);
        break;
      }
    }
    if (done) {
      storeMultiplier();
      if (!this->accepted())
        continue; // the test is stricter now
    }
    if (reason) {
      this->keepState(*reason);
      this->stopFor(*reason, state);
      break;
    }
    if (this->isInterrupted(state))
      break;
    const typename Cg::Outcome outcome = cg.step();
    if (outcome == Cg::Outcome::Breakdown) {
      this->stop(Reason::Breakdown, Explanations::breakdown(), state);
      break;
    }
    if (outcome == Cg::Outcome::Flat) {
      const Teuchos::RCP<MV> d = MVT::CloneCopy(cg.direction());
      MVT::MvScale(*d, -1.0 / norm<Scalar>(*d));
      Certificate certificate;
      certificate.gap = dot<Scalar>(*problem.rhs(), *d);
      if (cg.curvatureBound() > 0.0)
        certificate.defect = norm<Scalar>(cg.image()) / (norm<Scalar>(cg.direction()) * cg.curvatureBound());
      this->stopUnbounded(d, certificate);
      break;
    }
    state = evaluate(state.inner + 1);
    this->record(state, StepKind::Projected, 0.0, 0.0, 0);
  }
  storeMultiplier();
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> PcpgSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
