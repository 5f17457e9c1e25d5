// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver.hpp"

namespace Harmos::qp {

/// "Dual Penalty": minimises ½xᵀAx − bᵀx + ½ρ‖Cx − c‖² over the bounds, μ = 0, ρ fixed.
///
/// The answer violates the equalities by ‖Cx − c‖ ≤ C(1 + ε)‖b‖/ρ, in FETI with the natural coarse space with
/// a C that does not depend on the mesh (Dostál, Horák, Vlach, section 4 and Table 5.4). It converges when
/// the penalised problem is solved: ‖g^P(x, 0, ρ)‖ ≤ tol‖b‖; the equality residual is reported, not judged,
/// unless a convergence test of the caller does. On exit the problem's multiplier is ρ(Cx − c), the estimate
/// of μ.
///
/// Guarded by tests/unit/qp/test_solvers.cpp.
template<class Scalar, class MV, class OP>
class DualPenaltySolver : public BoundedSolver<Scalar, MV, OP> {
 public:
  std::string name() const override { return "Dual Penalty"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  bool meetsEqualities() const override { return false; }
  static const ParameterSpec& spec();
  /// The list "Dual Penalty" alone.
  static ParameterSpec methodSpec();

 protected:
  void doSolve() override;
};

} // namespace Harmos::qp
