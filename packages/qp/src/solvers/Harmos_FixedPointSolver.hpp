// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundOps.hpp"
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
/// Guarded by tests/unit/qp/test_following_limits.cpp.
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
  bool takesAllBlocks() const override { return inner_->takesAllBlocks(); }

 protected:
  void doSolve() override;

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Terms = BlockOps<Scalar, MV>;

  void begin();
  void solveFrozen();
  bool findsLimits();
  bool isAnswer();
  void relax();
  void tellContraction();
  IterationState<MV> measure();

  Teuchos::RCP<const Solver> inner_;
  Teuchos::RCP<EqualityRows<Scalar, MV, OP>> rows_;
  Teuchos::RCP<MV> radii_, step_, lastStep_; // r; f(x(r)) − r, and that before
  double share_ = 1.0;
  double wrong_ = 0.0; // ‖g^P‖ where limits have followed; 0: not known
  int updates_ = 0, retreats_ = 0;
  // The largest of what limits moved by over the time before, where they went all the way.
  double growth_ = 0.0;
};

} // namespace Harmos::qp
