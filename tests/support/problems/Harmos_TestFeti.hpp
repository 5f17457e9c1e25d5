// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualProblem.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_ReplicatedCoarse.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_TestQp.hpp"

namespace Harmos {

/// All stages from torn bodies to the dual problem of the two-membrane model.
struct TestFeti {
  explicit TestFeti(const TestModel& model, feti::DirichletForm form = feti::DirichletForm::Primal,
                    const feti::LocalInverseOptions& options = {}, const feti::ClusterOptions& clusters = {})
      : system(testComm(), model.subdomains, form),
        constraints(system, model.rows),
        inverses(feti::makeLocalInverses(system, constraints, joined(options, clusters))),
        dualOperator(constraints, inverses),
        coarse(feti::motionsOf(system, inverses), constraints),
        dual(system, constraints, inverses, dualOperator, coarse) {}

  feti::SubdomainSystem system;
  feti::Constraints constraints;
  feti::LocalInverses inverses;
  feti::DualOperator dualOperator;
  feti::ReplicatedCoarse coarse;
  feti::DualProblem dual;

 private:
  feti::LocalInverseOptions joined(feti::LocalInverseOptions options,
                                   const feti::ClusterOptions& clusters) const {
    options.clusters = feti::makeClusters(system, constraints, clusters);
    return options;
  }
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
  Teuchos::RCP<MultiVector> mu;
  if (!dual.equalityRows().is_null()) {
    const Teuchos::RCP<const Map> rows = dual.equalityRows()->getRangeMap();
    mu = Teuchos::rcp(new MultiVector(rows, 1));
    problem->setEquality(dual.equalityRows(), Teuchos::rcp(new MultiVector(rows, 1)), mu,
                         qp::EqualityStructure::OrthonormalInvariant);
    problem->setFaceGram(coarse.faceGram());
  }
  problem->setProblem();
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  const auto solver = qp::TpetraSolverFactory().create("Auto", list);
  solver->setProblem(problem);
  solution.result = solver->solve();
  if (!dual.equalityRows().is_null()) {
    const auto view = mu->getLocalViewHost(Tpetra::Access::ReadOnly);
    solution.mu.assign(view.data(), view.data() + view.extent(0));
  }
  return solution;
}

} // namespace Harmos
