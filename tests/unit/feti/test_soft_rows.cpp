// SPDX-License-Identifier: BSD-3-Clause

/// Rows whose force may leave its limits against a softness, as of an interface that is glued: the answers of
/// a dense solver without domain decomposition, products that do not depend on it, faults that the audit
/// finds, and softness that comes and goes.

#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace test_soft_rows {

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

// The membranes, glued: loads press at one end of their edge and pull at the other. With a second component
// that two rows a point hold in both directions, given as discs or not.
TestModel glued(double softness, bool hasTangents, bool hasDiscs = false, int s = 2, int n = 4) {
  TestModel model = testModel(s, n);
  const auto pull = [](feti::Subdomain& subdomain, double factor) {
    changeLoad(subdomain, [&](std::vector<double>& load) {
      for (std::size_t k = 0; k < load.size(); ++k)
        load[k] *= factor;
    });
  };
  for (feti::Subdomain& subdomain : model.subdomains)
    if (subdomain.number % 2 == 0)
      pull(subdomain, -1.5);
  const std::size_t normals = model.rows.size();
  for (ConstraintRow& row : model.rows)
    row.softness = softness;
  if (!hasTangents)
    return model;
  const long long subdomains = globalSum(*testComm(), static_cast<long long>(model.subdomains.size()));
  const long long rows = globalSum(*testComm(), static_cast<long long>(normals));
  const TestModel plain = testModel(s, n);
  for (long long component : {1, 2}) {
    const long long dofs = 1000000 * component; // where numbers of its dofs begin
    for (feti::Subdomain subdomain : plain.subdomains) {
      subdomain.number += static_cast<int>(component * subdomains);
      for (long long& dof : subdomain.numbers)
        dof += dofs;
      pull(subdomain, component == 1 ? 0.3 : -0.2);
      model.subdomains.push_back(subdomain);
    }
    for (std::size_t k = 0; k < normals; ++k) {
      ConstraintRow row = plain.rows[k];
      row.kind = ConstraintRow::Kind::Limited;
      row.disc = hasDiscs ? row.number : -1;
      row.number += (component - 1) * rows;
      row.bound = 0.01;
      row.limit = 0.05; // does not count yet
      row.softness = 2.0 * softness;
      for (ConstraintRow::Term& term : row.terms)
        term.dof += dofs;
      model.rows.push_back(row);
    }
  }
  return model;
}

// What the answer says of sides: rows that pull give way by a compliance, and soft limited rows do.
std::vector<ConstraintRow> rowsOfSides(const std::vector<ConstraintRow>& rows,
                                       const std::vector<double>& forces) {
  std::vector<ConstraintRow> result = rows;
  std::vector<ConstraintRow*> closed, equal;
  for (std::size_t r = 0; r < result.size(); ++r) {
    ConstraintRow& row = result[r];
    const bool isSpring = row.softness && (row.kind == ConstraintRow::Kind::Limited || forces[r] < 0.0);
    if (isSpring) {
      row.kind = ConstraintRow::Kind::Equality;
      row.compliance += *row.softness;
    }
    row.softness.reset();
    (row.kind == ConstraintRow::Kind::Inequality ? closed : equal).push_back(&row);
  }
  for (std::vector<ConstraintRow*>* kind : {&closed, &equal}) {
    long long number = exclusiveScan(*testComm(), static_cast<long long>(kind->size()));
    for (ConstraintRow* row : *kind)
      row->number = number++;
  }
  return result;
}

// Against elimination in all of K with the rows of these sides. Where it has forces ≥ 0 on closed rows, and
// those that pull do so with a gap, its answer is the only one there is.
void expectAnswer(const feti::FetiSolver& solver, const TestModel& model, const std::string& what) {
  const std::vector<double> forces = solver.rowForces();
  const ReferenceSolution reference =
      referenceSolution(*testComm(), model.subdomains, rowsOfSides(model.rows, forces));
  ASSERT_TRUE(reference.solvable) << what;
  ASSERT_TRUE(reference.freeMotions.empty()) << what;
  double error = 0.0;
  for (std::size_t i = 0; i < reference.displacement.size(); ++i)
    for (std::size_t k = 0; k < reference.displacement[i].size(); ++k)
      error = std::max(error, std::abs(reference.displacement[i][k] - solver.displacement()[i][k]));
  EXPECT_LE(globalMax(*testComm(), error), bound * reference.largestDisplacement) << what;
  EXPECT_NEAR(solver.audit().primalEnergy, reference.energy, bound * std::abs(reference.energy)) << what;
}

struct Counts {
  long long pulled = 0, closed = 0;
};

Counts countsOf(const feti::FetiSolver& solver) {
  Counts counts;
  for (double force : solver.contact().force)
    (force < 0.0 ? counts.pulled : counts.closed) += 1;
  return {globalSum(*testComm(), counts.pulled), globalSum(*testComm(), counts.closed)};
}

} // namespace

TEST(SoftRows, answers_of_a_dense_solver) {
  for (const char* weights : {"none", "auto", "stiffness"})
    for (bool hasDiscs : {false, true})
      for (double softness : {1e-3, 1.0, 1e3}) {
        const std::string what = std::string(weights) + ", softness " + std::to_string(softness);
        const TestModel model = glued(softness, true, hasDiscs);
        feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(weights));
        const feti::SolveReport& report = solver.solve();
        ASSERT_TRUE(report.converged) << what << ": " << report.reason;
        EXPECT_EQ(report.solver, "PDAS");
        EXPECT_FALSE(solver.constraints()->hasDiscs() || solver.constraints()->hasIntervals());
        expectAnswer(solver, model, what);
        const Counts counts = countsOf(solver);
        EXPECT_GT(counts.pulled, 0) << what;
        if (softness <= 1.0) // softer springs let the body turn until nothing touches
          EXPECT_GT(counts.closed, 0) << what;
        // Springs by themselves: what they store, and how far they open.
        const feti::ContactState contact = solver.contact();
        const feti::FrictionState across = solver.friction();
        double stored = 0.0;
        for (std::size_t k = 0; k < contact.row.size(); ++k) {
          const double force = std::min(contact.force[k], 0.0);
          EXPECT_NEAR(contact.gap[k], -softness * force, bound * (1.0 + softness)) << what;
          stored += 0.5 * softness * force * force;
        }
        for (std::size_t k = 0; k < across.row.size(); ++k) {
          EXPECT_NEAR(across.slip[k], 2.0 * softness * across.force[k], bound * (1.0 + softness)) << what;
          stored += softness * across.force[k] * across.force[k];
        }
        stored = globalSum(*testComm(), stored);
        EXPECT_NEAR(solver.audit().springEnergy, stored, bound * (1.0 + stored)) << what;
        EXPECT_NEAR(solver.audit().energy, solver.audit().primalEnergy + stored,
                    bound * (1.0 + std::abs(solver.audit().energy)))
            << what;
        EXPECT_EQ(solver.audit().frictionWork, 0.0);
      }
}

// Given as discs, which they become when softness goes: each row has its own softness until then.
TEST(SoftRows, two_directions_of_different_softness) {
  for (const char* weights : {"none", "auto"}) {
    TestModel model = glued(1.0, true, true);
    const long long points =
        globalSum(*testComm(), static_cast<long long>(std::count_if(
                                   model.rows.begin(), model.rows.end(), [](const ConstraintRow& row) {
                                     return row.kind == ConstraintRow::Kind::Inequality;
                                   })));
    for (ConstraintRow& row : model.rows)
      if (row.kind == ConstraintRow::Kind::Limited && row.number >= points)
        row.softness = 0.01;
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(weights));
    const feti::SolveReport& report = solver.solve();
    ASSERT_TRUE(report.converged) << report.reason;
    EXPECT_FALSE(solver.constraints()->hasDiscs() || solver.constraints()->hasIntervals());
    expectAnswer(solver, model, weights);
    for (ConstraintRow& row : model.rows)
      if (row.kind == ConstraintRow::Kind::Limited && row.number >= points)
        row.softness.reset();
    EXPECT_NE(inputErrorOf([&] {
                feti::FetiSolver(testComm(), model.subdomains, model.rows, parametersOf(weights));
              }).find("the same limit and equal softness"),
              std::string::npos);
  }
}

// Of one softness, and of 1e-6 to 1e6 along the rows, not in order.
TEST(SoftRows, products_do_not_depend_on_softness) {
  for (const char* weights : {"none", "auto"}) {
    int least = 1000, most = 0;
    const auto add = [&](const TestModel& model, const std::string& what) {
      feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(weights));
      const feti::SolveReport& report = solver.solve(1e-6);
      ASSERT_TRUE(report.converged) << what << ": " << report.reason;
      const int products = report.result.counters.hessianApplications;
      least = std::min(least, products);
      most = std::max(most, products);
      if (testComm()->getRank() == 0)
        std::cout << weights << ", softness " << what << ": " << products << " products, "
                  << report.result.counters.activeSetUpdates << " sets\n";
    };
    for (double softness = 1e-6; softness < 2e6; softness *= 100.0)
      add(glued(softness, true, true, 3, 8), std::to_string(softness));
    TestModel graded = glued(1.0, true, true, 3, 8);
    for (ConstraintRow& row : graded.rows) {
      const long long point = row.disc >= 0 ? row.disc : row.number;
      row.softness = std::pow(10.0, -6.0 + 12.0 * static_cast<double>((7 * point) % 11) / 10.0);
    }
    add(graded, "graded");
    EXPECT_LE(most, std::max(25.0, 1.5 * least));
  }
}

// The second body has no support: pulled, it escapes from a contact, and hangs on springs.
TEST(SoftRows, hold_a_body_alone) {
  TestModel model = testModel(2, 4);
  for (feti::Subdomain& subdomain : model.subdomains)
    changeLoad(subdomain, [](std::vector<double>& load) {
      for (double& value : load)
        value *= -1.0;
    });
  {
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf("auto"));
    const feti::SolveReport& report = solver.solve();
    EXPECT_FALSE(report.converged);
    EXPECT_TRUE(contains(report.reason, "unconstrained rigid-body mode under load")) << report.reason;
  }
  for (double softness : {1e-6, 1.0, 1e6}) {
    for (ConstraintRow& row : model.rows)
      row.softness = softness;
    for (const char* weights : {"none", "stiffness"}) {
      feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf(weights));
      // Softness times force is what gradients are differences of.
      const double rounding = 10.0 * std::numeric_limits<double>::epsilon() * softness;
      const feti::SolveReport& report = solver.solve(std::max(tolerance, rounding));
      ASSERT_TRUE(report.converged) << softness << ": " << report.reason;
      expectAnswer(solver, model, weights);
      EXPECT_GT(countsOf(solver).pulled, 0);
    }
  }
}

// A point breaks, another gets softer: no factorisation, and the answers of solvers made for them.
TEST(SoftRows, softness_changes_and_goes) {
  TestModel model = glued(0.5, true, true);
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf("auto"));
  ASSERT_TRUE(solver.solve().converged);
  const long long factors = static_cast<long long>(solver.factorizations().factorizations);
  const TestModel intact = model;
  const std::vector<std::function<void(ConstraintRow&, long long)>> changes = {
      [](ConstraintRow& row, long long point) { *row.softness *= point % 3 == 0 ? 10.0 : 1.0; },
      [](ConstraintRow& row, long long point) {
        if (point % 3 == 0) {
          row.softness.reset();
          row.limit = row.kind == ConstraintRow::Kind::Limited ? 1e-2 : 0.0;
        }
      },
      [](ConstraintRow& row, long long) { row.softness.reset(); }, [](ConstraintRow&, long long) {}};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    model = intact;
    for (ConstraintRow& row : model.rows) {
      row.bound += 1e-3 * static_cast<double>(k);
      changes[k](row, row.disc >= 0 ? row.disc : row.number);
    }
    solver.setBounds(model.rows);
    EXPECT_EQ(solver.constraints()->hasSoft(), k != 2);
    EXPECT_EQ(solver.constraints()->hasDiscs(), k == 1 || k == 2);
    feti::FetiSolver fresh(testComm(), model.subdomains, model.rows, parametersOf("auto"));
    const feti::SolveReport &report = solver.solve(), &other = fresh.solve();
    EXPECT_EQ(report.converged, other.converged) << k << ": " << other.reason;
    EXPECT_EQ(report.converged, k != 2) << k << ": " << report.reason;
    if (!report.converged) { // nothing holds the second body
      for (const feti::SolveReport* one : {&report, &other})
        EXPECT_TRUE(contains(one->reason, "unconstrained rigid-body mode under load: subdomains 4, 5, 6, 7"))
            << one->reason;
      continue;
    }
    EXPECT_NEAR(solver.audit().energy, fresh.audit().energy, 1e-9 * std::abs(fresh.audit().energy)) << k;
    EXPECT_NEAR(solver.audit().springEnergy, fresh.audit().springEnergy,
                1e-8 * std::abs(fresh.audit().energy))
        << k;
  }
  EXPECT_EQ(static_cast<long long>(solver.factorizations().factorizations), factors);
}

// Half of the points follow Coulomb's friction, half are glued.
TEST(SoftRows, beside_limits_that_follow) {
  TestModel model = glued(0.5, true, true);
  std::vector<ConstraintRow> rows = model.rows;
  for (ConstraintRow& row : rows) {
    const long long point = row.disc >= 0 ? row.disc : row.number;
    if (point % 2 == 0)
      continue;
    row.softness.reset();
    if (row.kind == ConstraintRow::Kind::Limited) {
      row.limit = 0.0;
      row.coefficient = 0.3;
      row.normal = point;
    }
  }
  feti::FetiSolver solver(testComm(), model.subdomains, rows, parametersOf("auto"));
  const feti::SolveReport& report = solver.solve();
  ASSERT_TRUE(report.converged) << report.reason;
  EXPECT_TRUE(feti::auditAgrees(solver.audit(), {feti::auditShare(tolerance)}));
  EXPECT_GT(solver.audit().springEnergy, 0.0);
  EXPECT_GT(countsOf(solver).pulled, 0);
  EXPECT_LE(solver.audit().limitExcess, 1e-12);
  // One of the two alone has a force that may pull.
  for (ConstraintRow& row : rows)
    if (row.kind == ConstraintRow::Kind::Inequality)
      row.softness = 1.0;
  const std::string said =
      inputErrorOf([&] { feti::FetiSolver(testComm(), model.subdomains, rows, parametersOf("auto")); });
  EXPECT_TRUE(contains(said, "which is soft and can pull; give softness to both rows or to none")) << said;
}

TEST(SoftRows, audit_finds_faults) {
  const TestModel model = glued(0.5, true, false);
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf("auto"));
  ASSERT_TRUE(solver.solve().converged);
  const feti::AuditLimits limits = {feti::auditShare(tolerance)};
  EXPECT_TRUE(feti::auditAgrees(solver.audit(), limits));
  feti::KktAudit stretched = solver.audit(); // and in balance
  stretched.springError = 10.0 * limits.share * stretched.largestDisplacement;
  EXPECT_FALSE(feti::auditAgrees(stretched, limits));
  for (feti::RowType type : {feti::RowType::Inequality, feti::RowType::Limited}) {
    feti::TornSolution solution = solver.solution();
    const auto multiplier = Teuchos::rcp(new MultiVector(*solution.multiplier, Teuchos::Copy));
    {
      const auto view = multiplier->getLocalViewHost(Tpetra::Access::ReadWrite);
      for (std::size_t r = 0; r < view.extent(0); ++r)
        if (solver.constraints()->rowType(static_cast<int>(r)) == type && view(r, 0) < 0.0)
          view(r, 0) *= 1.01;
    }
    solution.multiplier = multiplier;
    const feti::KktAudit wrong = feti::audit(solver.system(), *solver.constraints(), solution);
    EXPECT_FALSE(feti::auditAgrees(wrong, limits));
    EXPECT_GT(wrong.springError, 1e-4 * wrong.largestDisplacement);
  }
}

TEST(SoftRows, bad_ones_are_refused) {
  const auto saidOf = [](const std::function<void(ConstraintRow&)>& change,
                         const std::string& method = "Auto") {
    TestModel model = glued(1.0, false);
    for (ConstraintRow& row : model.rows)
      change(row);
    return inputErrorOf([&] {
      feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parametersOf("auto", method));
      solver.solve();
    });
  };
  EXPECT_TRUE(contains(saidOf([](ConstraintRow& row) { row.softness = -1.0; }), "has a softness of"));
  EXPECT_TRUE(contains(saidOf([](ConstraintRow& row) { row.kind = ConstraintRow::Kind::Equality; }),
                       "give it a compliance, or make it a limited row"));
  EXPECT_TRUE(contains(saidOf([](ConstraintRow&) {}, "SMALBE"), "use PDAS or Auto"));
}

} // namespace test_soft_rows
