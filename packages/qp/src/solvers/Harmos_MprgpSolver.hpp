// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver.hpp"

namespace Harmos::qp {

/// "MPRGP": for bounds alone, see MprgpIteration for the method and its theory.
///
/// Parameters: the common ones and the list "MPRGP". A problem with equalities is refused.
/// Guarded by tests/unit/qp/test_solvers.cpp.
template<class Scalar, class MV, class OP>
class MprgpSolver : public BoundedSolver<Scalar, MV, OP> {
 public:
  std::string name() const override { return "MPRGP"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  static const ParameterSpec& spec();

 protected:
  void doSolve() override;
};

} // namespace Harmos::qp
