// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverManager.hpp"

namespace Harmos::qp {

/// "Auto": lets the solver that suits the problem's structure do the work; Result::method tells which.
///
///     no bounds                                          PCPG
///     soft bounds                                        PDAS
///     bounds, preconditioner, no equalities              PDAS
///     bounds, preconditioner, equalities with FaceGram   PDAS
///     bounds, no equalities                              MPRGP
///     bounds and equalities                              SMALBE
///
/// With a good preconditioner a face is solved in a few steps, and PDAS needs few faces; without one MPRGP
/// leaves a face before it has been solved too well. With equalities PDAS needs a factor of C_FC_Fᵀ for each
/// face, which is cheap only where an application knows their structure.
///
/// Guarded by tests/unit/qp/test_life_cycle.cpp.
template<class Scalar, class MV, class OP>
class AutoSolver : public SolverManager<Scalar, MV, OP> {
 public:
  std::string name() const override { return "Auto"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  bool letsLimitsFollow() const override { return true; }
  bool takesSoftBounds() const override { return true; }
  static const ParameterSpec& spec();

  /// The name of the solver that the problem's structure calls for.
  static std::string choice(const Problem<Scalar, MV, OP>& problem);

 protected:
  void doSolve() override;
};

} // namespace Harmos::qp
