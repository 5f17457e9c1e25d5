// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AutoSolver.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasSolver_def.hpp"

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
const ParameterSpec& AutoSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("Auto", "The solver that the structure calls for.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(CgOptions::parameterSpec());
    spec.expert().list(PdasSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(SmalbeSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
std::string AutoSolver<Scalar, MV, OP>::choice(const Problem<Scalar, MV, OP>& problem) {
  if (problem.hasSoftBounds())
    return "PDAS";
  if (!problem.hasBounds())
    return "PCPG";
  const bool cheapFaces = !problem.hasEqualities() || !problem.faceGram().is_null();
  if (problem.hasPreconditioner() && cheapFaces)
    return "PDAS";
  return problem.hasEqualities() ? "SMALBE" : "MPRGP";
}

template<class Scalar, class MV, class OP>
void AutoSolver<Scalar, MV, OP>::doSolve() {
  const std::string method = choice(*this->problem_);
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> solver;
  if (method == "PCPG")
    solver = Teuchos::rcp(new PcpgSolver<Scalar, MV, OP>);
  else if (method == "SMALBE")
    solver = Teuchos::rcp(new SmalbeSolver<Scalar, MV, OP>);
  else if (method == "PDAS")
    solver = Teuchos::rcp(new PdasSolver<Scalar, MV, OP>);
  else
    solver = Teuchos::rcp(new MprgpSolver<Scalar, MV, OP>);
  this->delegate(*solver);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> AutoSolver<Scalar, MV, OP>::clone() const {
  return Details::cloneOf(*this);
}

} // namespace Harmos::qp
