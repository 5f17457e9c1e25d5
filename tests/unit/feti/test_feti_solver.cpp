// SPDX-License-Identifier: BSD-3-Clause

/// A torn problem by its facade: the same answers as without domain decomposition, what changes cost, and
/// input that is refused.

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_SubdomainInput.hpp"
#include "Harmos_TestModel.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace test_feti_solver {

using namespace Harmos;

namespace {

constexpr double tolerance = 1e-10;
// ‖u − u*‖ by the condition of these F, a hundred at most, and norms.
constexpr double bound = 1e3 * tolerance;

Teuchos::ParameterList parametersOf(const std::string& form,
                                    const std::string& preconditioner = "Dirichlet") {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance);
  list.sublist("Dual operator").set("Form", form).set("Preconditioner", preconditioner);
  return list;
}

void expectReference(const TestModel& model, feti::FetiSolver& solver, const std::string& what) {
  const feti::SolveReport& report = solver.solve();
  ASSERT_TRUE(report.converged) << what << ": " << report.reason;
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  ASSERT_TRUE(reference.solvable) << what;
  const Deviation error = deviation(reference, solver);
  EXPECT_LE(error.largest(), bound) << what;
}

std::vector<std::shared_ptr<const std::vector<double>>> loadsOf(const TestModel& model) {
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  for (const feti::Subdomain& subdomain : model.subdomains)
    loads.push_back(subdomain.load);
  return loads;
}

// K_i → (1.25 + i/2)K_i by the subdomain's number modulo three: the same kernels, another answer.
TestModel stiffened(TestModel model) {
  for (feti::Subdomain& subdomain : model.subdomains) {
    auto matrix = std::make_shared<LocalMatrix>(*subdomain.stiffness);
    for (double& value : matrix->values)
      value *= 1.25 + 0.5 * static_cast<double>(subdomain.number % 3);
    subdomain.stiffness = matrix;
  }
  return model;
}

std::vector<std::shared_ptr<const LocalMatrix>> matricesOf(const TestModel& model) {
  std::vector<std::shared_ptr<const LocalMatrix>> matrices;
  for (const feti::Subdomain& subdomain : model.subdomains)
    matrices.push_back(subdomain.stiffness);
  return matrices;
}

} // namespace

// Loads, bounds and prescribed values change, the factors do not.
TEST(FetiSolver, loads_and_bounds_cost_no_factorisation) {
  for (const char* form : {"condensed", "implicit"})
    for (const char* dirichlet : {"primal", "dual"}) {
      const std::string what = std::string(form) + ", " + dirichlet;
      TestModel model = testModel(2, 4);
      Teuchos::ParameterList list = parametersOf(form);
      list.sublist("Decomposition").set("Dirichlet", dirichlet);
      feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
      expectReference(model, solver, what);
      const feti::FactorizationCounts first = solver.factorizations();

      for (feti::Subdomain& subdomain : model.subdomains)
        changeLoad(subdomain, [&](std::vector<double>& load) {
          for (std::size_t k = 0; k < load.size(); ++k)
            load[k] *= 1.5 + std::sin(static_cast<double>(k));
        });
      solver.setLoads(loadsOf(model));
      expectReference(model, solver, what + ", new loads");
      for (ConstraintRow& row : model.rows)
        row.bound += 0.01 * static_cast<double>(row.number % 3);
      solver.setBounds(model.rows);
      expectReference(model, solver, what + ", new bounds");
      std::vector<std::vector<double>> values;
      for (feti::Subdomain& subdomain : model.subdomains) {
        values.emplace_back();
        for (feti::FixedDof& fixed : subdomain.fixed)
          values.back().push_back(fixed.value = 0.02);
      }
      solver.setPrescribed(values);
      solver.setBounds(model.rows);
      expectReference(model, solver, what + ", new prescribed values");

      EXPECT_EQ(solver.factorizations().analyses, first.analyses) << what;
      EXPECT_EQ(solver.factorizations().factorizations, first.factorizations) << what;
    }
}

// New values at the same places: numerical factorisations alone, whatever is factored.
TEST(FetiSolver, matrices_with_the_same_graph_cost_no_analysis) {
  for (const char* form : {"condensed", "implicit"})
    for (const char* preconditioner : {"none", "Dirichlet"}) {
      const std::string what = std::string(form) + ", " + preconditioner;
      const TestModel first = stiffened(testModel(2, 4));
      TestModel second = stiffened(first);
      feti::FetiSolver solver(testComm(), first.subdomains, first.rows, parametersOf(form, preconditioner));
      expectReference(first, solver, what);
      const feti::FactorizationCounts before = solver.factorizations();
      solver.setMatrices(matricesOf(second));
      expectReference(second, solver, what + ", new matrices");
      const feti::FactorizationCounts after = solver.factorizations();
      EXPECT_EQ(after.analyses, before.analyses) << what;
      EXPECT_EQ(after.factorizations, 2 * before.factorizations) << what;
      solver.setMatrices(matricesOf(first));
      expectReference(first, solver, what + ", the first ones again");
    }
}

// Subdomains that shared a factorisation and have matrices of their own now: everything anew, and right.
// Of stiffness that jumps the solver finds out itself: as many products as without jumps, twice as many with
// the orthogonal projector; and new matrices with other jumps keep the rows that are there.
TEST(FetiSolver, stiffness_that_jumps) {
  const TestModel even = testModel(4, 4);
  const auto jumping = [&](double jump) {
    TestModel model = even;
    for (feti::Subdomain& subdomain : model.subdomains) {
      const auto matrix = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : matrix->values)
        value *= (subdomain.number + subdomain.number / 4) % 2 == 0 ? 1.0 : jump;
      subdomain.stiffness = matrix;
    }
    return model;
  };
  const auto productsOf = [](const TestModel& model, const std::string& weights) {
    Teuchos::ParameterList list = parametersOf("condensed");
    list.sublist("Dual operator").sublist("Expert").set("Weights", weights);
    list.sublist("Solver").sublist("Expert").sublist("PDAS").set("Kept directions", 0);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    const feti::SolveReport& report = solver.solve();
    EXPECT_TRUE(report.converged) << weights << ": " << report.reason;
    return report.result.counters.hessianApplications;
  };
  const TestModel jumps = jumping(1e4);
  const int atOne = productsOf(even, "auto"), weighted = productsOf(jumps, "auto");
  EXPECT_EQ(atOne, productsOf(even, "none"));
  EXPECT_LE(weighted, 1.5 * atOne);
  EXPECT_GE(productsOf(jumps, "none"), 2 * weighted);
  feti::FetiSolver solver(testComm(), jumps.subdomains, jumps.rows, parametersOf("condensed"));
  expectReference(jumps, solver, "jumps");
  const TestModel others = jumping(1e2);
  solver.setMatrices(matricesOf(others));
  expectReference(others, solver, "other jumps");
}

TEST(FetiSolver, congruence_that_is_lost) {
  const TestModel same = testModel(2, 4), different = stiffened(same);
  feti::FetiSolver solver(testComm(), same.subdomains, same.rows, parametersOf("condensed"));
  expectReference(same, solver, "same");
  solver.setMatrices(matricesOf(different));
  expectReference(different, solver, "different");
  solver.setMatrices(matricesOf(same));
  expectReference(same, solver, "same again");
}

// The same again costs little: a product to look, some where the residual had just met the tolerance. While
// the same contacts are open, solutions are linear in the loads: of two loads that are known any combination
// near them is, up to the errors of the solutions.
TEST(FetiSolver, solutions_are_warm_starts) {
  const TestModel model = testModel(4, 4);
  Teuchos::ParameterList list = parametersOf("condensed", "none");
  list.sublist("Solver").set("Tolerance", 1e-6); // far from rounding errors
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
  const auto solved = [&](double whole, double left) {
    TestModel changed = model;
    for (feti::Subdomain& subdomain : changed.subdomains)
      changeLoad(subdomain, [&](std::vector<double>& load) {
        for (double& value : load)
          value *= whole + (subdomain.number % 4 == 0 ? left : 0.0);
      });
    solver.setLoads(loadsOf(changed));
    const feti::SolveReport& report = solver.solve();
    EXPECT_TRUE(report.converged) << report.reason;
    return report.result.counters.hessianApplications;
  };
  const int cold = solved(1.0, 0.0);
  EXPECT_LE(solved(1.0, 0.0), 0.2 * cold);
  solved(1.0, 1e-3);
  EXPECT_LE(solved(1.0, 2e-3), 0.6 * cold);
  solver.forgetSolutions();
  EXPECT_GE(solved(1.0, 2e-3), 0.8 * cold);
}

// What is refused leaves the solver as it was.
TEST(FetiSolver, refuses_what_does_not_fit) {
  const TestModel model = testModel(2, 3);
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf("condensed"));
  auto loads = loadsOf(model);
  if (!loads.empty())
    loads.front() = std::make_shared<const std::vector<double>>(3, 1.0);
  EXPECT_THROW(solver.setLoads(loads), InputError);
  const TestModel finer = testModel(2, 4);
  EXPECT_THROW(solver.setMatrices(matricesOf(finer)), InputError);
  std::vector<ConstraintRow> rows = model.rows;
  for (ConstraintRow& row : rows)
    row.terms.front().coefficient *= 1.1;
  EXPECT_THROW(solver.setBounds(rows), InputError);
  expectReference(model, solver, "after refusals");

  Teuchos::ParameterList unknown;
  unknown.sublist("Solver").set("Tolerence", 1e-3);
  EXPECT_THROW(feti::FetiSolver(testComm(), model.subdomains, model.rows, unknown), InputError);
}

// A matrix that has its graph and kernel and is indefinite: an error on all ranks, then none of the old
// factors is used, and good matrices make the solver whole again.
TEST(FetiSolver, matrices_that_cannot_be_factored) {
  for (const char* form : {"condensed", "implicit"}) {
    const TestModel model = stiffened(testModel(2, 4));
    TestModel bad = model;
    for (feti::Subdomain& subdomain : bad.subdomains)
      if (subdomain.number == 1) { // K − 2.5aaᵀ, a = e₆ − e₇: constants stay in the kernel
        auto matrix = std::make_shared<LocalMatrix>(*subdomain.stiffness);
        for (const auto& [i, j, value] : {std::tuple{6, 6, -1.0}, {6, 7, 1.0}, {7, 6, 1.0}, {7, 7, -1.0}})
          for (std::size_t k = matrix->offsets[static_cast<std::size_t>(i)];
               k < matrix->offsets[static_cast<std::size_t>(i) + 1]; ++k)
            if (matrix->columns[k] == j)
              matrix->values[k] += 2.5 * value;
        subdomain.stiffness = matrix;
      }
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    expectReference(model, solver, form);
    EXPECT_THROW(solver.setMatrices(matricesOf(bad)), NumericalError) << form;
    EXPECT_THROW(solver.solve(), InputError) << form;
    solver.setMatrices(matricesOf(model));
    expectReference(model, solver, std::string(form) + ", good again");
  }
}

// The second membrane, subdomains 4 to 7, is held by the contact alone.
TEST(FetiSolver, names_the_subdomains_that_nothing_holds) {
  for (const char* dirichlet : {"primal", "dual"}) {
    TestModel model = testModel(2, 4);
    for (feti::Subdomain& subdomain : model.subdomains)
      if (subdomain.number >= 4)
        changeLoad(subdomain, [](std::vector<double>& load) {
          for (double& value : load)
            value = -value;
        });
    Teuchos::ParameterList list = parametersOf("condensed");
    list.sublist("Decomposition").set("Dirichlet", dirichlet);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    const feti::SolveReport& report = solver.solve();
    EXPECT_FALSE(report.converged) << dirichlet;
    EXPECT_EQ(report.result.reason, qp::Reason::Infeasible) << dirichlet;
    EXPECT_NE(report.reason.find("; unconstrained rigid-body mode under load: subdomains 4, 5, 6, 7"),
              std::string::npos)
        << dirichlet << ": " << report.reason;
  }
}

// A limit is told as such, with the answer so far; nobody has to watch.
TEST(FetiSolver, limits_of_iterations) {
  for (const char* method : {"PDAS", "SMALBE"}) {
    const TestModel model = testModel(2, 4);
    Teuchos::ParameterList list = parametersOf("condensed");
    list.sublist("Solver").set("Maximum iterations", 2).set("Method", std::string(method));
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    EXPECT_FALSE(solver.solve().converged) << method;
    EXPECT_EQ(solver.report().result.reason, qp::Reason::IterationLimit) << solver.report().reason;
    EXPECT_TRUE(solver.hasSolution()) << method;
  }
}

TEST(FetiSolver, there_is_no_solution_before_it_is_asked_for) {
  const TestModel model = testModel(1, 2);
  const feti::FetiSolver solver(testComm(), model.subdomains, model.rows);
  EXPECT_THROW(solver.displacement(), InputError);
}

// Matrices as applications have them.
TEST(SubdomainInput, raw_rows_and_tpetra_matrices) {
  const LocalMatrix expected = makeLocalMatrix(
      3, {{0, 0, 2.0}, {0, 1, -1.0}, {1, 0, -1.0}, {1, 1, 2.0}, {1, 2, -1.0}, {2, 1, -1.0}, {2, 2, 1.0}});
  const int offsets[] = {0, 2, 5, 7}, columns[] = {1, 0, 2, 0, 1, 1, 2};
  const double values[] = {-1.0, 2.0, -1.0, -1.0, 2.0, -1.0, 1.0};
  const auto raw = feti::localMatrix(3, offsets, columns, values);
  EXPECT_EQ(raw->columns, expected.columns);
  EXPECT_EQ(raw->values, expected.values);

  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const Teuchos::Array<GlobalOrdinal> rows = Teuchos::tuple<GlobalOrdinal>(20, 7, 11); // gaps, no order
  const auto map = Teuchos::rcp(new Map(3, rows(), 0, self));
  feti::CrsMatrix matrix(map, 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = expected.offsets[i]; k < expected.offsets[i + 1]; ++k)
      matrix.insertGlobalValues(rows[static_cast<int>(i)], 1, &expected.values[k],
                                &rows[expected.columns[k]]);
  EXPECT_THROW(feti::localMatrix(matrix), InputError);
  matrix.fillComplete();
  const auto tpetra = feti::localMatrix(matrix);
  EXPECT_EQ(tpetra->columns, expected.columns);
  EXPECT_EQ(tpetra->values, expected.values);

  const int bad[] = {0, 2, 1, 7}, wide[] = {1, 0, 2, 0, 1, 1, 3};
  EXPECT_THROW(feti::localMatrix(3, bad, columns, values), InputError);
  EXPECT_THROW(feti::localMatrix(3, offsets, wide, values), InputError);
  EXPECT_THROW(feti::makeSubdomain(0, raw, {1.0, 2.0}, {1, 2, 3}, feti::constantKernel(3)), InputError);
}

// Two halves of the ranks solve problems of their own at once, with the answers of all ranks together.
TEST(FetiSolver, on_two_communicators_at_once) {
  const auto world = testComm();
  const int color = world->getRank() % 2;
  const Teuchos::RCP<const Teuchos::Comm<int>> half = world->split(color, world->getRank());
  const auto solved = [](const Teuchos::RCP<const Teuchos::Comm<int>>& comm, double factor) {
    // Eight strings in a row, held at the first end, pulled by forces at all nodes, above an obstacle.
    constexpr int pieces = 8, cells = 5;
    std::vector<feti::Subdomain> subdomains;
    for (int p = comm->getRank(); p < pieces; p += comm->getSize()) {
      std::vector<MatrixEntry> entries;
      std::vector<long long> dofs;
      for (int c = 0; c < cells; ++c)
        for (int i : {c, c + 1})
          for (int j : {c, c + 1})
            entries.push_back({i, j, i == j ? 1.0 : -1.0});
      for (int i = 0; i <= cells; ++i)
        dofs.push_back(10LL * (p * cells + i)); // gaps
      auto matrix = std::make_shared<const LocalMatrix>(makeLocalMatrix(cells + 1, entries));
      subdomains.push_back(feti::makeSubdomain(
          p, matrix, std::vector<double>(cells + 1, -factor), dofs, feti::constantKernel(cells + 1),
          p == 0 ? std::vector<feti::FixedDof>{{0, 0.0}} : std::vector<feti::FixedDof>()));
    }
    std::vector<ConstraintRow> rows;
    if (comm->getRank() == 0)
      for (int k = 0; k < pieces; ++k) {
        ConstraintRow row;
        row.kind = ConstraintRow::Kind::Inequality;
        row.number = k;
        row.terms = {{10LL * cells * (k + 1), -1.0}}; // −u ≤ 1
        row.bound = 1.0;
        rows.push_back(row);
      }
    Teuchos::ParameterList list;
    list.sublist("Solver").set("Tolerance", tolerance);
    feti::FetiSolver solver(comm, subdomains, rows, list);
    EXPECT_TRUE(solver.solve().converged);
    return solver.audit().primalEnergy;
  };
  const double mine = solved(half, 1.0 + color);
  for (int c = 0; c < 2; ++c) {
    const double alone = solved(world, 1.0 + c);
    if (c == color)
      EXPECT_NEAR(mine, alone, 1e-8 * std::abs(alone));
  }
}

} // namespace test_feti_solver
