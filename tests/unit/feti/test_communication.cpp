// SPDX-License-Identifier: BSD-3-Clause

/// What an iteration says to other ranks, counted at MPI itself: its calls are intercepted by the profiling
/// interface. The numbers stand in docs/dual_operator.md.

#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_TestFeti.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <mpi.h>

namespace {

long long reductions = 0, otherCollectives = 0;

} // namespace

extern "C" {
int MPI_Allreduce(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  ++reductions;
  return PMPI_Allreduce(send, receive, count, type, op, comm);
}
int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  ++otherCollectives;
  return PMPI_Bcast(data, count, type, root, comm);
}
int MPI_Alltoall(const void* send, int sendCount, MPI_Datatype sendType, void* receive, int receiveCount,
                 MPI_Datatype receiveType, MPI_Comm comm) {
  ++otherCollectives;
  return PMPI_Alltoall(send, sendCount, sendType, receive, receiveCount, receiveType, comm);
}
int MPI_Gatherv(const void* send, int sendCount, MPI_Datatype sendType, void* receive, const int* counts,
                const int* offsets, MPI_Datatype receiveType, int root, MPI_Comm comm) {
  ++otherCollectives;
  return PMPI_Gatherv(send, sendCount, sendType, receive, counts, offsets, receiveType, root, comm);
}
}

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// A product by itself: no reduction, nothing but neighbour exchanges.
long long during(const std::function<void()>& call) {
  const long long before = reductions;
  call();
  return reductions - before;
}

struct PerStep {
  double reductions, others;
};

// Reductions of an iteration: the difference of two runs that stop after different numbers of steps.
PerStep perStep(const std::string& method, bool tied, bool preconditioned) {
  LocalInverseOptions options;
  options.keepSchur = preconditioned;
  const TestFeti feti(testModel(4, 4, tied), DirichletForm::Primal, options);
  Teuchos::RCP<const Operator> preconditioner;
  if (preconditioned)
    preconditioner = Teuchos::rcp(new DualPreconditioner(feti.system, feti.constraints, feti.inverses,
                                                         PreconditionerKind::Dirichlet,
                                                         PreconditionerScaling::Multiplicity));
  long long counts[2], others[2];
  const int steps[2] = {2, 5};
  for (int k : {0, 1}) {
    const auto lambda = Teuchos::rcp(new MultiVector(feti.dual.rhs()->getMap(), 1));
    const auto problem = Teuchos::rcp(new qp::TpetraProblem(feti.dual.hessian(), lambda, feti.dual.rhs()));
    problem->setLowerBound(feti.dual.lowerBound());
    problem->setHessianNorm(1.0);
    const auto mu = Teuchos::rcp(new MultiVector(feti.coarse.coarseMap(), 1));
    problem->setEquality(feti.dual.equalityRows(), Teuchos::rcp(new MultiVector(feti.coarse.coarseMap(), 1)),
                         mu, qp::EqualityStructure::OrthonormalInvariant);
    problem->setPreconditioner(preconditioner);
    problem->setHessianOnKernel(feti.dual.hessianOnKernel());
    EXPECT_TRUE(problem->setProblem());
    const auto list = Teuchos::parameterList();
    list->set("Maximum Iterations", steps[k]);
    list->set("Convergence Tolerance", 1e-14);
    if (std::string(method) == "PDAS")
      list->sublist("PDAS").set("Share of iterations", 1.0);
    const auto solver = qp::TpetraSolverFactory().create(method, list);
    solver->setProblem(problem);
    const long long before = reductions, othersBefore = otherCollectives;
    solver->solve();
    counts[k] = reductions - before;
    others[k] = otherCollectives - othersBefore;
  }
  return {static_cast<double>(counts[1] - counts[0]) / 3.0, static_cast<double>(others[1] - others[0]) / 3.0};
}

} // namespace

TEST(Communication, products_need_no_reduction) {
  const TestFeti feti(testModel(2, 2));
  MultiVector x(feti.constraints.rowMap(), 1), y(feti.constraints.rowMap(), 1);
  x.putScalar(1.0);
  EXPECT_EQ(during([&] { feti.dualOperator.apply(x, y); }), 0);
  EXPECT_EQ(during([&] { feti.coarse.project(x); }), 1);
  EXPECT_EQ(during([&] { feti.dual.hessian()->apply(x, y); }), 2);
}

// Of a step of PCPG: a projection after F, one of the residual, one of the preconditioned residual; two for
// scalars and one for the equality residual that is reported. PDAS has that and, now and then, another active
// set.
TEST(Communication, reductions_of_a_step) {
  struct Case {
    const char* method;
    bool tied, preconditioned;
    double least, most;
  };
  for (const Case& item :
       {Case{"PCPG", true, false, 5, 5}, {"PCPG", true, true, 6, 6}, {"PDAS", false, true, 6, 10}}) {
    const PerStep count = perStep(item.method, item.tied, item.preconditioned);
    if (testComm()->getSize() > 1) // alone, scalars are not reduced
      EXPECT_GE(count.reductions, item.least) << item.method << item.preconditioned;
    EXPECT_LE(count.reductions, item.most) << item.method << item.preconditioned;
    EXPECT_EQ(count.others, 0.0) << item.method; // nothing is gathered, nothing broadcast
  }
}
