// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows.hpp"
#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_MprgpIteration.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_StatusTest.hpp"

#include <Teuchos_RCP.hpp>

namespace Harmos::qp {

/// The augmented Lagrangian of a problem over its bounds, and the minimisation of it by MPRGP.
///
///     L(x, μ, ρ) = ½xᵀAx − bᵀx + μᵀr + ½ρ‖r‖²,   r = C̄x − c̄,   g = Ax − b + C̄ᵀ(μ + ρr)
///
/// with the rows of EqualityRows. What MPRGP, SMALBE and the penalty method have in common. The product Ax is
/// made once and then carried along: changes of μ and ρ update the gradient without a product. Works without
/// equalities (L = the cost itself).
///
/// A preconditioner M of A becomes (PMP + Q/ρ) of A + ρC̄ᵀC̄, Q = C̄ᵀC̄, P = I − Q, restricted to the face.
template<class Scalar, class MV, class OP>
class BoundedLagrangian {
 public:
  using ProblemType = Problem<Scalar, MV, OP>;
  using Iteration = MprgpIteration<Scalar, MV>;

  /// Estimates ‖A‖ unless the problem knows it, which counts as setup, or exchange() is to tell it.
  BoundedLagrangian(const ProblemType& problem, EqualityRows<Scalar, MV, OP>& rows,
                    const MprgpOptions& options, Counters& counters, bool resumes = false);

  /// Takes the projected initial guess and the multiplier; a product with A only if the guess is not zero.
  void start(double penalty);

  /// Iterate, multiplier and all that belongs to them. Reading takes the place of start(), without a product.
  void exchange(StateArchive<MV>& archive);

  /// Residuals of the current iterate.
  IterationState<MV> evaluate(int outer, int inner);

  typename Iteration::Outcome step() {
    direct_ = false;
    return iteration_->step();
  }

  /// Recomputes the gradient, as Ax − b + C̄ᵀμ⁺ with the μ⁺ = μ + ρr of storeMultiplier(), when the rounding
  /// errors that may have gathered in it exceed a tenth of the norm.
  /// @return whether it did; the state is then to be evaluated anew.
  bool confirmGradient(double projectedGradient);

  /// μ ← μ + factor·ρr, then ρ ← penalty.
  void updateMultiplier(double penalty, double factor = 1.0);

  /// Gives the problem the multiplier μ + ρr that belongs to the present iterate.
  void storeMultiplier();

  /// After Outcome::Unbounded: the direction of descent without end, of norm 1, and how well it is one.
  Teuchos::RCP<MV> unboundedDirection(Certificate& certificate);

  /// L(x, μ, ρ).
  double value() const;
  /// ‖r‖ of the last evaluation, in the solvers' rows.
  double residual() const { return residual_.norm; }

  /// Level of the rounding errors in g^P and in r: nothing below it can be asked for.
  double attainableGradient() const;
  double attainableEquality() const;

  double penalty() const { return penalty_; }
  double hessianNorm() const { return normA_; }
  long long active() const { return iteration_->sums().active; }
  double decrease() const { return iteration_->decrease(); }

 private:
  double augmentedNorm() const;
  void startIteration();
  void exchangeActive(StateArchive<MV>& archive);
  void updateEffectiveRhs();
  void applyHessian(const MV& x, MV& y);
  void applyPreconditioner(const MV& phi, const ActiveFace& active, MV& z);

  const ProblemType& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  MprgpOptions options_;
  Counters& counters_;
  InFacePreconditioner<Scalar, MV, OP> preconditioner_;
  Teuchos::RCP<Iteration> iteration_;
  // With its norm.
  struct Measured {
    Teuchos::RCP<MV> vector;
    double norm = 0.0;
  };
  struct Work {
    Teuchos::RCP<MV> rows, projected, removed;
  };
  Teuchos::RCP<MV> gradient_, mu_;
  Measured rhs_; // that of H, see updateEffectiveRhs()
  Measured residual_;
  Work work_;
  double penalty_ = 0.0;
  double normA_ = 0.0;
  double level_ = 0.0;  // largest attainableGradient() since the gradient was computed directly
  bool direct_ = false; // the gradient is Ax − b + C̄ᵀμ⁺ itself
};

} // namespace Harmos::qp
