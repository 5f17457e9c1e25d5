// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver_def.hpp"
#include "Harmos_DualPenaltySolver.hpp"
#include "Harmos_MprgpSolver_def.hpp"

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
ParameterSpec DualPenaltySolver<Scalar, MV, OP>::methodSpec() {
  ParameterSpec spec("Dual Penalty", "Equalities enforced by a fixed penalty.");
  spec.choice("Parameter scaling", "relative",
              {{"relative", "the penalty is a multiple of ‖A‖"}, {"absolute", "the penalty is absolute"}},
              "Unit of the penalty.");
  spec.real("Penalty", 1e4, Range::above(0.0), "Penalty ρ. The equality residual is proportional to 1/ρ.");
  return spec;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& DualPenaltySolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("Dual Penalty", "The penalty method for bounds and equalities.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void DualPenaltySolver<Scalar, MV, OP>::doSolve() {
  constexpr int mostProbeSteps = 1000; // each a product with C and Cᵀ
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (!this->problem_->hasEqualities()) {
    this->log_.info("Note: without equalities, Dual Penalty is MPRGP");
    MprgpSolver<Scalar, MV, OP> solver;
    return this->delegate(solver);
  }
  const Teuchos::ParameterList& list = this->methodParameters("Dual Penalty");
  MVT::MvInit(*this->problem_->multiplier(), 0.0);
  const Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows = this->makeRows();
  if (rows.is_null())
    return;
  BoundedLagrangian<Scalar, MV, OP> lagrangian(*this->problem_, *rows,
                                               MprgpOptions::fromList(this->methodParameters("MPRGP")),
                                               this->result_.counters, this->resumes());
  const bool relative = list.get<std::string>("Parameter scaling") == "relative";
  const double penalty =
      list.get<double>("Penalty") *
      (relative && lagrangian.hessianNorm() > 0.0 ? lagrangian.hessianNorm() / rows->norm2() : 1.0);
  IterationState<MV> state = this->begin(lagrangian, penalty, 0.0);
  this->minimise(lagrangian, state, nullptr, 0.0);
  this->result_.penalty = lagrangian.penalty();
  lagrangian.storeMultiplier();
  // A residual that the penalty does not make small may be that of a problem without feasible points.
  const double scale =
      std::sqrt(rows->norm2()) * norm<Scalar>(*this->problem_->solution()) + norm<Scalar>(rows->values());
  bool feasible = false;
  if (this->result_.reason != Reason::Unbounded && lagrangian.residual() > 1e-3 * scale)
    this->stopIfInfeasible(*rows, mostProbeSteps, feasible);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> DualPenaltySolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
