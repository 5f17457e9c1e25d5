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

namespace test_mumps {

using namespace Harmos;
using feti::Mumps;
using feti::MumpsOptions;
using Symmetry = feti::MumpsOptions::Symmetry;

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

// The same, over all ranks.
Teuchos::RCP<const feti::CrsMatrix> distributedLaplacian(int n) {
  const auto map = Teuchos::rcp(new Map(n, 0, testComm()));
  const auto matrix = Teuchos::rcp(new feti::CrsMatrix(map, 3));
  for (std::size_t k = 0; k < localSize(*map); ++k) {
    const GlobalOrdinal i = map->getGlobalElement(static_cast<LocalOrdinal>(k));
    for (GlobalOrdinal j = std::max<GlobalOrdinal>(0, i - 1); j <= std::min<GlobalOrdinal>(n - 1, i + 1); ++j)
      matrix->insertGlobalValues(i, Teuchos::tuple<GlobalOrdinal>(j),
                                 Teuchos::tuple<double>(i == j ? 2.0 : -1.0));
  }
  matrix->fillComplete();
  return matrix;
}

MPI_Comm worldComm() {
  return *dynamic_cast<const Teuchos::MpiComm<int>&>(*testComm()).getRawMpiComm();
}

} // namespace

// Solution of −u″ = 1: u_i = i (n + 1 − i)/2, exact up to κε ≈ n²ε.
TEST(Mumps, each_kind_of_symmetry_on_one_rank_and_on_all) {
  const int n = 50;
  for (MPI_Comm comm : {MPI_COMM_SELF, worldComm()})
    for (Symmetry symmetry : {Symmetry::General, Symmetry::PositiveDefinite, Symmetry::Symmetric}) {
      std::vector<int> rows, columns;
      std::vector<double> values;
      laplacian(n, symmetry == Symmetry::General, rows, columns, values);
      MumpsOptions options;
      options.symmetry = symmetry;
      Mumps mumps(comm, options);
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
  Mumps mumps(MPI_COMM_SELF);
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
  MumpsOptions options;
  options.symmetry = Symmetry::General;
  Mumps mumps(MPI_COMM_SELF, options);
  try {
    mumps.analyse(3, {1, 2}, {1, 1});
    mumps.factorize({1.0, 1.0});
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("singular"), std::string::npos);
  }
}

TEST(Mumps, every_error_has_a_sentence) {
  for (int code : {-1, -2, -3, -4, -5, -6, -7, -8, -9, -10, -13, -16, -19, -22, -40, -51, -52, -90, -999})
    EXPECT_GT(Mumps::explain(code, 1).size(), 30u);
  EXPECT_NE(Mumps::explain(-999, 1).find("users' guide"), std::string::npos);
}

// Orders of elimination, and one that is handed over; single precision; compressed factors: each as accurate
// as it should be. κ = 4(n + 1)²/π² ≈ 1e3.
TEST(Mumps, orderings_precisions_and_compression) {
  const int n = 50;
  std::vector<int> rows, columns, position;
  std::vector<double> values;
  laplacian(n, false, rows, columns, values);
  const auto error = [&](const MumpsOptions& options) {
    Mumps mumps(MPI_COMM_SELF, options);
    mumps.analyse(n, rows, columns, {},
                  options.ordering == MumpsOptions::Ordering::Given ? position : std::vector<int>());
    if (position.empty())
      position = mumps.ordering();
    mumps.factorize(values);
    std::vector<double> x(static_cast<std::size_t>(n), 1.0);
    mumps.solve(x.data(), 1);
    double largest = 0.0;
    for (int i = 1; i <= n; ++i)
      largest =
          std::max(largest, std::abs(x[static_cast<std::size_t>(i - 1)] / (0.5 * i * (n + 1 - i)) - 1.0));
    return largest;
  };
  using Ordering = MumpsOptions::Ordering;
  MumpsOptions options;
  for (Ordering ordering : {Ordering::Metis, Ordering::Amd, Ordering::Amf, Ordering::Scotch, Ordering::Pord,
                            Ordering::Qamd, Ordering::Automatic, Ordering::Given}) {
    options.ordering = ordering;
    EXPECT_LT(error(options), 1e-12) << static_cast<int>(ordering);
  }
  options.precision = MumpsOptions::Precision::Single;
  EXPECT_LT(error(options), 1e-3);
  EXPECT_GT(error(options), 1e-9);
  options.precision = MumpsOptions::Precision::Double;
  options.blockLowRank = 1e-8;
  EXPECT_LT(error(options), 1e-4);
}

TEST(Mumps, a_given_order_that_is_none_is_named) {
  MumpsOptions options;
  options.ordering = MumpsOptions::Ordering::Given;
  Mumps mumps(MPI_COMM_SELF, options);
  try {
    mumps.analyse(3, {1, 2, 3}, {1, 2, 3}, {}, {1, 1, 2});
    FAIL() << "nothing was thrown";
  } catch (const InternalError& error) {
    EXPECT_NE(std::string(error.what()).find("no permutation"), std::string::npos) << error.what();
  }
}

TEST(Mumps, warnings_are_sentences) {
  EXPECT_NE(Mumps::explainWarning(1).find("out of range"), std::string::npos);
  EXPECT_NE(Mumps::explainWarning(9).find("refinement"), std::string::npos);
  MumpsOptions options;
  options.symmetry = Symmetry::General;
  Mumps mumps(MPI_COMM_SELF, options);
  mumps.analyse(2, {1, 2, 7}, {1, 2, 1}); // an entry outside of the matrix
  ASSERT_FALSE(mumps.warnings().empty());
  EXPECT_NE(mumps.warnings()[0].find("out of range"), std::string::npos);
}

// The chain condensed to its two ends: S = [1/h 1/h] with n − 1 springs in a row, without and with all ranks;
// general and symmetric. Condensing and expanding a load is solving.
TEST(Mumps, schur_complement_condenses_and_expands) {
  const int n = 21;
  for (MPI_Comm comm : {MPI_COMM_SELF, worldComm()})
    for (Symmetry symmetry : {Symmetry::General, Symmetry::PositiveDefinite, Symmetry::Symmetric}) {
      std::vector<int> rows, columns;
      std::vector<double> values;
      laplacian(n, symmetry == Symmetry::General, rows, columns, values);
      MumpsOptions options;
      options.symmetry = symmetry;
      Mumps mumps(comm, options);
      const int b0 = 4, b1 = 15; // 4 springs to the left of b0, 11 between, 5 to the right of b1
      mumps.analyse(n, rows, columns, {b1, b0});
      mumps.factorize(values);
      const std::vector<double> s = mumps.schurComplement();
      std::vector<double> x(static_cast<std::size_t>(n), 1.0), g(2), xb(2);
      mumps.condense(x.data(), g.data(), 1);
      int rank = 0;
      MPI_Comm_rank(comm, &rank);
      if (rank == 0) {
        // In the order given: b1 first. Springs in a row of m have the stiffness 1/m.
        EXPECT_NEAR(s[0], 1.0 / 6 + 1.0 / 11, 1e-13);
        EXPECT_NEAR(s[3], 1.0 / 5 + 1.0 / 11, 1e-13);
        EXPECT_NEAR(s[1], -1.0 / 11, 1e-13);
        EXPECT_NEAR(s[2], -1.0 / 11, 1e-13);
        const double det = s[0] * s[3] - s[1] * s[2];
        xb = {(s[3] * g[0] - s[2] * g[1]) / det, (s[0] * g[1] - s[1] * g[0]) / det};
      }
      mumps.expand(x.data(), xb.data(), 1);
      if (rank == 0)
        for (int i = 1; i <= n; ++i)
          EXPECT_NEAR(x[static_cast<std::size_t>(i - 1)], 0.5 * i * (n + 1 - i), 1e-11);
      // Without condensing, b is held.
      std::fill(x.begin(), x.end(), 1.0);
      mumps.solve(x.data(), 1);
      if (rank == 0) {
        EXPECT_EQ(x[static_cast<std::size_t>(b0)], 0.0);
        EXPECT_NEAR(x[0], 2.0, 1e-13); // four free nodes before b0: i(5 − i)/2
      }
    }
}

// Rows and columns of an unsymmetric Schur complement: [2 −⅓; 4 5], by hand.
TEST(Mumps, schur_complement_of_an_unsymmetric_matrix) {
  MumpsOptions options;
  options.symmetry = Symmetry::General;
  Mumps mumps(MPI_COMM_SELF, options);
  mumps.analyse(3, {1, 1, 2, 2, 3, 3}, {1, 2, 2, 3, 1, 3}, {0, 2});
  mumps.factorize({2, 1, 3, 1, 4, 5});
  const std::vector<double> s = mumps.schurComplement(), expected = {2, 4, -1.0 / 3.0, 5};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(s[k], expected[k], 1e-14) << k;
}

// Null pivots of two free chains: one each, with the threshold; none are looked for by Cholesky.
TEST(Mumps, null_pivots_are_found_with_a_threshold) {
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int part : {0, 10})
    for (int i = 1; i <= 10; ++i) {
      rows.push_back(part + i), columns.push_back(part + i), values.push_back(i == 1 || i == 10 ? 1.0 : 2.0);
      if (i > 1)
        rows.push_back(part + i), columns.push_back(part + i - 1), values.push_back(-1.0);
    }
  MumpsOptions options;
  options.symmetry = Symmetry::Symmetric;
  options.nullPivotThreshold = 1e-8;
  Mumps mumps(MPI_COMM_SELF, options);
  mumps.analyse(20, rows, columns);
  mumps.factorize(values);
  const std::vector<int> pivots = mumps.nullPivots();
  ASSERT_EQ(pivots.size(), 2u);
  EXPECT_NE(pivots[0] < 10, pivots[1] < 10);
}

// Wrong use is told, not suffered: MUMPS itself would end the process or write beyond arrays.
TEST(Mumps, misuse_is_refused) {
  const int n = 5;
  std::vector<int> rows, columns;
  std::vector<double> values;
  laplacian(n, false, rows, columns, values);
  Mumps mumps(MPI_COMM_SELF);
  EXPECT_THROW(mumps.factorize(values), InternalError);
  EXPECT_THROW(mumps.analyse(n, rows, columns, {7}), InputError);
  EXPECT_THROW(mumps.analyse(n, rows, columns, {1, 1}), InputError);
  EXPECT_THROW(mumps.analyse(n, rows, columns, {0, 1, 2, 3, 4}), InputError);
  mumps.analyse(n, rows, columns, {0, 1});
  mumps.analyse(n, rows, columns); // without Schur rows after all
  std::vector<double> x(2 * n, 1.0), reduced(4);
  EXPECT_THROW(mumps.solve(x.data(), 1), InternalError);
  std::vector<double> bad = values;
  bad[2] = std::nan("");
  EXPECT_THROW(mumps.factorize(bad), InputError);
  mumps.factorize(values);
  mumps.solve(x.data(), 1);
  EXPECT_NEAR(x[2], 4.5, 1e-14); // 3 (6 − 3)/2
  EXPECT_THROW(mumps.expand(x.data(), reduced.data(), 2), InternalError);
}

// Units: MUMPS changes pivots that are small in absolute terms, unless the matrix is scaled first.
TEST(Mumps, units_do_not_matter) {
  for (double unit : {1e-300, 1e-45, 1e-19, 1.0, 1e19, 1e45, 1e300})
    for (MumpsOptions::Precision precision :
         {MumpsOptions::Precision::Double, MumpsOptions::Precision::Single}) {
      std::vector<int> rows, columns;
      std::vector<double> values;
      laplacian(6, false, rows, columns, values);
      for (double& value : values)
        value *= unit;
      MumpsOptions options;
      options.precision = precision;
      Mumps mumps(MPI_COMM_SELF, options);
      mumps.analyse(6, rows, columns, {0, 5});
      mumps.factorize(values);
      const std::vector<double> s = mumps.schurComplement();
      const double tolerance = precision == MumpsOptions::Precision::Double ? 1e-14 : 1e-6;
      EXPECT_NEAR(s[0] / unit, 1.2, tolerance) << unit;
      EXPECT_NEAR(s[1] / unit, -0.2, tolerance) << unit;
      std::vector<double> x(6, unit), g(2), ends = {3.0, 3.0}; // u = i (7 − i)/2
      mumps.condense(x.data(), g.data(), 1);
      EXPECT_NEAR(g[0] / unit, 3.0, 10 * tolerance) << unit; // S u = g
      mumps.expand(x.data(), ends.data(), 1);
      EXPECT_NEAR(x[2], 6.0, 10 * tolerance) << unit;
    }
}

// The Amesos2 seam: a distributed Tpetra matrix on all ranks of the test.
TEST(MumpsSolver, is_an_amesos2_solver) {
  const int n = 40;
  const auto matrix = distributedLaplacian(n);
  const Teuchos::RCP<const Map> map = matrix->getRowMap();
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

// What goes beyond Amesos2's interface, on the same object: S of a matrix that is distributed over all ranks.
TEST(MumpsSolver, offers_schur_complements_and_refuses_wrong_parameters) {
  const auto comm = testComm();
  const int n = 21;
  const auto matrix = distributedLaplacian(n);
  const Teuchos::RCP<const Map> map = matrix->getRowMap();
  const auto x = Teuchos::rcp(new MultiVector(map, 1)), b = Teuchos::rcp(new MultiVector(map, 1));
  const auto solver = feti::makeMumpsSolver(matrix, x, b);
  const auto extras = Teuchos::rcp_dynamic_cast<feti::MumpsExtras>(solver, true);
  EXPECT_THROW(extras->schurComplement(), InputError); // nothing is factored
  extras->setSchurRows({10});
  solver->symbolicFactorization().numericFactorization();
  const std::vector<double> s = extras->schurComplement();
  if (comm->getRank() == 0) {
    ASSERT_EQ(s.size(), 1u);
    EXPECT_NEAR(s[0], 2.0 / 11.0, 1e-13); // eleven springs on either side
  }
  EXPECT_GT(extras->statistics().factorizationFlops, 0.0);
  EXPECT_TRUE(extras->warnings().empty());
  EXPECT_GT(solver->getStatus().getNnzLU(), 0u);
  const auto wrong = Teuchos::parameterList("Amesos2");
  wrong->sublist("Harmos MUMPS").set("Symetry", std::string("general"));
  EXPECT_THROW(solver->setParameters(wrong), std::exception);
  const auto value = Teuchos::parameterList("Amesos2");
  value->sublist("Harmos MUMPS").set("Ordering", std::string("alphabetical"));
  EXPECT_THROW(solver->setParameters(value), std::exception);
}

} // namespace test_mumps
