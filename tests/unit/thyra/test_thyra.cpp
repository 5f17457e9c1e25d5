// SPDX-License-Identifier: BSD-3-Clause

/// FETI behind Stratimikos: a tolerance that is met by the true residual, reuse, columns, refusals.

#include "Harmos_Errors.hpp"
#include "Harmos_SubdomainInput.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_Thyra.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Thyra_LinearOpWithSolveFactoryHelpers.hpp>
#include <Thyra_LinearOpWithSolveHelpers.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

namespace test_thyra {

using namespace Harmos;

namespace {

// A membrane on s × s squares of n × n bilinear elements, held at its left side.
std::vector<feti::Subdomain> membrane(int s, int n, double stiffness = 1.0) {
  const auto comm = testComm();
  const int m = n + 1;
  const double diagonal = 2.0 / 3.0, edge = -1.0 / 6.0, corner = -1.0 / 3.0;
  std::vector<MatrixEntry> entries;
  for (int cy = 0; cy < n; ++cy)
    for (int cx = 0; cx < n; ++cx) {
      const int nodes[4] = {cy * m + cx, cy * m + cx + 1, (cy + 1) * m + cx + 1, (cy + 1) * m + cx};
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          entries.push_back({nodes[i], nodes[j],
                             stiffness * (i == j             ? diagonal
                                          : (i + j) % 2 == 1 ? edge
                                                             : corner)});
    }
  const auto matrix = std::make_shared<const LocalMatrix>(makeLocalMatrix(m * m, entries));
  std::vector<feti::Subdomain> result;
  for (int p = comm->getRank(); p < s * s; p += comm->getSize()) {
    std::vector<long long> dofs;
    std::vector<feti::FixedDof> fixed;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) {
        if (p % s == 0 && i == 0)
          fixed.push_back({static_cast<int>(dofs.size()), 0.0});
        dofs.push_back(1000LL * (p / s * n + j) + p % s * n + i);
      }
    result.push_back(feti::makeSubdomain(p, matrix, std::vector<double>(static_cast<std::size_t>(m * m), 0.0),
                                         dofs, feti::constantKernel(m * m), fixed));
  }
  return result;
}

Teuchos::RCP<const Thyra::LinearOpBase<double>> wrapped(const Teuchos::RCP<const feti::TornOperator>& op) {
  return Thyra::createConstLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>(op);
}

Teuchos::RCP<Thyra::LinearOpWithSolveFactoryBase<double>> factory(double tolerance = 1e-4) {
  Stratimikos::DefaultLinearSolverBuilder builder;
  enableHarmos(builder);
  const auto list = Teuchos::parameterList();
  list->set("Linear Solver Type", "Harmos FETI");
  list->set("Preconditioner Type", "None");
  list->sublist("Linear Solver Types").sublist("Harmos FETI").sublist("Solver").set("Tolerance", tolerance);
  builder.setParameterList(list);
  return Thyra::createLinearSolveStrategy(builder);
}

struct System {
  explicit System(std::vector<feti::Subdomain> subdomains, std::size_t columns = 1)
      : op(Teuchos::rcp(new feti::TornOperator(testComm(), std::move(subdomains)))),
        b(Teuchos::rcp(new MultiVector(op->getRangeMap(), columns))),
        x(Teuchos::rcp(new MultiVector(op->getDomainMap(), columns))) {
    // Smooth loads and edge values, different in each column.
    const auto view = b->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t k = 0; k < view.extent(0); ++k) {
      const GlobalOrdinal dof = op->getRangeMap()->getGlobalElement(static_cast<LocalOrdinal>(k));
      for (std::size_t c = 0; c < columns; ++c)
        view(k, c) = 0.01 * static_cast<double>(1 + c) + 1e-3 * static_cast<double>(dof % 1000);
    }
  }

  double residual() const {
    MultiVector r(b->getMap(), b->getNumVectors());
    op->apply(*x, r);
    r.update(1.0, *b, -1.0);
    double worst = 0.0;
    for (std::size_t c = 0; c < b->getNumVectors(); ++c)
      worst = std::max(worst, r.getVector(c)->norm2() / b->getVector(c)->norm2());
    return worst;
  }

  Teuchos::RCP<const feti::TornOperator> op;
  Teuchos::RCP<MultiVector> b, x;
};

Thyra::SolveStatus<double>
solved(const Thyra::LinearOpWithSolveBase<double>& op, const System& system,
       const Teuchos::Ptr<const Thyra::SolveCriteria<double>>& criteria = Teuchos::null) {
  const auto b =
      Thyra::createConstMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(system.b, op.range());
  const auto x = Thyra::createMultiVector<Scalar, LocalOrdinal, GlobalOrdinal, Node>(system.x, op.domain());
  return Thyra::solve(op, Thyra::NOTRANS, *b, x.ptr(), criteria);
}

} // namespace

TEST(Thyra, criteria_are_met_by_the_true_residual) {
  const System system(membrane(3, 4), 2);
  const auto op = Thyra::linearOpWithSolve(*factory(), wrapped(system.op));
  for (double wanted : {1e-3, 1e-6, 1e-10}) {
    const Thyra::SolveCriteria<double> criteria(
        Thyra::SolveMeasureType(Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS), wanted);
    const auto status = solved(*op, system, Teuchos::constPtr(criteria));
    EXPECT_EQ(status.solveStatus, Thyra::SOLVE_STATUS_CONVERGED) << status.message;
    EXPECT_LE(system.residual(), wanted);
    EXPECT_NEAR(status.achievedTol, system.residual(), 1e-3 * status.achievedTol + 1e-15);
  }
}

// The same operator object, initialised again with other values, and its answers.
TEST(Thyra, other_matrices_with_the_same_graph_are_taken_over) {
  const auto makes = factory(1e-10);
  const System first(membrane(3, 4)), second(membrane(3, 4, 5.0));
  const auto op = makes->createOp();
  Thyra::initializeOp<double>(*makes, wrapped(first.op), op.ptr());
  EXPECT_EQ(solved(*op, first).solveStatus, Thyra::SOLVE_STATUS_CONVERGED);
  EXPECT_LE(first.residual(), 1e-8);
  const auto feti = Teuchos::rcp_dynamic_cast<const FetiLinearOpWithSolve>(op);
  ASSERT_FALSE(feti.is_null());
  const feti::FactorizationCounts before = feti->solver()->factorizations();
  Thyra::initializeOp<double>(*makes, wrapped(second.op), op.ptr());
  EXPECT_EQ(solved(*op, second).solveStatus, Thyra::SOLVE_STATUS_CONVERGED);
  EXPECT_LE(second.residual(), 1e-8);
  EXPECT_EQ(feti->solver()->factorizations().analyses, before.analyses);
  EXPECT_EQ(feti->solver()->factorizations().factorizations, 2 * before.factorizations);
  // Another graph is set up anew.
  const System finer(membrane(3, 5));
  Thyra::initializeOp<double>(*makes, wrapped(finer.op), op.ptr());
  EXPECT_EQ(solved(*op, finer).solveStatus, Thyra::SOLVE_STATUS_CONVERGED);
  EXPECT_LE(finer.residual(), 1e-8);
}

// A right-hand side without a solution is a status with the reason, no exception.
TEST(Thyra, no_solution_is_a_status) {
  std::vector<feti::Subdomain> free = membrane(2, 3);
  for (feti::Subdomain& subdomain : free)
    subdomain.fixed.clear();
  const System system(std::move(free));
  const auto op = Thyra::linearOpWithSolve(*factory(), wrapped(system.op));
  const auto status = solved(*op, system);
  EXPECT_EQ(status.solveStatus, Thyra::SOLVE_STATUS_UNCONVERGED);
  EXPECT_NE(status.message.find("load"), std::string::npos) << status.message;
}

TEST(Thyra, refuses_what_it_cannot_solve_with) {
  const auto map = Teuchos::rcp(new Map(10, 0, testComm()));
  const auto assembled =
      Teuchos::rcp(new Tpetra::CrsMatrix<Scalar, LocalOrdinal, GlobalOrdinal, Node>(map, 1));
  const double one = 1.0;
  for (std::size_t k = 0; k < localSize(*map); ++k) {
    const GlobalOrdinal row = map->getGlobalElement(static_cast<LocalOrdinal>(k));
    assembled->insertGlobalValues(row, 1, &one, &row);
  }
  assembled->fillComplete();
  const auto makes = factory();
  EXPECT_THROW(Thyra::linearOpWithSolve(
                   *makes, Thyra::createConstLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>(assembled)),
               InputError);
  Stratimikos::DefaultLinearSolverBuilder builder;
  enableHarmos(builder);
  const auto list = Teuchos::parameterList();
  list->sublist("Linear Solver Types").sublist("Harmos FETI").sublist("Solver").set("Tolerence", 1e-3);
  EXPECT_ANY_THROW({
    builder.setParameterList(list);
    Thyra::createLinearSolveStrategy(builder, "Harmos FETI");
  });
}

} // namespace test_thyra
