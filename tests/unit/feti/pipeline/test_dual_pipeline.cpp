// SPDX-License-Identifier: BSD-3-Clause

/// What each change makes anew, by count: stages, and factorisations; and the answers after it, beside those
/// without decomposition and those of a solver that has known nothing else.

#include "Harmos_ChangedModels.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace test_dual_pipeline {

using namespace Harmos;
using Kind = ConstraintRow::Kind;

namespace {

constexpr double tolerance = changedTolerance;

struct Form {
  const char* form;
  const char* dirichlet;
  const char* clusters;
  const char* preconditioner;
};
const Form forms[] = {{"condensed", "primal", "none", "Dirichlet"}, {"condensed", "dual", "none", "none"},
                      {"implicit", "primal", "none", "lumped"},     {"implicit", "dual", "none", "Dirichlet"},
                      {"condensed", "dual", "2", "Dirichlet"},      {"implicit", "primal", "2", "Dirichlet"}};

std::string textOf(const Form& f) {
  return std::string(f.form) + ", " + f.dirichlet + ", clusters " + f.clusters + ", " + f.preconditioner;
}

Teuchos::ParameterList parametersOf(const Form& f) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance);
  list.sublist("Dual operator").set("Form", std::string(f.form));
  list.sublist("Dual operator").set("Preconditioner", std::string(f.preconditioner));
  list.sublist("Decomposition").set("Dirichlet", std::string(f.dirichlet));
  list.sublist("Decomposition").set("Clusters", std::string(f.clusters));
  return list;
}

// Of the rows of all ranks those that are kept, numbered without gaps.
std::vector<ConstraintRow> kept(const std::vector<ConstraintRow>& rows,
                                const std::function<bool(long long)>& keep,
                                const std::function<bool(long long)>& ties) {
  const long long total = globalSum(*testComm(), static_cast<long long>(rows.size()));
  std::vector<long long> number(static_cast<std::size_t>(total));
  long long inequalities = 0, equalities = 0;
  for (long long k = 0; k < total; ++k)
    if (keep(k))
      number[static_cast<std::size_t>(k)] = ties(k) ? equalities++ : inequalities++;
  std::vector<ConstraintRow> result;
  for (ConstraintRow row : rows) {
    if (!keep(row.number))
      continue;
    if (ties(row.number))
      row.kind = Kind::Equality;
    row.number = number[static_cast<std::size_t>(row.number)];
    result.push_back(row);
  }
  return result;
}

using Counts = std::vector<int>;
Counts operator-(Counts a, const Counts& b) {
  for (std::size_t k = 0; k < a.size(); ++k)
    a[k] -= b[k];
  return a;
}
Counts countsOf(const feti::FetiSolver& solver) {
  const feti::StageCounts& c = solver.pipeline().counts();
  return {c.constraints, c.inverses, c.coarse, c.operators, c.problem, c.decisions};
}
long long factorizationsOf(const feti::FetiSolver& solver) {
  return globalSum(*testComm(), static_cast<long long>(solver.factorizations().factorizations));
}

// Global dofs that hold a constraint: those of rows, and those with copies.
std::set<long long> constrained(const TestModel& model, const std::vector<ConstraintRow>& rows) {
  constexpr std::size_t most = 4096;
  std::vector<double> weight(most, 0.0);
  for (const feti::Subdomain& subdomain : model.subdomains)
    for (long long dof : subdomain.numbers)
      weight.at(static_cast<std::size_t>(dof)) += 1.0;
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      weight.at(static_cast<std::size_t>(term.dof)) += 2.0;
  globalSum(*testComm(), weight);
  std::set<long long> result;
  for (std::size_t dof = 0; dof < most; ++dof)
    if (weight[dof] > 1.5)
      result.insert(static_cast<long long>(dof));
  return result;
}

// Subdomains of all ranks of which other dofs hold constraints; by what the subdomains are given alone.
long long touchedAnew(const TestModel& model, const std::vector<ConstraintRow>& before,
                      const std::vector<ConstraintRow>& after) {
  const std::set<long long> a = constrained(model, before), b = constrained(model, after);
  const auto isChanged = [&](const feti::Subdomain& subdomain) {
    return std::any_of(subdomain.numbers.begin(), subdomain.numbers.end(),
                       [&](long long dof) { return a.count(dof) != b.count(dof); });
  };
  return globalSum(*testComm(), static_cast<long long>(std::count_if(model.subdomains.begin(),
                                                                     model.subdomains.end(), isChanged)));
}

const auto nothing = [](long long) { return false; };
const auto everything = [](long long) { return true; };

} // namespace

// Constraints, inverses, coarse space, operators, problem, decisions: the table of DualPipeline.
TEST(DualPipeline, what_each_change_makes_anew) {
  for (const Form& form : forms) {
    TestModel model = different();
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    EXPECT_EQ(countsOf(solver), (Counts{1, 1, 1, 1, 0, 1})) << textOf(form);
    expectReference(model, solver, textOf(form));
    const long long each = factorizationsOf(solver) / 8;
    const auto expectChange = [&](const std::string& name, const Counts& expected, long long factorised,
                                  const std::function<void()>& change) {
      const std::string what = textOf(form) + ", " + name;
      const Counts before = countsOf(solver);
      const long long factorizations = factorizationsOf(solver);
      change();
      expectReference(model, solver, what);
      EXPECT_EQ(countsOf(solver) - before, expected) << what;
      EXPECT_EQ(factorizationsOf(solver) - factorizations, each * factorised) << what;
    };
    expectChange("nothing", {0, 0, 0, 0, 0, 0}, 0, [] {});
    expectChange("loads", {0, 0, 0, 0, 1, 0}, 0, [&] {
      for (feti::Subdomain& subdomain : model.subdomains)
        changeLoad(subdomain, [](std::vector<double>& load) { load.at(3) *= 1.5; });
      solver.setLoads(loadsOf(model));
    });
    expectChange("bounds", {0, 0, 0, 0, 1, 0}, 0, [&] {
      for (ConstraintRow& row : model.rows)
        row.bound += 0.01;
      solver.setBounds(model.rows);
    });
    expectChange("prescribed values", {0, 0, 0, 0, 1, 0}, 0, [&] {
      std::vector<std::vector<double>> values;
      for (feti::Subdomain& subdomain : model.subdomains) {
        values.emplace_back();
        for (feti::FixedDof& fixed : subdomain.fixed)
          values.back().push_back(fixed.value = 0.02);
      }
      solver.setPrescribed(values);
    });
    expectChange("matrices of one", {0, 1, 1, 1, 1, 0}, 1, [&] {
      model = scaled(model, [](long long number) { return number == 3 ? 1.5 : 1.0; });
      solver.setMatrices(matricesOf(model));
    });
    expectChange("the same rows", {1, 1, 1, 1, 1, 0}, 0, [&] { solver.setRows(model.rows); });
    expectChange("shape", {1, 1, 1, 1, 1, 0}, 2, [&] {
      model = scaled(model, [](long long number) { return number == 2 || number == 6 ? 1.2 : 1.0; });
      for (ConstraintRow& row : model.rows)
        row.bound *= 0.9;
      solver.setShape(matricesOf(model), {}, loadsOf(model), model.rows);
    });
    const std::vector<ConstraintRow> all = model.rows,
                                     half = kept(
                                         all, [](long long k) { return k % 2 == 0; }, nothing);
    const long long touched = touchedAnew(model, all, half);
    EXPECT_GT(touched, 0);
    EXPECT_LT(touched, 8);
    expectChange("every other row", {1, 1, 1, 1, 1, 0}, touched, [&] {
      model.rows = half;
      solver.setRows(half);
    });
  }
}

// Subdomains that had one matrix and have not any more: form and preconditioner are decided anew.
TEST(DualPipeline, classes_that_fall_apart_are_decided_on_anew) {
  if (testComm()->getSize() > 2)
    GTEST_SKIP() << "on more than two ranks none has two subdomains of one matrix";
  for (const Form& form : forms) {
    TestModel model = testModel(2, 4);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    expectReference(model, solver, textOf(form));
    const Counts before = countsOf(solver);
    model = scaled(model, [](long long number) { return number == 2 ? 2.0 : 1.0; });
    solver.setMatrices(matricesOf(model));
    EXPECT_EQ(countsOf(solver) - before, (Counts{0, 1, 1, 1, 0, 1})) << textOf(form);
    expectReference(model, solver, textOf(form) + ", one of them other");
  }
}

// To the last bit on one rank and two; on more the sums of shared rows have an order that depends on the rows
// before, and answers differ by rounding errors of the solver: 3e-12 at most.
void expectEqual(const std::vector<double>& a, const std::vector<double>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  const double most = testComm()->getSize() > 2 ? 0.1 * tolerance : 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_LE(std::abs(a[k] - b[k]), most) << what << ", " << k;
}

// Rows that come, go, and become others: answers are those of a solver that has known them alone.
TEST(DualPipeline, contacts_that_come_and_go) {
  for (const Form& form : forms) {
    TestModel model = different();
    const std::vector<ConstraintRow> all = model.rows;
    feti::FetiSolver solver(testComm(), model.subdomains, all, parametersOf(form));
    expectReference(model, solver, textOf(form));
    const auto third = [](long long k) { return k % 3 == 0; };
    const auto low = [](long long k) { return k < 4; };
    int step = 0;
    for (const std::vector<ConstraintRow>& rows :
         {kept(all, low, nothing), kept(all, everything, nothing), kept(all, third, low),
          kept(all, low, everything), kept(all, everything, low), all}) {
      const std::string what = textOf(form) + ", step " + std::to_string(++step);
      model.rows = rows;
      solver.setRows(rows);
      EXPECT_FALSE(solver.hasSolution()) << what;
      expectReference(model, solver, what);
      feti::FetiSolver fresh(testComm(), model.subdomains, rows, parametersOf(form));
      ASSERT_TRUE(fresh.solve().converged) << what;
      for (std::size_t i = 0; i < model.subdomains.size(); ++i)
        expectEqual(solver.displacement()[i], fresh.displacement()[i], what);
      expectEqual(solver.rowForces(), fresh.rowForces(), what);
    }
  }
}

// Rows that do not fit the subdomains leave a solver that waits for others.
TEST(DualPipeline, after_rows_that_were_rejected) {
  TestModel model = different();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(forms[0]));
  std::vector<ConstraintRow> rows = model.rows;
  for (ConstraintRow& row : rows)
    row.terms.front().dof = 1000000;
  EXPECT_THROW(solver.setRows(rows), InputError);
  EXPECT_NE(inputErrorOf([&] { solver.solve(); }).find("setRows() failed"), std::string::npos);
  solver.setRows(model.rows);
  expectReference(model, solver, "after rejected rows");
}

// What was handed out stays valid: F of the rows of before, with clusters too, after each change.
TEST(DualPipeline, operators_that_are_kept) {
  for (const Form& form : forms) {
    const TestModel model = different();
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    const Teuchos::RCP<const feti::DualOperator> f = solver.dualOperator();
    MultiVector x(f->getDomainMap(), 1), before(f->getRangeMap(), 1), after(f->getRangeMap(), 1);
    x.randomize();
    f->apply(x, before);
    solver.setRows(kept(
        model.rows, [](long long k) { return k % 2 == 0; }, nothing));
    f->apply(x, after);
    after.update(-1.0, before, 1.0);
    std::vector<double> norm(1);
    after.norm2(Teuchos::arrayViewFromVector(norm));
    EXPECT_EQ(norm[0], 0.0) << textOf(form);
    // Of inverses that are factored anew: any numbers, and no fault.
    solver.setMatrices(matricesOf(scaled(model, [](long long) { return 2.0; })));
    f->apply(x, after);
    f->rethrowFailure();
  }
}

// A refused change as a whole leaves what was there; one that fails in its midst does not forget decisions.
TEST(DualPipeline, after_changes_that_fail) {
  const TestModel model = different();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(forms[0]));
  ASSERT_TRUE(solver.solve().converged);
  const feti::TornVector u = solver.displacement();
  std::vector<std::shared_ptr<const LocalMatrix>> wrong = matricesOf(model);
  for (std::shared_ptr<const LocalMatrix>& matrix : wrong)
    matrix = std::make_shared<const LocalMatrix>(makeLocalMatrix(2, {{0, 0, 1.0}, {1, 1, 1.0}}));
  EXPECT_THROW(solver.setShape(wrong, {}, loadsOf(model), model.rows), InputError);
  EXPECT_EQ(solver.displacement(), u);
  EXPECT_THROW(solver.setMatrices(matricesOf(broken(model, 3))), NumericalError);
  EXPECT_FALSE(solver.pipeline().isComplete());
  solver.setMatrices(matricesOf(model));
  EXPECT_EQ(solver.pipeline().counts().decisions, 1);
  expectReference(model, solver, "after a failed factorisation");
}

// Their condensed inverses are by Harmos' own solver where the chosen one has no Schur complements.
TEST(DualPipeline, adaptive_vectors_with_a_solver_of_amesos) {
  const TestModel model = different();
  Teuchos::ParameterList list = parametersOf({"implicit", "primal", "none", "Dirichlet"});
  list.sublist("Dual operator").set("Local solver", std::string("KLU2"));
  list.sublist("Dual operator").set("Precision", std::string("double"));
  list.sublist("Dual operator")
      .sublist("Expert")
      .set("Adaptive coarse vectors", std::string("all"))
      .set("Adaptive threshold", 1.0);
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
  expectReference(model, solver, "KLU2");
  EXPECT_GT(solver.report().adaptiveVectors, 0);
}

} // namespace test_dual_pipeline
