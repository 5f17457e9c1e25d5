// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Globalization.hpp"
#include "Harmos_SolverManager.hpp"

#include <string>

namespace Harmos::qp {

/// "PDAS": the primal-dual active set method, a semismooth Newton method (Hintermüller, Ito, Kunisch, SIAM J.
/// Optim. 13, 2002), with Krylov methods inside (FaceSolver).
///
/// At an iterate each nonsmooth term gives a piece of the face (NonsmoothBlock): what it holds, along which
/// tangent it moves, which curvature it has. The linear problem on the face is solved from the solution of
/// the last one; then the face is brought up to date. Until it settles, the inner residual is only reduced by
/// "Inner reduction"; an iterate is accepted as soon as its projection onto the sets passes the convergence
/// test. Superlinear near the solution, and mesh-independent from a good initial guess (FirstFace).
///
/// Far from the solution faces may wander: Globalization has the strategies against that. Where they are at
/// their end it gives up, with the best iterate (SolverManager::giveUp()); so it does when conjugate
/// gradients take twice the dimension of a face, when there were too many faces, or, with a successor, when
/// its share of the iterations is used up.
///
/// Needs orthonormal rows (made so if they are few). With equalities the dense C_FC_Fᵀ is factored for each
/// face, at a product with C and Cᵀ a row.
///
/// Guarded by tests/unit/qp/test_pdas_budget.cpp, tests/unit/qp/test_random_problems.cpp and
/// tests/verification/test_obstacle.cpp.
template<class Scalar, class MV, class OP>
class PdasSolver : public SolverManager<Scalar, MV, OP> {
 public:
  std::string name() const override { return "PDAS"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  bool letsLimitsFollow() const override { return true; }
  bool takesAllBlocks() const override { return true; }
  static const ParameterSpec& spec();
  /// The list "PDAS" alone.
  static ParameterSpec methodSpec();

 protected:
  void doSolve() override;

 private:
  class Run;
  NewtonOptions options() const;
};

/// One solution of a problem, from the first face to the answer, or to where it gives up:
///
///     begin() → enterFace() → follow() → update() ┬→ isCandidate(), confirmAnswer() → the end
///                   ↑            ↑                ├→ settled: follow() to the end
///                   └────────────┴────────────────┴→ another face: goOn()
template<class Scalar, class MV, class OP>
class PdasSolver<Scalar, MV, OP>::Run {
 public:
  Run(PdasSolver& solver, EqualityRows<Scalar, MV, OP>& rows);
  void go();

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Terms = BlockOps<Scalar, MV>;
  using State = NewtonState<Scalar, MV, OP>;
  using Outcome = typename FaceSolver<Scalar, MV, OP>::Outcome;

  // Where a step leads: to the next one; to another face; to the end, for the reason that the solver has.
  enum class Next { GoOn, NewFace, Stopped };

  // How far the present face was followed, and is to be.
  struct OnFace {
    double target = 0.0; // of the residual
    long long steps = 0;
    bool isStepped = false, isStarted = false, isResumed = false;
  };

  // The steps, in their order.
  void begin();
  void describeState();
  Next enterFace();
  void aim();
  Next follow();
  bool isFarEnough() const;
  bool isInterrupted();
  Next advance();
  void update();
  void keepBest();
  bool isExhausted() const;
  bool isCandidate();
  double expectedAt(double stiffness) const;
  bool confirmAnswer();
  Next goOn();

  IterationState<MV> evaluate(double gradientNorm, int inner);
  IterationState<MV> measure(int inner, bool feasible);
  Next giveUp(const std::string& why);
  bool isInfeasible();
  Next otherWay(Trouble trouble, const std::string& why);

  PdasSolver& solver_;
  State state_;
  Globalization<Scalar, MV, OP> ways_;
  ActiveFace before_; // the face that x was found on
  OnFace onFace_;
  bool settled_ = false; // the last update changed nothing
  bool isMoved_ = false; // x, since then
  int inner_;
};

} // namespace Harmos::qp
