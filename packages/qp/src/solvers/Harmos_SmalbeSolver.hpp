// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedSolver.hpp"

#include <algorithm>
#include <limits>

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

 private:
  class Run;
};

/// One solution of a problem: an outer iteration minimises to the precision of now, watches feasibility,
/// adapts ρ and M, and updates the multiplier.
template<class Scalar, class MV, class OP>
class SmalbeSolver<Scalar, MV, OP>::Run {
 public:
  Run(SmalbeSolver& solver, EqualityRows<Scalar, MV, OP>& rows);
  void go();

 private:
  // Asks for a probe when feasibility has not improved twice in a row, the next time after twice as long.
  struct InfeasibilityWatch {
    bool feasible = false;
    int slow = 0;
    int patience = 2;
    bool suspects(bool isSlow) {
      slow = isSlow ? slow + 1 : 0;
      if (feasible || slow < patience)
        return false;
      patience *= 2;
      return true;
    }
  };
  // Of the outer iteration before.
  struct Previous {
    double value = -std::numeric_limits<double>::infinity();
    double residual = std::numeric_limits<double>::infinity();
    int inner = -1;
  };
  // What turns the parameters of the list into those of the problem.
  struct Scales {
    double norm = 1.0, gradient = 1.0, equality = 1.0;
    double row = 1.0; // 1 but for rows used as they stand
  };

  static constexpr int mostProbeSteps = 1000; // each a product with C and Cᵀ

  Scales scales() const;
  void exchange(StateArchive<MV>& archive);
  bool isPrecise(const IterationState<MV>& state) const {
    return state.projectedGradient <= std::min(precision_ * lagrangian_.residual(), innerTolerance_);
  }
  // Of an outer iteration, in their order. Where one of them returns true, the solver has stopped.
  bool isSpent();
  bool isInfeasible();
  void adaptPenalty();
  void adaptPrecision();
  void updateMultiplier();
  void finish();

  SmalbeSolver& solver_;
  EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::ParameterList list_; // a copy: a monitor may give the solver other parameters
  bool byPenalty_, byPrecision_;
  BoundedLagrangian<Scalar, MV, OP> lagrangian_;
  double penalty_, largestPenalty_;           // ρ
  double precision_;                          // M
  double innerTolerance_, equalityTolerance_; // η of the rules
  IterationState<MV> state_;
  Previous previous_;
  InfeasibilityWatch watch_;
  double stretch_ = 1.0; // of the multiplier's update
};

} // namespace Harmos::qp
