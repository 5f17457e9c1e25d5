// SPDX-License-Identifier: BSD-3-Clause

/// What an iteration says to other ranks, counted at MPI itself: its calls are intercepted by the profiling
/// interface. The numbers stand in docs/dual_operator.md.

#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_TestFeti.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <mpi.h>

namespace test_communication {

namespace {

struct Calls {
  long long reductions = 0, gathers = 0, others = 0;
};
Calls calls;

} // namespace

extern "C" {
int MPI_Allreduce(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  ++calls.reductions;
  return PMPI_Allreduce(send, receive, count, type, op, comm);
}
int MPI_Allgatherv(const void* send, int sendCount, MPI_Datatype sendType, void* receive, const int* counts,
                   const int* offsets, MPI_Datatype receiveType, MPI_Comm comm) {
  ++calls.gathers;
  return PMPI_Allgatherv(send, sendCount, sendType, receive, counts, offsets, receiveType, comm);
}
int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  ++calls.others;
  return PMPI_Bcast(data, count, type, root, comm);
}
int MPI_Alltoall(const void* send, int sendCount, MPI_Datatype sendType, void* receive, int receiveCount,
                 MPI_Datatype receiveType, MPI_Comm comm) {
  ++calls.others;
  return PMPI_Alltoall(send, sendCount, sendType, receive, receiveCount, receiveType, comm);
}
int MPI_Gatherv(const void* send, int sendCount, MPI_Datatype sendType, void* receive, const int* counts,
                const int* offsets, MPI_Datatype receiveType, int root, MPI_Comm comm) {
  ++calls.others;
  return PMPI_Gatherv(send, sendCount, sendType, receive, counts, offsets, receiveType, root, comm);
}
}

using namespace Harmos;
using namespace Harmos::feti;

namespace {

Calls operator-(const Calls& a, const Calls& b) {
  return {a.reductions - b.reductions, a.gathers - b.gathers, a.others - b.others};
}

Calls during(const std::function<void()>& call) {
  const Calls before = calls;
  call();
  return calls - before;
}

struct Case {
  const char* method;
  bool tied, preconditioned, distributed;
};

// The stages with either coarse space.
struct Stages {
  Stages(const Case& item, const LocalInverseOptions& options)
      : feti(testModel(4, 4, item.tied), DirichletForm::Primal, options),
        distributed(feti.system, feti.constraints, rows()),
        coarse(item.distributed ? static_cast<const CoarseSpace&>(distributed) : feti.coarse),
        dual(feti.system, feti.constraints, feti.inverses, feti.dualOperator, coarse) {
    if (item.preconditioned)
      preconditioner = Teuchos::rcp(new DualPreconditioner(feti.system, feti.constraints, feti.inverses,
                                                           PreconditionerKind::Dirichlet,
                                                           PreconditionerScaling::Multiplicity));
  }
  static CoarseOptions rows() {
    CoarseOptions options;
    options.inverse = CoarseOptions::Inverse::Rows;
    return options;
  }

  TestFeti feti;
  DistributedCoarse distributed;
  const CoarseSpace& coarse;
  DualProblem dual;
  Teuchos::RCP<const Operator> preconditioner;
};

Calls ofRun(const Case& item, const Stages& stages, int steps) {
  const DualProblem& dual = stages.dual;
  const auto lambda = Teuchos::rcp(new MultiVector(dual.rhs()->getMap(), 1));
  const auto problem = Teuchos::rcp(new qp::TpetraProblem(dual.hessian(), lambda, dual.rhs()));
  problem->setLowerBound(dual.lowerBound());
  problem->setHessianNorm(1.0);
  const Teuchos::RCP<const Map> rows = dual.equalityRows()->getRangeMap();
  problem->setEquality(dual.equalityRows(), Teuchos::rcp(new MultiVector(rows, 1)),
                       Teuchos::rcp(new MultiVector(rows, 1)), qp::EqualityStructure::OrthonormalInvariant);
  problem->setPreconditioner(stages.preconditioner);
  problem->setHessianOnKernel(dual.hessianOnKernel());
  problem->setUnprojectedHessian(dual.unprojectedHessian());
  problem->setFaceGram(stages.coarse.faceGram());
  EXPECT_TRUE(problem->setProblem());
  const auto list = Teuchos::parameterList();
  list->set("Maximum Iterations", steps);
  list->set("Convergence Tolerance", 1e-14);
  if (std::string(item.method) == "PDAS") // all of them on the first face
    list->sublist("Expert").sublist("PDAS").set("Share of iterations", 1.0).set("Inner reduction", 1e-12);
  const auto solver = qp::TpetraSolverFactory().create(item.method, list);
  solver->setProblem(problem);
  const Calls result = during([&] { solver->solve(); });
  if (!item.tied)
    EXPECT_GT(solver->solve().history.back().active, 0);
  return result;
}

} // namespace

TEST(Communication, products_need_no_reduction) {
  const TestFeti feti(testModel(2, 2));
  MultiVector x(feti.constraints.rowMap(), 1), y(feti.constraints.rowMap(), 1);
  x.putScalar(1.0);
  EXPECT_EQ(during([&] { feti.dualOperator.apply(x, y); }).reductions, 0);
  EXPECT_EQ(during([&] { feti.coarse.project(x); }).reductions, 1);
  EXPECT_EQ(during([&] { feti.dual.hessian()->apply(x, y); }).reductions, 2);
}

// A projection after F and one after the preconditioner, or of the gradient without one; scalars travel with
// them. Nothing else is gathered, and nothing broadcast. Each tenth step looks at rounding errors.
TEST(Communication, collectives_of_a_step) {
  for (const char* method : {"PCPG", "PDAS"})
    for (bool preconditioned : {false, true})
      for (bool distributed : {false, true}) {
        const bool isLinear = std::string(method) == "PCPG";
        const Case item = {method, isLinear, preconditioned, distributed};
        SCOPED_TRACE(std::string(method) + (preconditioned ? ", preconditioned" : "") +
                     (distributed ? ", distributed" : ""));
        LocalInverseOptions options;
        options.keepSchur = preconditioned;
        const Stages stages(item, options);
        const Calls few = ofRun(item, stages, 2), more = ofRun(item, stages, 5);
        const Calls ofSteps = more - few;
        const bool isAlone = testComm()->getSize() == 1; // then scalars are not reduced
        EXPECT_EQ(ofSteps.gathers, distributed ? 6 : 0);
        if (!isAlone)
          EXPECT_EQ(ofSteps.reductions, distributed ? 0 : 6);
        EXPECT_EQ(ofSteps.others, 0);
      }
}

} // namespace test_communication
