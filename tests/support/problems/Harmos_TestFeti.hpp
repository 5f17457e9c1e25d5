// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualProblem.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_TestQp.hpp"

namespace Harmos {

/// All stages from torn bodies to the dual problem of the two-membrane model.
struct TestFeti {
  explicit TestFeti(const TestModel& model, feti::DirichletForm form = feti::DirichletForm::Primal,
                    const feti::LocalInverseOptions& options = {})
      : system(testComm(), model.subdomains, form),
        constraints(system, model.rows),
        inverses(feti::makeLocalInverses(system, constraints, options)),
        dualOperator(constraints, inverses),
        coarse(system, constraints),
        dual(system, constraints, inverses, dualOperator, coarse) {}

  feti::SubdomainSystem system;
  feti::Constraints constraints;
  feti::LocalInverses inverses;
  feti::DualOperator dualOperator;
  feti::CoarseSpace coarse;
  feti::DualProblem dual;
};

/// Options of the implicit form, which holds a kernel at so many places.
inline feti::LocalInverseOptions implicitOptions(int fixingPlaces = 4) {
  feti::LocalInverseOptions options;
  options.form = feti::DualForm::Implicit;
  options.fixingPlaces = fixingPlaces;
  return options;
}

/// λ (shifted) and μ of a dual problem by SMALBE, or PCPG without inequalities.
struct TestDualSolution {
  Teuchos::RCP<MultiVector> lambda;
  std::vector<double> mu;
  qp::Result result;
};

inline TestDualSolution solveDual(const feti::DualProblem& dual, const feti::CoarseSpace& coarse,
                                  double tolerance) {
  TestDualSolution solution;
  solution.lambda = Teuchos::rcp(new MultiVector(dual.rhs()->getMap(), 1));
  const auto problem = Teuchos::rcp(new qp::TpetraProblem(dual.hessian(), solution.lambda, dual.rhs()));
  problem->setLowerBound(dual.lowerBound());
  const auto mu = Teuchos::rcp(new MultiVector(coarse.coarseMap(), 1));
  if (!dual.equalityRows().is_null())
    problem->setEquality(dual.equalityRows(), Teuchos::rcp(new MultiVector(coarse.coarseMap(), 1)), mu,
                         qp::EqualityStructure::OrthonormalInvariant);
  problem->setProblem();
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  const auto solver = qp::TpetraSolverFactory().create("Auto", list);
  solver->setProblem(problem);
  solution.result = solver->solve();
  if (!dual.equalityRows().is_null())
    solution.mu = fromVector(*mu);
  return solution;
}

} // namespace Harmos
