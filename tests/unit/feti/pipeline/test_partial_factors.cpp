// SPDX-License-Identifier: BSD-3-Clause

/// New matrices and shapes of which some are the old ones: those keep their factors, by count, and answers
/// are those of a solver that is made for them; also after errors, when nothing is known of what was
/// factored.

#include "Harmos_ChangedModels.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

namespace test_partial_factors {

using namespace Harmos;

namespace {

constexpr double tolerance = changedTolerance;

struct Form {
  const char* form;
  const char* dirichlet;
  const char* clusters;
};
const Form forms[] = {{"condensed", "primal", "none"}, {"condensed", "dual", "none"},
                      {"implicit", "primal", "none"},  {"implicit", "dual", "none"},
                      {"condensed", "dual", "2"},      {"implicit", "primal", "2"}};

std::string textOf(const Form& f) {
  return std::string(f.form) + ", " + f.dirichlet + ", clusters " + f.clusters;
}

Teuchos::ParameterList parametersOf(const Form& f) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance);
  list.sublist("Dual operator").set("Form", std::string(f.form));
  list.sublist("Dual operator").set("Preconditioner", std::string("Dirichlet"));
  list.sublist("Decomposition").set("Dirichlet", std::string(f.dirichlet));
  list.sublist("Decomposition").set("Clusters", std::string(f.clusters));
  return list;
}

double factorizationsOf(const feti::FetiSolver& solver) {
  return globalSum(*testComm(), static_cast<double>(solver.factorizations().factorizations));
}
double analysesOf(const feti::FetiSolver& solver) {
  return globalSum(*testComm(), static_cast<double>(solver.factorizations().analyses));
}

// Of a change with analyses that are there, of so many subdomains. Each takes what one took at first.
void expectFactored(const feti::FetiSolver& solver, double before, double each, double subdomains,
                    const std::string& what) {
  EXPECT_EQ(factorizationsOf(solver) - before, each * subdomains) << what;
}

} // namespace

// One, then two others, then one of these back: as many factorisations as have changed, no analysis.
TEST(PartialFactors, of_what_changes_alone) {
  for (const Form& form : forms) {
    const TestModel model = different();
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    expectReference(model, solver, textOf(form));
    const double first = factorizationsOf(solver), analyses = analysesOf(solver), each = first / 8.0;
    const auto change = [&](const TestModel& to, double changed, const std::string& what) {
      const double before = factorizationsOf(solver);
      solver.setMatrices(matricesOf(to));
      expectReference(to, solver, textOf(form) + ", " + what);
      expectFactored(solver, before, each, changed, textOf(form) + ", " + what);
      EXPECT_EQ(analysesOf(solver), analyses) << textOf(form) << ", " << what;
    };
    const auto only = [&](std::initializer_list<long long> numbers) {
      const std::vector<long long> changed = numbers;
      return scaled(model, [changed](long long number) {
        return std::find(changed.begin(), changed.end(), number) == changed.end() ? 1.0 : 2.75;
      });
    };
    change(only({1}), 1.0, "subdomain 1");
    change(only({1}), 0.0, "the same in other objects");
    change(only({4, 6}), 3.0, "subdomains 4 and 6, and 1 back"); // of both membranes, held and floating
    change(only({4}), 1.0, "6 back");
    change(model, 1.0, "as at first");
    change(only({0, 1, 2, 3, 4, 5, 6, 7}), 8.0, "all");
  }
}

// A → B → A: the answers of A are the first ones, and those of a solver that has known A alone.
TEST(PartialFactors, there_and_back) {
  for (const Form& form : forms) {
    const TestModel a = different(), b = scaled(a, [](long long n) { return n == 5 ? 1.5 : 1.0; });
    feti::FetiSolver solver(testComm(), a.subdomains, a.rows, parametersOf(form));
    ASSERT_TRUE(solver.solve().converged);
    const feti::TornVector first = solver.displacement();
    const double energy = solver.audit().energy;
    solver.setMatrices(matricesOf(b));
    ASSERT_TRUE(solver.solve().converged);
    EXPECT_GT(std::abs(solver.audit().energy - energy), 1e-4 * std::abs(energy));
    solver.setMatrices(matricesOf(a));
    ASSERT_TRUE(solver.solve().converged);
    // Warm starts are forgotten with the matrices: the same arithmetic.
    EXPECT_EQ(solver.audit().energy, energy) << textOf(form);
    EXPECT_EQ(solver.displacement(), first) << textOf(form);
  }
}

// Classes of subdomains with one matrix that fall apart, come together, and change as one.
TEST(PartialFactors, classes_that_change) {
  const auto factors = [](double first, double others) {
    return scaled(testModel(2, 4), [=](long long number) { return number == 2 ? first : others; });
  };
  for (const Form& form : forms) {
    const TestModel model = factors(1.0, 1.0);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    expectReference(model, solver, textOf(form) + ", alike");
    int step = 0;
    for (const auto& [first, others] :
         {std::pair{2.0, 1.0}, {2.0, 3.0}, {3.0, 3.0}, {3.0 * (1.0 + 1e-14), 3.0}, {1.0, 1.0}, {1.0, 2.0}}) {
      const TestModel next = factors(first, others);
      solver.setMatrices(matricesOf(next));
      expectReference(next, solver, textOf(form) + ", step " + std::to_string(++step));
    }
  }
}

// A factorisation that fails in the midst of others: what was not reached has the factors of before, and what
// is given next is factored whatever it looks like.
TEST(PartialFactors, after_a_factorisation_that_failed) {
  for (const Form& form : forms)
    for (long long number : {0LL, 3LL, 5LL}) {
      const std::string what = textOf(form) + ", " + std::to_string(number);
      const TestModel a = different(), b = scaled(a, [](long long) { return 1.75; });
      const TestModel bad = broken(b, number);
      feti::FetiSolver solver(testComm(), a.subdomains, a.rows, parametersOf(form));
      expectReference(a, solver, what);
      EXPECT_THROW(solver.setMatrices(matricesOf(bad)), NumericalError) << what;
      EXPECT_THROW(solver.solve(), InputError) << what;
      EXPECT_THROW(solver.solveIncrement(loadsOf(a), a.rows, tolerance), InputError) << what;
      EXPECT_THROW(solver.setMatrices(matricesOf(bad)), NumericalError) << what << ", again";
      EXPECT_THROW(solver.solve(), InputError) << what;
      solver.setMatrices(matricesOf(b)); // all but one of those that were to be factored
      expectReference(b, solver, what + ", mended");
      solver.setMatrices(matricesOf(a));
      expectReference(a, solver, what + ", as at first");
    }
}

// Shapes: matrices, loads and coefficients at once; of one membrane, then of the other.
TEST(PartialFactors, shapes_with_other_rows) {
  for (const Form& form : forms) {
    const TestModel model = different();
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(form));
    expectReference(model, solver, textOf(form));
    const double first = factorizationsOf(solver), analyses = analysesOf(solver), each = first / 8.0;
    const auto change = [&](const TestModel& to, double changed, const std::string& what) {
      const double before = factorizationsOf(solver);
      solver.setShape(matricesOf(to), {}, loadsOf(to), to.rows);
      expectReference(to, solver, textOf(form) + ", " + what);
      expectFactored(solver, before, each, changed, textOf(form) + ", " + what);
      EXPECT_EQ(analysesOf(solver), analyses) << textOf(form) << ", " << what;
    };
    TestModel next = scaled(model, [](long long number) { return number < 4 ? 1.0 : 1.3; });
    for (feti::Subdomain& subdomain : next.subdomains)
      changeLoad(subdomain, [](std::vector<double>& load) {
        for (std::size_t k = 0; k < load.size(); ++k)
          load[k] *= 1.2 + 0.3 * std::sin(static_cast<double>(k));
      });
    for (ConstraintRow& row : next.rows) {
      // Longer rows, and another side of it: forces are physical all the same.
      row.bound += 0.01 * static_cast<double>(row.number % 3);
      row.terms.front().coefficient *= 1.0 + 0.1 * static_cast<double>(row.number % 2);
    }
    change(next, 4.0, "the second membrane");
    TestModel rowsAlone = next;
    for (ConstraintRow& row : rowsAlone.rows)
      for (ConstraintRow::Term& term : row.terms)
        term.coefficient *= 2.0;
    change(rowsAlone, 0.0, "rows alone");
    change(model, 4.0, "as at first");
  }
}

// What came before it is of rows that are no more.
TEST(PartialFactors, a_shape_forgets_the_answer) {
  const TestModel model = different();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(forms[0]));
  ASSERT_TRUE(solver.solve().converged);
  solver.setShape(matricesOf(model), {}, loadsOf(model), model.rows);
  EXPECT_FALSE(solver.hasSolution());
  EXPECT_TRUE(contains(inputErrorOf([&] { solver.rowForces(); }), "there is no solution yet"));
  expectReference(model, solver, "again");
}

// Rows that are refused, when the matrices are taken already: then factors are made of these all the same.
TEST(PartialFactors, after_a_shape_that_was_refused) {
  for (const Form& form : forms) {
    const TestModel a = different(), b = scaled(a, [](long long number) { return number < 4 ? 1.75 : 1.0; });
    feti::FetiSolver solver(testComm(), a.subdomains, a.rows, parametersOf(form));
    expectReference(a, solver, textOf(form));
    std::vector<ConstraintRow> bad = b.rows;
    for (ConstraintRow& row : bad)
      row.bound = std::nan("");
    EXPECT_THROW(solver.setShape(matricesOf(b), {}, loadsOf(b), bad), InputError) << textOf(form);
    EXPECT_THROW(solver.solve(), InputError) << textOf(form);
    solver.setShape(matricesOf(b), {}, loadsOf(b), b.rows);
    expectReference(b, solver, textOf(form) + ", after bad rows");
    auto loads = loadsOf(a);
    if (!loads.empty())
      loads.front() = std::make_shared<const std::vector<double>>(3, 1.0);
    EXPECT_THROW(solver.setShape(matricesOf(a), {}, loads, a.rows), InputError) << textOf(form);
    solver.setShape(matricesOf(a), {}, loadsOf(a), a.rows);
    expectReference(a, solver, textOf(form) + ", after bad loads");
  }
}

} // namespace test_partial_factors
