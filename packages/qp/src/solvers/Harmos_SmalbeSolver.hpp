// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver.hpp"

namespace Harmos::qp {

/// "SMALBE": semimonotonic augmented Lagrangians for bounds and equalities, MPRGP inside.
///
/// An outer iteration minimises L(x, μ, ρ) over the bounds to a precision tied to the feasibility ‖r‖, r = Cx
/// − c, and then sets μ ← μ + ρr. Two rules:
///  - `penalty`: Algorithm 4.1 of Dostál, Horák, Vlach as printed. Inner stop ‖g^P‖ ≤ M‖r‖; if ‖r‖ ≤ η_k then
///    η ← αη, else ρ ← βρ (up to "Maximum penalty", which the paper does not have).
///  - `precision` (SMALBE-M; Dostál, Optimal Quadratic Programming Algorithms, 2009, chapter 6): ρ is fixed;
///    inner stop ‖g^P‖ ≤ min(M‖r‖, η); where L(x^k, μ^k, ρ) < L(x^{k−1}, μ^{k−1}, ρ) + ½ρ‖r^k‖², M ← θM.
///  - `both`: the inner stop of `precision`, and both updates.
///
/// The convergence test looks at the pair (x, μ + ρr), whose Lagrangian has the gradient of L(·, μ, ρ) at x:
/// Step 2 of Algorithm 4.1, and the multiplier that is returned.
///
/// The inner loop also ends when the convergence test itself passes (‖r‖ may vanish first), and when the
/// gradient has reached the level of its rounding errors.
///
/// When ‖r‖ does not fall from one outer iteration to the next, a FeasibilityProbe looks for the proof that
/// bounds and equalities contradict each other; a probe costs no product with A.
///
/// With parameters relative to ‖A‖ the method does not depend on the scales of A, b and x.
///
/// Guarded by tests/unit/qp/test_solvers.cpp.
template<class Scalar, class MV, class OP>
class SmalbeSolver : public BoundedSolver<Scalar, MV, OP> {
 public:
  std::string name() const override { return "SMALBE"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  static const ParameterSpec& spec();
  /// The list "SMALBE" alone.
  static ParameterSpec methodSpec();

 protected:
  void doSolve() override;
};

} // namespace Harmos::qp
