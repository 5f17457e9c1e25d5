// SPDX-License-Identifier: BSD-3-Clause

/// Rows that give way under their force, Bu = c + Cλ: the answers of a dense solver without domain
/// decomposition, products that do not grow with C, and rows whose force moves nothing.

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestElasticity.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace test_compliant_rows {

using namespace Harmos;

namespace {

constexpr double tolerance = 1e-10;
// ‖u − u*‖ by the condition of F, a hundred at most, and norms.
constexpr double bound = 1e3 * tolerance;

Teuchos::ParameterList parametersOf(const std::string& weights, const std::string& method = "Auto") {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance).set("Method", method);
  list.sublist("Dual operator").set("Preconditioner", "Dirichlet");
  list.sublist("Dual operator").sublist("Expert").set("Weights", weights);
  return list;
}

// Of the membranes: a unit stiffness; F of a contact row of two nodes is of the order of one.
TestModel compliant(bool tied, const std::function<double(long long)>& compliance) {
  TestModel model = testModel(3, 6, tied);
  for (ConstraintRow& row : model.rows)
    row.compliance = compliance(row.number);
  return model;
}

struct Answer {
  double error = 0.0;
  int products = 0;
};

Answer solved(const TestModel& model, const std::string& weights, const std::string& method = "Auto") {
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(weights, method));
  const feti::SolveReport& report = solver.solve();
  EXPECT_TRUE(report.converged) << weights << ": " << report.reason;
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  EXPECT_TRUE(reference.solvable);
  const Deviation off = deviation(reference, solver);
  return {off.largest(), report.result.counters.hessianApplications};
}

// 1e-6 to 1e6 along the rows, not in order.
double graded(long long row) {
  return std::pow(10.0, -6.0 + 12.0 * static_cast<double>((7 * row) % 11) / 10.0);
}

} // namespace

TEST(CompliantRows, products_do_not_grow_with_compliance) {
  for (bool tied : {true, false}) {
    const int rigid = solved(compliant(tied, [](long long) { return 0.0; }), "auto").products;
    for (double size : {1e-6, 1.0, 1e6}) {
      const Answer answer = solved(compliant(tied, [=](long long) { return size; }), "auto");
      EXPECT_LE(answer.error, bound) << "tied " << tied << ", compliance " << size;
      EXPECT_LE(answer.products, 1.25 * rigid) << "tied " << tied << ", compliance " << size;
    }
    const Answer answer = solved(compliant(tied, graded), "auto"),
                 without = solved(compliant(tied, graded), "none");
    EXPECT_LE(answer.error, bound) << "tied " << tied;
    EXPECT_LE(without.error, bound) << "tied " << tied;
    EXPECT_LE(answer.products, 1.25 * rigid) << "tied " << tied;
    // It is weights that do it.
    EXPECT_GE(without.products, 1.4 * answer.products) << "tied " << tied;
  }
}

TEST(CompliantRows, by_other_solvers) {
  for (const char* method : {"SMALBE", "PDAS"})
    EXPECT_LE(solved(compliant(false, graded), "auto", method).error, bound) << method;
}

// Between prescribed values the force is known, (Bu − c)/C, and moves nothing; what it does to its dofs is
// there.
TEST(CompliantRows, of_prescribed_values_alone) {
  for (const char* dirichlet : {"primal", "dual"}) {
    TestModel model = testModel(2, 4);
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Equality;
    row.compliance = 0.5;
    row.bound = 0.25;
    // One dof of each membrane's own Dirichlet edge, of the lowest number there is.
    long long least = std::numeric_limits<long long>::max();
    for (const feti::Subdomain& subdomain : model.subdomains)
      for (const feti::FixedDof& fixed : subdomain.fixed)
        for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
          if ((*subdomain.interface)[k] == fixed.dof)
            least = std::min(least, subdomain.numbers[k]);
    least = globalMin(*testComm(), least);
    row.terms = {{least, 2.0}};
    if (testComm()->getRank() == 0)
      model.rows.push_back(row);
    Teuchos::ParameterList list = parametersOf("auto");
    list.sublist("Decomposition").set("Dirichlet", dirichlet);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    const feti::SolveReport& report = solver.solve();
    ASSERT_TRUE(report.converged) << dirichlet << ": " << report.reason;
    // Prescribed is zero: λ = (0 − 0.25)/0.5.
    const std::vector<double> forces = solver.rowForces(); // collective
    if (testComm()->getRank() == 0)
      EXPECT_NEAR(forces.back(), -0.5, bound) << dirichlet;
    EXPECT_LE(solver.audit().gluingJump, bound) << dirichlet;
  }
}

TEST(CompliantRows, negative_or_infinite_is_refused) {
  for (double compliance :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const TestModel model = compliant(true, [=](long long number) { return number == 3 ? compliance : 0.0; });
    const std::string error = inputErrorOf(
        [&] { feti::FetiSolver(testComm(), model.subdomains, model.rows, parametersOf("auto")); });
    EXPECT_TRUE(contains(error, "constraint row 3 has a compliance of")) << error;
  }
}

} // namespace test_compliant_rows
