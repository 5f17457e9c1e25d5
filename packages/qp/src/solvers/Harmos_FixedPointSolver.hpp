// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_SolverManager.hpp"

namespace Harmos::qp {

/// Limits that follow the solution, by another solver that knows nothing of them: they stay while it solves
/// the quadratic program that they make, and follow then,
///
///     r ← r + s(f(x(r)) − r),
///
/// until the answer is one to the limits that belong to it. Where the map does not contract, s is less than
/// one (Aitken's rule for vectors: Irons, Tuck, Int. J. Numer. Meth. Engng. 1, 1969); where a program has no
/// feasible point, the step before it is halved, or forces that hold make the limits, see ConeProbe: it also
/// tells where there are none.
///
/// A solver of programs whose letsLimitsFollow() is false has a quarter of the iterations for that: PDAS,
/// which solves for limits and solution at once, takes over then, if rows can be orthonormal. So it does
/// where limits are given, but make discs, along whose rims gradient projection may creep.
///
/// For solvers whose letsLimitsFollow() is false, and where PDAS hands over. Guarded by
/// tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class FixedPointSolver : public SolverManager<Scalar, MV, OP> {
 public:
  using Solver = SolverManager<Scalar, MV, OP>;

  /// @param inner of which clones are made.
  explicit FixedPointSolver(Teuchos::RCP<const Solver> inner) : inner_(std::move(inner)) {}

  std::string name() const override { return inner_->name(); }
  Teuchos::RCP<Solver> clone() const override;
  const ParameterSpec& parameterSpec() const override { return inner_->parameterSpec(); }
  bool letsLimitsFollow() const override { return true; }
  bool takesSoftBounds() const override { return inner_->takesSoftBounds(); }

 protected:
  void doSolve() override;

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Sets = ActiveSetOps<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;

  void begin();
  void solveGiven();
  bool isBudgetSpent() const;
  Teuchos::RCP<StatusTest<MV>> budgetTest() const; // null where nothing may be handed over
  void solveFrozen();
  bool findsLimits();
  bool isAnswer();
  void relax();
  void tellContraction();
  bool mayHandOver() const;
  void handOver();
  IterationState<MV> measure();

  Teuchos::RCP<const Solver> inner_;
  Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows_;
  Teuchos::RCP<MV> radii_, step_, lastStep_; // r; f(x(r)) − r, and that before
  double share_ = 1.0;
  double wrong_ = 0.0; // ‖g^P‖ where limits have followed; 0: not known
  int updates_ = 0, retreats_ = 0;
  double growth_ =
      0.0;         // the largest of what limits moved by over the time before, where they went all the way
  int budget_ = 0; // inner iterations before PDAS takes over
};

} // namespace Harmos::qp
