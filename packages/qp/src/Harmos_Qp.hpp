// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The QP layer as Harmos instantiates it for Tpetra, and the errors that it throws; other vector types
/// include Harmos_SolverFactory_def.hpp instead.

#include "Harmos_AutoSolver.hpp"
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_SolverFactory.hpp"
#include "Harmos_Types.hpp"

#include <BelosTpetraAdapter.hpp>

namespace Harmos::qp {

using TpetraProblem = Problem<Scalar, MultiVector, Operator>;
using TpetraSolverManager = SolverManager<Scalar, MultiVector, Operator>;
using TpetraFacePreconditioner = FacePreconditioner<MultiVector, Operator>;
using TpetraSolverFactory = SolverFactory<Scalar, MultiVector, Operator>;

extern template class Problem<Scalar, MultiVector, Operator>;
extern template class SolverManager<Scalar, MultiVector, Operator>;
extern template class AutoSolver<Scalar, MultiVector, Operator>;
extern template class SolverFactory<Scalar, MultiVector, Operator>;

/// Parameter lists of the methods, for those who compose a deck from them.
struct MethodSpecs {
  static ParameterSpec mprgp();
  static ParameterSpec smalbe();
  static ParameterSpec pcpg();
  static ParameterSpec pdas();
  static ParameterSpec dualPenalty();
};

} // namespace Harmos::qp
