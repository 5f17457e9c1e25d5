// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Mumps.hpp"
#include "Harmos_MumpsSolver.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Amesos2_Solver_decl.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <cmath>

using namespace Harmos;
using feti::Mumps;

namespace {

// The one-dimensional Laplacian of order n: tridiag(−1, 2, −1), lower triangle or whole.
void laplacian(int n, bool whole, std::vector<int>& rows, std::vector<int>& columns,
               std::vector<double>& values) {
  for (int i = 1; i <= n; ++i) {
    rows.push_back(i), columns.push_back(i), values.push_back(2.0);
    if (i > 1)
      rows.push_back(i), columns.push_back(i - 1), values.push_back(-1.0);
    if (whole && i < n)
      rows.push_back(i), columns.push_back(i + 1), values.push_back(-1.0);
  }
}

MPI_Comm worldComm() {
  return *dynamic_cast<const Teuchos::MpiComm<int>&>(*testComm()).getRawMpiComm();
}

} // namespace

// Solution of −u″ = 1: u_i = i (n + 1 − i)/2, exact up to κε ≈ n²ε.
TEST(Mumps, each_kind_of_symmetry_on_one_rank_and_on_all) {
  const int n = 50;
  for (MPI_Comm comm : {MPI_COMM_SELF, worldComm()})
    for (Mumps::Symmetry symmetry :
         {Mumps::Symmetry::General, Mumps::Symmetry::PositiveDefinite, Mumps::Symmetry::Symmetric}) {
      std::vector<int> rows, columns;
      std::vector<double> values;
      laplacian(n, symmetry == Mumps::Symmetry::General, rows, columns, values);
      Mumps mumps(comm, symmetry);
      mumps.analyse(n, rows, columns);
      mumps.factorize(values);
      EXPECT_GT(mumps.statistics().factorEntries, 0.0);
      std::vector<double> x(2 * n, 1.0); // two right-hand sides
      for (int i = 0; i < n; ++i)
        x[static_cast<std::size_t>(n + i)] = 2.0;
      mumps.solve(x.data(), 2);
      int rank = 0;
      MPI_Comm_rank(comm, &rank);
      if (rank == 0)
        for (int i = 1; i <= n; ++i) {
          const double exact = 0.5 * i * (n + 1 - i);
          EXPECT_NEAR(x[static_cast<std::size_t>(i - 1)], exact, 1e-10);
          EXPECT_NEAR(x[static_cast<std::size_t>(n + i - 1)], 2.0 * exact, 1e-10);
        }
    }
}

TEST(Mumps, indefinite_matrix_is_refused_by_cholesky_with_a_remedy) {
  Mumps mumps(MPI_COMM_SELF, Mumps::Symmetry::PositiveDefinite);
  mumps.analyse(2, {1, 2, 2}, {1, 1, 2});
  try {
    mumps.factorize({1.0, 2.0, 1.0});
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("not positive definite"), std::string::npos);
    EXPECT_EQ(error.data()[0].second, "-40");
  }
}

TEST(Mumps, structurally_singular_matrix_is_named) {
  Mumps mumps(MPI_COMM_SELF, Mumps::Symmetry::General);
  try {
    mumps.analyse(3, {1, 2}, {1, 1});
    mumps.factorize({1.0, 1.0});
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("singular"), std::string::npos);
  }
}

TEST(Mumps, every_error_has_a_sentence) {
  for (int code : {-1, -5, -6, -7, -8, -9, -10, -13, -16, -22, -40, -90, -999})
    EXPECT_GT(Mumps::explain(code, 1).size(), 30u);
  EXPECT_NE(Mumps::explain(-999, 1).find("users' guide"), std::string::npos);
}

// The Amesos2 seam: a distributed Tpetra matrix on all ranks of the test.
TEST(MumpsSolver, is_an_amesos2_solver) {
  const auto comm = testComm();
  const int n = 40;
  const auto map = Teuchos::rcp(new Map(n, 0, comm));
  const auto matrix = Teuchos::rcp(new feti::CrsMatrix(map, 3));
  for (std::size_t k = 0; k < localSize(*map); ++k) {
    const GlobalOrdinal i = map->getGlobalElement(static_cast<LocalOrdinal>(k));
    for (GlobalOrdinal j = std::max<GlobalOrdinal>(0, i - 1); j <= std::min<GlobalOrdinal>(n - 1, i + 1); ++j)
      matrix->insertGlobalValues(i, Teuchos::tuple<GlobalOrdinal>(j),
                                 Teuchos::tuple<double>(i == j ? 2.0 : -1.0));
  }
  matrix->fillComplete();
  const auto x = Teuchos::rcp(new MultiVector(map, 1)), b = Teuchos::rcp(new MultiVector(map, 1));
  b->putScalar(1.0);
  for (const char* symmetry : {"general", "positive definite", "symmetric"}) {
    const auto solver = feti::makeMumpsSolver(matrix, x, b);
    EXPECT_EQ(solver->name(), "Harmos MUMPS");
    const auto list = Teuchos::parameterList("Amesos2");
    list->sublist("Harmos MUMPS").set("Symmetry", std::string(symmetry));
    solver->setParameters(list);
    x->putScalar(0.0);
    solver->symbolicFactorization().numericFactorization().solve();
    const auto view = x->getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t k = 0; k < view.extent(0); ++k) {
      const double i = static_cast<double>(map->getGlobalElement(static_cast<LocalOrdinal>(k))) + 1.0;
      EXPECT_NEAR(view(k, 0), 0.5 * i * (n + 1 - i), 1e-10) << symmetry;
    }
  }
}
