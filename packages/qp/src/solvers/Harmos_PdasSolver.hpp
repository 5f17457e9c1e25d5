// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverManager.hpp"

namespace Harmos::qp {

/// "PDAS": the primal-dual active set method (a semismooth Newton method; Hintermüller, Ito, Kunisch, SIAM J.
/// Optim. 13, 2002) with projected conjugate gradients inside, see ProjectedCg.
///
/// For a guess of the active set, the equality-constrained problem with these entries held at their bounds is
/// solved, from the solution of the last guess; entries whose multiplier has the wrong sign are freed, free
/// ones beyond their bound become active. Until the set settles, the inner residual is only reduced by
/// "Inner reduction"; an iterate is accepted as soon as its projection onto the bounds passes the convergence
/// test. Superlinear near the solution, and mesh-independent from a good initial guess: the sign of its
/// gradient tells the first active set.
///
/// There is no global convergence theory: when a set comes back, when the equalities cannot be met on a face,
/// when A is singular there, when conjugate gradients take twice its dimension, when there were too many
/// guesses, or when the share of the iterations is used up that is meant for it, MPRGP or SMALBE takes over
/// from the present iterate (counters: safeguards) and has the rest of the iterations.
///
/// Needs orthonormal rows (made so if they are few). With equalities the dense C_FC_Fᵀ is factored for each
/// guess, at a product with C and Cᵀ a row.
///
/// Guarded by tests/unit/qp/test_pdas_budget.cpp, tests/unit/qp/test_random_problems.cpp and
/// tests/verification/test_obstacle.cpp.
template<class Scalar, class MV, class OP>
class PdasSolver : public SolverManager<Scalar, MV, OP> {
 public:
  std::string name() const override { return "PDAS"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  static const ParameterSpec& spec();
  /// The list "PDAS" alone.
  static ParameterSpec methodSpec();

 protected:
  void doSolve() override;

 private:
  void fallBack(const std::string& why);
};

} // namespace Harmos::qp
