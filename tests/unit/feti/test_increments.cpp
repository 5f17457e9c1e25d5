// SPDX-License-Identifier: BSD-3-Clause

/// How answers change: increments against the answer without decomposition of the linear problem on the face,
/// and of the one in which weak contacts decide themselves; what is solved before and after is not touched.

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_increments {

using namespace Harmos;
using Kind = ConstraintRow::Kind;
using Status = ConstraintRow::Status;
using Loads = std::vector<std::shared_ptr<const std::vector<double>>>;

namespace {

constexpr double tolerance = 1e-10;
// ‖u − u*‖ by the condition of these F, a hundred at most, and norms.
constexpr double bound = 1e3 * tolerance;

struct Setting {
  std::string form = "condensed", dirichlet = "primal", preconditioner = "Dirichlet", clusters = "none";
  std::string vectors = "auto", method = "Auto", weights = "none";
};

std::string textOf(const Setting& s) {
  return s.form + ", " + s.dirichlet + ", preconditioner " + s.preconditioner + ", clusters " + s.clusters +
         ", vectors " + s.vectors + ", " + s.method + ", weights " + s.weights;
}

Teuchos::ParameterList parametersOf(const Setting& s) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance).set("Method", s.method);
  list.sublist("Dual operator").set("Form", s.form).set("Preconditioner", s.preconditioner);
  list.sublist("Dual operator")
      .sublist("Expert")
      .set("Adaptive coarse vectors", s.vectors)
      .set("Weights", s.weights);
  list.sublist("Dual operator")
      .sublist("Expert")
      .set("Adaptive threshold", 1.0); // of such small subdomains any
  list.sublist("Decomposition").set("Dirichlet", s.dirichlet).set("Clusters", s.clusters);
  return list;
}

// Two membranes in contact; with prescribed values that an increment has not.
TestModel contactModel(int s = 2) {
  TestModel model = testModel(s, 4);
  for (feti::Subdomain& subdomain : model.subdomains)
    for (feti::FixedDof& fixed : subdomain.fixed)
      fixed.value = 0.01;
  return model;
}

// Loads of no pattern, which copies of a dof share; of the seed.
Loads loadsOf(const TestModel& model, double seed) {
  Loads loads;
  for (const feti::Subdomain& subdomain : model.subdomains) {
    std::vector<double> load;
    for (std::size_t k = 0; k < subdomain.load->size(); ++k)
      load.push_back(
          std::sin(seed + 1.7 * static_cast<double>(k) + 0.9 * static_cast<double>(subdomain.number)));
    loads.push_back(std::make_shared<const std::vector<double>>(load));
  }
  return loads;
}

// Rows as a solution has them, with bounds of a change. @param undecided every so many-th closed and open
// contact is for the problem to decide; 0: none.
std::vector<ConstraintRow> decided(const TestModel& model, const std::vector<double>& forces, int undecided) {
  std::vector<ConstraintRow> rows = model.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r].bound = 0.3 * std::sin(2.0 + static_cast<double>(rows[r].number));
    rows[r].rounding = 0.0;
    if (rows[r].kind == Kind::Inequality)
      rows[r].status = undecided > 0 && rows[r].number % undecided == 0 ? Status::Undecided
                       : forces[r] > 0.0                                ? Status::Closed
                                                                        : Status::Open;
  }
  return rows;
}

long long countOf(const std::vector<ConstraintRow>& rows, Status status) {
  return globalSum(*testComm(), static_cast<long long>(
                                    std::count_if(rows.begin(), rows.end(), [&](const ConstraintRow& row) {
                                      return row.status == status;
                                    })));
}

// The problem of an increment as one without statuses: closed contacts are equalities, open ones are left
// out.
TestModel linearised(const TestModel& model, const Loads& loads, const std::vector<ConstraintRow>& rows) {
  TestModel result = model;
  for (std::size_t i = 0; i < result.subdomains.size(); ++i) {
    result.subdomains[i].load = loads[i];
    for (feti::FixedDof& fixed : result.subdomains[i].fixed)
      fixed.value = 0.0;
  }
  result.rows.clear();
  for (ConstraintRow row : rows) {
    if (row.status == Status::Open)
      continue;
    row.kind = row.status == Status::Closed ? Kind::Equality : row.kind;
    row.status = Status::Undecided;
    result.rows.push_back(row);
  }
  for (Kind kind : {Kind::Inequality, Kind::Equality}) {
    const auto isOf = [&](const ConstraintRow& row) { return row.kind == kind; };
    long long next = exclusiveScan(
        *testComm(), static_cast<long long>(std::count_if(result.rows.begin(), result.rows.end(), isOf)));
    for (ConstraintRow& row : result.rows)
      if (isOf(row))
        row.number = next++;
  }
  return result;
}

// ‖Ku − f + Bᵀλ‖∞/‖f‖∞ of the membranes in one piece, where nothing is prescribed, and what signs of forces
// and open contacts are wrong.
double imbalance(const TestModel& model, const feti::FetiSolver::Increment& increment,
                 const std::vector<ConstraintRow>& rows) {
  long long last = 0;
  for (const feti::Subdomain& subdomain : model.subdomains)
    for (long long dof : subdomain.numbers)
      last = std::max(last, dof);
  last = globalMax(*testComm(), last);
  std::vector<double> left(static_cast<std::size_t>(last) + 1, 0.0), held = left;
  double inside = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < model.subdomains.size(); ++i) {
    const feti::Subdomain& subdomain = model.subdomains[i];
    std::vector<double> image(subdomain.load->size());
    subdomain.stiffness->multiply(increment.displacement[i].data(), image.data());
    std::vector<char> isInterface(image.size(), 0);
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
      const auto dof = static_cast<std::size_t>((*subdomain.interface)[k]);
      isInterface[dof] = 1;
      left[static_cast<std::size_t>(subdomain.numbers[k])] += image[dof] - (*subdomain.load)[dof];
    }
    for (const feti::FixedDof& fixed : subdomain.fixed)
      for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
        if ((*subdomain.interface)[k] == fixed.dof)
          held[static_cast<std::size_t>(subdomain.numbers[k])] = 1.0;
    for (std::size_t j = 0; j < image.size(); ++j) {
      largest = std::max(largest, std::abs((*subdomain.load)[j]));
      if (isInterface[j] == 0)
        inside = std::max(inside, std::abs(image[j] - (*subdomain.load)[j]));
    }
  }
  double wrong = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const ConstraintRow::Term& term : rows[r].terms)
      left[static_cast<std::size_t>(term.dof)] += term.coefficient * increment.rowForces[r];
    if (rows[r].kind == Kind::Inequality && rows[r].status != Status::Closed)
      wrong = std::max(wrong, rows[r].status == Status::Open ? std::abs(increment.rowForces[r])
                                                             : -increment.rowForces[r]);
  }
  globalSum(*testComm(), left);
  globalSum(*testComm(), held);
  for (std::size_t k = 0; k < left.size(); ++k)
    if (held[k] == 0.0)
      inside = std::max(inside, std::abs(left[k]));
  return globalMax(*testComm(), std::max(inside, wrong)) / globalMax(*testComm(), largest);
}

void expectReference(const TestModel& linear, const ReferenceSolution& reference,
                     const feti::FetiSolver::Increment& increment, const std::vector<ConstraintRow>& rows,
                     const std::string& what) {
  ASSERT_TRUE(increment.report.converged) << what << ": " << increment.report.reason;
  // Of forces and energies there is none beside the displacement's: equilibrium tells.
  const Deviation error = deviation(reference, increment.displacement, reference.force, reference.energy);
  EXPECT_LE(error.displacement, bound) << what;
  EXPECT_LE(imbalance(linear, increment, rows), bound) << what;
}

// Of the same solver, in this order.
void expectIncrements(const TestModel& model, const Setting& setting) {
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(setting));
  const feti::SolveReport& report = solver.solve();
  ASSERT_TRUE(report.converged) << textOf(setting) << ": " << report.reason;
  const std::vector<double> forces = solver.rowForces();
  const double factors = solver.factorizations().factorizations;
  for (int undecided : {0, 3}) {
    const std::vector<ConstraintRow> rows = decided(model, forces, undecided);
    // Some of each kind, or the test says little.
    ASSERT_GT(countOf(rows, Status::Closed), 0);
    ASSERT_GT(countOf(rows, Status::Open), 0);
    const Loads loads = loadsOf(model, undecided);
    const TestModel linear = linearised(model, loads, rows);
    const ReferenceSolution reference = referenceSolution(*testComm(), linear.subdomains, linear.rows);
    ASSERT_TRUE(reference.solvable);
    expectReference(linear, reference, solver.solveIncrement(loads, rows, tolerance), rows,
                    textOf(setting) + ", every so many undecided: " + std::to_string(undecided));
  }
  EXPECT_EQ(solver.factorizations().factorizations, factors) << textOf(setting);
}

} // namespace

TEST(Increments, solve_the_linear_problem_on_the_face) {
  const TestModel model = contactModel();
  for (const char* form : {"condensed", "implicit"})
    for (const char* dirichlet : {"primal", "dual"})
      for (const char* preconditioner : {"none", "lumped", "Dirichlet"}) {
        Setting setting;
        setting.form = form, setting.dirichlet = dirichlet, setting.preconditioner = preconditioner;
        expectIncrements(model, setting);
      }
}

TEST(Increments, whatever_solves_the_dual_problem) {
  const TestModel model = contactModel();
  for (const char* method : {"SMALBE", "PDAS"})
    for (const char* dirichlet : {"primal", "dual"}) {
      Setting setting;
      setting.method = method, setting.dirichlet = dirichlet;
      expectIncrements(model, setting);
    }
  Setting weighted;
  weighted.weights = "stiffness";
  expectIncrements(model, weighted);
}

// Subdomains that are joined, and vectors that are eliminated: the rows that statuses decide are not among
// those that either was made of.
TEST(Increments, with_clusters_and_adaptive_vectors) {
  const TestModel model = contactModel();
  for (const char* dirichlet : {"primal", "dual"})
    for (const char* form : {"condensed", "implicit"}) {
      Setting setting;
      setting.dirichlet = dirichlet, setting.form = form;
      setting.clusters = "2";
      expectIncrements(model, setting);
      setting.clusters = "none", setting.vectors = "all";
      expectIncrements(model, setting);
    }
  Setting setting;
  setting.vectors = "all";
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(setting));
  ASSERT_TRUE(solver.solve().converged);
  const auto rows = decided(model, solver.rowForces(), 0);
  EXPECT_GT(solver.solveIncrement(loadsOf(model, 1.0), rows, tolerance).report.adaptiveVectors, 0);
}

// To the last bit: what was found stays, and what is found next is what a solver finds that was not asked for
// increments. The other way round increments know of increments alone.
TEST(Increments, leave_solutions_alone) {
  for (const char* dirichlet : {"primal", "dual"}) {
    Setting setting;
    setting.dirichlet = dirichlet;
    const TestModel model = contactModel();
    feti::FetiSolver asked(testComm(), model.subdomains, model.rows, parametersOf(setting));
    feti::FetiSolver plain(testComm(), model.subdomains, model.rows, parametersOf(setting));
    for (int step = 0; step < 3; ++step) {
      const std::string what = std::string(dirichlet) + ", step " + std::to_string(step);
      Loads loads;
      for (const feti::Subdomain& subdomain : model.subdomains) {
        std::vector<double> load = *subdomain.load;
        for (double& value : load)
          value *= 1.0 + 0.01 * step;
        loads.push_back(std::make_shared<const std::vector<double>>(load));
      }
      asked.setLoads(loads);
      plain.setLoads(loads);
      const int products = plain.solve().result.counters.hessianApplications;
      ASSERT_TRUE(asked.solve().converged);
      EXPECT_EQ(asked.solve().converged, plain.solve().converged) << what;
      EXPECT_GT(products, 0) << what;
      const auto expectSame = [&](const std::string& when) {
        EXPECT_EQ(asked.displacement(), plain.displacement()) << what << when;
        EXPECT_EQ(asked.rowForces(), plain.rowForces()) << what << when;
        EXPECT_EQ(asked.audit().energy, plain.audit().energy) << what << when;
        EXPECT_EQ(asked.reactions(), plain.reactions()) << what << when;
      };
      expectSame(", before");
      const std::vector<ConstraintRow> rows = decided(model, asked.rowForces(), step == 1 ? 3 : 0);
      for (double seed : {1.0, 2.0})
        ASSERT_TRUE(asked.solveIncrement(loadsOf(model, seed), rows, tolerance).report.converged) << what;
      expectSame(", after");
    }
  }
}

// The same again costs a product or two to look; a combination of two that are known little more, while the
// same contacts are open. Far from rounding errors.
TEST(Increments, are_warm_starts_of_each_other) {
  Setting setting;
  setting.preconditioner = "none";
  const TestModel model = contactModel();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(setting));
  ASSERT_TRUE(solver.solve().converged);
  std::vector<ConstraintRow> rows = decided(model, solver.rowForces(), 0);
  for (ConstraintRow& row : rows)
    row.bound = 0.0;
  const auto products = [&](double first, double second) {
    const Loads a = loadsOf(model, 1.0), b = loadsOf(model, 2.0);
    Loads loads;
    for (std::size_t i = 0; i < a.size(); ++i) {
      std::vector<double> load;
      for (std::size_t k = 0; k < a[i]->size(); ++k)
        load.push_back(first * (*a[i])[k] + second * (*b[i])[k]);
      loads.push_back(std::make_shared<const std::vector<double>>(load));
    }
    const auto increment = solver.solveIncrement(loads, rows, 1e-6);
    EXPECT_TRUE(increment.report.converged) << increment.report.reason;
    return increment.report.result.counters.hessianApplications;
  };
  const int cold = products(1.0, 0.0), other = products(0.0, 1.0);
  EXPECT_LE(products(1.0, 0.0), 0.2 * cold + 3);
  EXPECT_LE(products(0.7, -0.4), 0.4 * std::max(cold, other));
}

// Rank-local input that is wrong is an error everywhere, with the row and what to do; then all is as before.
TEST(Increments, refuse_statuses_of_other_rows) {
  const auto refused = [](const TestModel& model, const std::vector<ConstraintRow>& rows,
                          const std::string& part) {
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf({}));
    ASSERT_TRUE(solver.solve().converged);
    const feti::TornVector before = solver.displacement();
    const std::string text =
        inputErrorOf([&] { solver.solveIncrement(loadsOf(model, 1.0), rows, tolerance); });
    EXPECT_TRUE(contains(text, part)) << text << "; expected: " << part;
    EXPECT_EQ(solver.displacement(), before);
    Loads loads;
    for (const feti::Subdomain& subdomain : model.subdomains)
      loads.push_back(subdomain.load);
    EXPECT_TRUE(solver.solveIncrement(loads, model.rows, tolerance).report.converged);
  };
  const TestModel contact = contactModel(), tied = testModel(2, 4, true);
  const auto with = [](TestModel model, auto&& change) {
    for (ConstraintRow& row : model.rows)
      if (row.number == 2)
        change(row);
    return model;
  };
  const auto close = [](ConstraintRow& row) { row.status = Status::Closed; };
  refused(tied, with(tied, close).rows,
          "constraint row 2 is marked open or closed, which is valid only for inequalities without softness");
  const TestModel limited = [&] {
    TestModel model = tied;
    for (ConstraintRow& row : model.rows)
      row.kind = Kind::Limited, row.limit = 10.0;
    return model;
  }();
  refused(limited, with(limited, close).rows,
          "constraint row 2 is marked open or closed, which is valid only for inequalities without softness");
  const TestModel soft = with(contact, [](ConstraintRow& row) { row.softness = 0.1; });
  refused(soft, with(soft, close).rows,
          "constraint row 2 is marked open or closed, which is valid only for inequalities without softness");
  // Rows of another geometry.
  refused(contact, with(contact, [](ConstraintRow& row) { row.terms.front().coefficient *= 1.1; }).rows,
          "create new constraints");
}

// A limit that follows a force, which is not to be taken for known.
TEST(Increments, refuse_statuses_that_limits_follow) {
  TestModel model = contactModel();
  const std::size_t contacts = model.rows.size();
  for (std::size_t r = 0; r < contacts; ++r) {
    ConstraintRow row = model.rows[r];
    row.kind = Kind::Limited;
    row.normal = row.number;
    row.coefficient = 0.1;
    row.bound = 0.0;
    model.rows.push_back(row);
  }
  for (ConstraintRow& row : model.rows)
    if (row.kind == Kind::Inequality && row.number == 1)
      row.status = Status::Open;
  const std::string text =
      inputErrorOf([&] { feti::FetiSolver(testComm(), model.subdomains, model.rows, parametersOf({})); });
  EXPECT_TRUE(contains(text, "follows the force of inequality 1, which is marked open or closed; "
                             "leave it undecided"))
      << text;
}

// Statuses in the rows of a problem itself: closed contacts pull, open ones penetrate, and taken back all is
// as it was.
TEST(Increments, statuses_of_bounds_themselves) {
  TestModel model = contactModel();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf({}));
  ASSERT_TRUE(solver.solve().converged);
  const std::vector<double> forces = solver.rowForces();
  std::vector<ConstraintRow> rows = model.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) // what is open is held, of what is closed each second let go
    rows[r].status = forces[r] > 0.0 && rows[r].number % 2 == 0 ? Status::Open : Status::Closed;
  solver.setBounds(rows);
  ASSERT_TRUE(solver.solve().converged);
  const std::vector<double> turned = solver.rowForces();
  const std::vector<double> residuals =
      solver.constraints()->givenResiduals(solver.displacement(), *solver.solution().multiplier);
  double pull = 0.0, penetration = 0.0, error = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].status == Status::Closed) {
      pull = std::max(pull, -turned[r]);
      error = std::max(error, std::abs(residuals[r]));
    } else {
      EXPECT_EQ(turned[r], 0.0);
      penetration = std::max(penetration, residuals[r]);
    }
  EXPECT_GT(globalMax(*testComm(), pull), 0.0);
  EXPECT_GT(globalMax(*testComm(), penetration), 0.0);
  EXPECT_LE(globalMax(*testComm(), error), bound * solver.audit().largestDisplacement);
  solver.setBounds(model.rows);
  ASSERT_TRUE(solver.solve().converged);
  const std::vector<double> again = solver.rowForces();
  double difference = 0.0, largest = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    difference = std::max(difference, std::abs(again[r] - forces[r]));
    largest = std::max(largest, forces[r]);
  }
  EXPECT_LE(globalMax(*testComm(), difference), bound * globalMax(*testComm(), largest));
}

// Bv and Bu − c of the rows as they were given: by the differences of displacements themselves.
TEST(Increments, products_with_given_rows) {
  for (const char* dirichlet : {"primal", "dual"})
    for (const char* weights : {"none", "stiffness"}) {
      Setting setting;
      setting.dirichlet = dirichlet, setting.weights = weights;
      TestModel model = testModel(2, 4);
      for (ConstraintRow& row : model.rows)
        for (ConstraintRow::Term& term : row.terms)
          term.coefficient *=
              1.0 + static_cast<double>(row.number); // lengths that are none of the scaled rows
      feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(setting));
      ASSERT_TRUE(solver.solve().converged);
      const feti::TornVector& u = solver.displacement();
      // The mean of the copies of a dof, by all ranks.
      std::vector<double> sums(10000, 0.0), counts = sums;
      for (std::size_t i = 0; i < model.subdomains.size(); ++i)
        for (std::size_t k = 0; k < model.subdomains[i].numbers.size(); ++k) {
          const auto dof = static_cast<std::size_t>(model.subdomains[i].numbers[k]);
          ASSERT_LT(dof, sums.size());
          sums[dof] += u[i][static_cast<std::size_t>((*model.subdomains[i].interface)[k])];
          counts[dof] += 1.0;
        }
      globalSum(*testComm(), sums);
      globalSum(*testComm(), counts);
      const std::vector<double> products = solver.constraints()->givenProducts(u);
      const std::vector<double> residuals =
          solver.constraints()->givenResiduals(u, *solver.solution().multiplier);
      ASSERT_EQ(products.size(), model.rows.size());
      for (std::size_t r = 0; r < model.rows.size(); ++r) {
        double expected = 0.0, size = 0.0;
        for (const ConstraintRow::Term& term : model.rows[r].terms) {
          const auto dof = static_cast<std::size_t>(term.dof);
          expected += term.coefficient * sums[dof] / counts[dof];
          size += std::abs(term.coefficient);
        }
        // Copies differ by the tolerance of the solution; the mean is what rows take.
        const double rounding = 1e-12 * size * solver.audit().largestDisplacement;
        EXPECT_NEAR(products[r], expected, rounding) << dirichlet << ", " << weights << ", row " << r;
        EXPECT_NEAR(residuals[r], expected - model.rows[r].bound, rounding) << dirichlet << ", row " << r;
      }
    }
}

// Loads on a motion that open contacts do not hold any more: an error on all ranks, nothing lost. And none
// without factors.
TEST(Increments, that_nothing_holds) {
  const TestModel model = contactModel();
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf({}));
  ASSERT_TRUE(solver.solve().converged);
  const feti::TornVector before = solver.displacement();
  std::vector<ConstraintRow> rows = model.rows;
  for (ConstraintRow& row : rows)
    row.status = Status::Open; // the second membrane is held by contact alone
  const Loads loads = loadsOf(model, 1.0);
  try {
    EXPECT_FALSE(solver.solveIncrement(loads, rows, tolerance).report.converged);
  } catch (const NumericalError&) { // said as well as it is by a report
  }
  EXPECT_EQ(solver.displacement(), before);
  EXPECT_TRUE(solver.solve().converged);
  Loads wrong = loads;
  if (!wrong.empty())
    wrong.front() = std::make_shared<const std::vector<double>>(3, 1.0);
  EXPECT_THROW(solver.solveIncrement(wrong, model.rows, tolerance), InputError);
  EXPECT_TRUE(solver.solve().converged);
}

} // namespace test_increments
