// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver_def.hpp"
#include "Harmos_MprgpSolver.hpp"

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
const ParameterSpec& MprgpSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("MPRGP", "The solver for bounds alone.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
void MprgpSolver<Scalar, MV, OP>::doSolve() {
  if (this->problem_->hasEqualities())
    throw InputError("MPRGP handles bounds only, but the problem has equalities; use SMALBE");
  EqualityRows<Scalar, MV, OP> none(*this->problem_, 0);
  BoundedLagrangian<Scalar, MV, OP> lagrangian(*this->problem_, none,
                                               MprgpOptions::fromList(this->methodParameters("MPRGP")),
                                               this->result_.counters, this->resumes());
  IterationState<MV> state = this->begin(lagrangian, 0.0, 0.0);
  this->minimise(lagrangian, state, nullptr, 0.0);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> MprgpSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
