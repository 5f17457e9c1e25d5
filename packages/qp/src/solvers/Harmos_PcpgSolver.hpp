// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceSolver.hpp"
#include "Harmos_SolverManager.hpp"

namespace Harmos::qp {

/// "PCPG": projected conjugate gradients for equalities alone; plain conjugate gradients without them.
///
/// Works in the kernel of C with the projector P = I − CᵀC, which needs orthonormal rows (CCᵀ = I); other
/// equality rows are refused, and so are bounds. The linear FETI solver (Farhat, Mandel, Roux, Comput.
/// Methods Appl. Mech. Engrg. 115, 1994). Cost: one product with A and one projection a step.
///
/// Guarded by tests/unit/qp/test_solvers.cpp.
template<class Scalar, class MV, class OP>
class PcpgSolver : public SolverManager<Scalar, MV, OP> {
 public:
  std::string name() const override { return "PCPG"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  static const ParameterSpec& spec();

 protected:
  void doSolve() override;

 private:
  class Run;
};

/// One solution of a problem: steps of FaceSolver, until the tests are met by residuals that can be
/// believed.
template<class Scalar, class MV, class OP>
class PcpgSolver<Scalar, MV, OP>::Run {
 public:
  Run(PcpgSolver& solver, EqualityRows<Scalar, MV, OP>& rows);
  void go();

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Cg = FaceSolver<Scalar, MV, OP>;

  void begin();
  bool isConfirmed();
  bool isInterrupted();
  void look();
  bool advance();
  void stopFlat();
  IterationState<MV> evaluate(int inner);

  PcpgSolver& solver_;
  EqualityRows<Scalar, MV, OP>& rows_;
  const Problem<Scalar, MV, OP>& problem_;
  Counters& counters_;
  Cg cg_;
  int inner_;
  IterationState<MV> state_;
};

} // namespace Harmos::qp
