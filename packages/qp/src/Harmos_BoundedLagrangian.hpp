// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AugmentedHessian.hpp"
#include "Harmos_MprgpIteration.hpp"
#include "Harmos_StatusTest.hpp"

#include <Teuchos_RCP.hpp>

namespace Harmos::qp {

/// The augmented Lagrangian of a problem over its bounds, and the minimisation of it by MPRGP.
///
///     L(x, μ, ρ) = ½xᵀAx − bᵀx + μᵀr + ½ρ‖r‖²,   r = Cx − c,   g = Ax − b + Cᵀ(μ + ρr)
///
/// What MPRGP, SMALBE and the penalty method have in common. The product Ax is made once and then carried
/// along: changes of μ and ρ update the gradient without a product. Works without equalities (L = the cost
/// itself).
template<class Scalar, class MV, class OP>
class BoundedLagrangian {
 public:
  using ProblemType = Problem<Scalar, MV, OP>;
  using Iteration = MprgpIteration<Scalar, MV>;

  /// Estimates ‖A‖ unless the problem knows it, which counts as setup.
  BoundedLagrangian(const ProblemType& problem, const MprgpOptions& options, Counters& counters);

  /// Takes the projected initial guess; a product with A only if it is not zero.
  void start(double penalty);

  /// Residuals of the current iterate.
  IterationState<MV> evaluate(int outer, int inner);

  typename Iteration::Outcome step() { return iteration_->step(); }

  /// Recomputes the gradient when the rounding errors that may have gathered in it exceed a tenth of the
  /// norm.
  /// @return whether it did; the state is then to be evaluated anew.
  bool confirmGradient(double projectedGradient);

  /// μ ← μ + ρr, then ρ ← penalty.
  void updateMultiplier(double penalty);

  /// μ ← μ + ρr, the multiplier that belongs to the last iterate; nothing else may follow.
  void finish();

  /// L(x, μ, ρ).
  double value() const;

  /// Level of the rounding errors in g^P and in r: nothing below it can be asked for.
  double attainableGradient() const;
  double attainableEquality() const;

  double penalty() const { return hessian_.penalty(); }
  double hessianNorm() const { return normA_; }
  long long active() const { return iteration_->sums().active; }

 private:
  double augmentedNorm() const;
  void updateEffectiveRhs();

  const ProblemType& problem_;
  MprgpOptions options_;
  Counters& counters_;
  AugmentedHessian<Scalar, MV, OP> hessian_;
  Teuchos::RCP<Iteration> iteration_;
  Teuchos::RCP<MV> gradient_, effectiveRhs_, work_, residual_;
  double normA_ = 0.0;
  double normRows2_ = 0.0; // ‖C‖²
};

} // namespace Harmos::qp
