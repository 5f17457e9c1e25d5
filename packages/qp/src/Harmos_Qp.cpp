// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Qp.hpp"

#include "Harmos_SolverFactory_def.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

namespace Harmos::qp {

template class Problem<Scalar, MultiVector, Operator>;
template class SolverManager<Scalar, MultiVector, Operator>;
template class MprgpIteration<Scalar, MultiVector>;
template class BoundedLagrangian<Scalar, MultiVector, Operator>;
template class MprgpSolver<Scalar, MultiVector, Operator>;
template class SmalbeSolver<Scalar, MultiVector, Operator>;
template class DualPenaltySolver<Scalar, MultiVector, Operator>;
template class PcpgSolver<Scalar, MultiVector, Operator>;
template class PdasSolver<Scalar, MultiVector, Operator>;
template class AutoSolver<Scalar, MultiVector, Operator>;
template class SolverFactory<Scalar, MultiVector, Operator>;

ParameterSpec MethodSpecs::mprgp() {
  return MprgpOptions::parameterSpec();
}
ParameterSpec MethodSpecs::smalbe() {
  return SmalbeSolver<Scalar, MultiVector, Operator>::methodSpec();
}
ParameterSpec MethodSpecs::pcpg() {
  return CgOptions::parameterSpec();
}
ParameterSpec MethodSpecs::pdas() {
  return PdasSolver<Scalar, MultiVector, Operator>::methodSpec();
}
ParameterSpec MethodSpecs::dualPenalty() {
  return DualPenaltySolver<Scalar, MultiVector, Operator>::methodSpec();
}

} // namespace Harmos::qp
