// SPDX-License-Identifier: BSD-3-Clause

/// The dual problem solved by Belos through Stratimikos, with each of Harmos' preconditioners: the same
/// displacements as by FetiSolver, and fewer iterations than without.

#include "Harmos_DualPipeline.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FetiPreconditioner.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <Thyra_LinearOpWithSolveFactoryHelpers.hpp>
#include <Thyra_LinearOpWithSolveHelpers.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

namespace test_preconditioners {

using namespace Harmos;

namespace {

// Two tied membranes up to their dual problem.
feti::DualStages stagesOf(const TestModel& model, feti::PreconditionerKind kind, double threshold) {
  feti::DualOptions options;
  options.form = feti::DualForm::Condensed;
  options.preconditioner = kind;
  options.inverses.keepSchur = kind == feti::PreconditionerKind::Dirichlet;
  options.adaptive.threshold = threshold;
  feti::ProblemTraits traits;
  traits.usualApplications = 30;
  // What the stages keep outlives the pipeline.
  feti::DualPipeline pipeline(
      feti::SubdomainSystem(testComm(), model.subdomains, feti::DirichletForm::Primal), model.rows, options,
      traits, Log());
  return pipeline.stages();
}

struct Solved {
  int iterations = 0;
  double residual = 0.0; // relative
  feti::TornVector displacement;
};

Solved solve(const Teuchos::RCP<const feti::DualSystem>& system, const std::string& type) {
  Stratimikos::DefaultLinearSolverBuilder builder;
  enableHarmosPreconditioner(builder);
  const auto list = Teuchos::parameterList();
  list->set("Linear Solver Type", "Belos");
  list->set("Preconditioner Type", type.empty() ? "None" : "Harmos FETI");
  if (!type.empty())
    list->sublist("Preconditioner Types").sublist("Harmos FETI").set("Type", type);
  Teuchos::ParameterList& belos = list->sublist("Linear Solver Types").sublist("Belos");
  belos.set("Solver Type", "Pseudo Block CG");
  belos.sublist("Solver Types").sublist("Pseudo Block CG").set("Convergence Tolerance", 1e-11);
  belos.sublist("Solver Types").sublist("Pseudo Block CG").set("Maximum Iterations", 400);
  builder.setParameterList(list);
  const auto factory = Thyra::createLinearSolveStrategy(builder);
  const auto op = Thyra::createConstLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>(system);
  const auto solver = Thyra::linearOpWithSolve(*factory, op);
  const auto lambda = Teuchos::rcp(new MultiVector(system->getDomainMap(), 1));
  const auto b = Thyra::createConstMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(system->rhs(),
                                                                                          solver->range());
  const auto x =
      Thyra::createMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(lambda, solver->domain());
  const Thyra::SolveStatus<double> status = Thyra::solve(*solver, Thyra::NOTRANS, *b, x.ptr());
  EXPECT_EQ(status.solveStatus, Thyra::SOLVE_STATUS_CONVERGED) << type << ": " << status.message;
  Solved result;
  if (!status.extraParameters.is_null())
    result.iterations = status.extraParameters->get<int>("Belos/Iteration Count");
  MultiVector r(lambda->getMap(), 1);
  system->apply(*lambda, r);
  r.update(1.0, *system->rhs(), -1.0);
  result.residual = r.getVector(0)->norm2() / system->rhs()->getVector(0)->norm2();
  result.displacement = system->recover(*lambda).displacement;
  return result;
}

} // namespace

TEST(FetiPreconditioner, the_same_displacements_in_fewer_iterations) {
  const TestModel model = testModel(3, 8, true);
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  ASSERT_TRUE(reference.solvable);
  const auto plain =
      Teuchos::rcp(new feti::DualSystem(stagesOf(model, feti::PreconditionerKind::Dirichlet, 10.0)));
  const auto vectors =
      Teuchos::rcp(new feti::DualSystem(stagesOf(model, feti::PreconditionerKind::Dirichlet, 1.0)));
  const Solved none = solve(plain, ""), dirichlet = solve(plain, "Dirichlet"),
               lumped = solve(plain, "lumped"), deflated = solve(vectors, "deflation");
  for (const Solved* solved : {&none, &dirichlet, &lumped, &deflated}) {
    // The residual of CG without a preconditioner; with one ten times as much is what norms explain.
    EXPECT_LE(solved->residual, 1e-10);
    // The dual problem is known to a condition of some hundred, and 1e-10 of it.
    EXPECT_LE(deviation(reference, solved->displacement, reference.force, reference.energy).displacement,
              1e-7);
  }
  EXPECT_LT(lumped.iterations, none.iterations);
  EXPECT_LT(dirichlet.iterations, lumped.iterations);
  EXPECT_LT(deflated.iterations, dirichlet.iterations);
}

TEST(FetiPreconditioner, what_is_rejected) {
  const TestModel contact = testModel(2, 2);
  EXPECT_NE(inputErrorOf([&] {
              feti::DualSystem(stagesOf(contact, feti::PreconditionerKind::Dirichlet, 10.0));
            }).find("no linear system"),
            std::string::npos);
  const TestModel tied = testModel(2, 2, true);
  const feti::DualSystem without(stagesOf(tied, feti::PreconditionerKind::None, 10.0));
  EXPECT_NE(inputErrorOf([&] {
              without.preconditioner(feti::DualSystem::Preconditioner::Deflation,
                                     feti::PreconditionerScaling::Multiplicity);
            }).find("needs a preconditioner"),
            std::string::npos);
  const feti::DualSystem stiff(stagesOf(tied, feti::PreconditionerKind::Dirichlet, 1e6));
  EXPECT_NE(inputErrorOf([&] {
              stiff.preconditioner(feti::DualSystem::Preconditioner::Deflation,
                                   feti::PreconditionerScaling::Multiplicity);
            }).find("no adaptive coarse vector"),
            std::string::npos);
}

} // namespace test_preconditioners
