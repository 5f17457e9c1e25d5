// SPDX-License-Identifier: BSD-3-Clause

/// Forces of a small contact in a large body under load: they are measured by themselves.

#include "Harmos_RunReport.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_pair_errors {

using namespace Harmos;

namespace {

// A plate of 40 that is pulled along, and a block of two that presses against its side by little.
scene::Scene punched(double pull, double pressure) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.origin = {-20.0, 0.0, 0.0};
  options.size = {40.0, 40.0, 1.0};
  options.subdomains = {4, 4, 1};
  options.elements = {10, 10, 1};
  scene.bodies.push_back(blockBody("plate", options, fem::Material::isotropic(1000.0, 0.3)));
  options.origin = {-1.0, -2.0, 0.0};
  options.size = {2.0, 2.0, 1.0};
  options.subdomains = {1, 1, 1};
  options.elements = {4, 4, 1};
  scene.bodies.push_back(blockBody("punch", options, fem::Material::isotropic(1000.0, 0.3)));
  prescribe(scene, {0, "left"}, 0);
  prescribe(scene, {0, "top"}, 1);
  prescribe(scene, {1, "left"}, 0);
  addTraction(scene, {0, "right"}, {pull, 0.0, 0.0});
  addTraction(scene, {1, "bottom"}, {0.0, pressure, 0.0});
  addContact(scene, {1, "top"}, {0, "bottom"});
  return scene;
}

// ‖force‖ of the points, which are on every rank, less those of another run.
double norm(const TestRun& run, const TestRun* less = nullptr) {
  double sum = 0.0;
  for (std::size_t k = 0; k < run.report.contact.size(); ++k)
    sum += std::pow(run.report.contact[k].force - (less ? less->report.contact[k].force : 0.0), 2);
  return std::sqrt(sum);
}

} // namespace

// The residual of the whole is met where these forces are wrong by more than their own size.
TEST(PairErrors, small_contacts_make_the_solver_go_on) {
  for (const double pull : {1.0, 100.0})
    for (const char* preconditioner : {"Dirichlet", "lumped", "none"}) {
      const scene::Scene scene = punched(pull, 0.01);
      const std::vector<std::string> choice = {std::string("Dual operator/Preconditioner=") + preconditioner};
      const TestRun exact = runScene(scene, 1e-12);
      ASSERT_TRUE(exact.report.converged) << exact.report.reason;
      for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6}) {
        const TestRun run = runScene(scene, tolerance, choice);
        ASSERT_TRUE(run.report.converged) << run.report.reason;
        ASSERT_EQ(run.report.pairErrors.size(), 1u);
        const feti::PairError& pair = run.report.pairErrors.front();
        EXPECT_EQ(pair.path, "Contact/1");
        const double wrong = norm(run, &exact);
        EXPECT_NEAR(pair.force, norm(run), 1e-9 * pair.force);
        // The estimate is within a factor of four.
        EXPECT_LE(wrong, 4.0 * feti::allowedForceError(run.report, pair)) << pull << " " << tolerance;
        EXPECT_LE(pair.error, feti::allowedForceError(run.report, pair)) << pull << " " << tolerance;
        EXPECT_LE(wrong, 4.0 * pair.error) << pull << " " << tolerance << " " << preconditioner;
        EXPECT_EQ(run.report.tolerance, tolerance);
        if (pull == 100.0 && tolerance > 1e-5) // more than a hundred times as large an error without it
          EXPECT_LT(run.report.reachedTolerance, 0.5 * tolerance);
      }
    }
}

// A contact that bears all of the load needs no more than it did.
TEST(PairErrors, large_contacts_change_nothing) {
  const TestRun run = runScene(punched(0.0, 1.0), 1e-4);
  ASSERT_TRUE(run.report.converged);
  EXPECT_GT(run.report.reachedTolerance, 1e-5);
  const feti::PairError& pair = run.report.pairErrors.front();
  EXPECT_LT(pair.relative(), 0.01);
  EXPECT_EQ(run::doubtfulForces(run.report), "");
  ASSERT_TRUE(run.report.forces.effects.back().error || run.report.forces.effects.front().error);
}

// Errors are allowed by the pair's own forces; of forces that are hardly there by all of them.
TEST(PairErrors, what_is_allowed) {
  run::RunReport report;
  report.tolerance = 1e-4;
  report.audit.forces = 100.0;
  feti::PairError pair{{2.0, 0.0}, "Contact/c"};
  EXPECT_NEAR(feti::allowedForceError(report, pair), 0.02, 1e-14);
  pair.force = 1e-9;
  EXPECT_NEAR(feti::allowedForceError(report, pair), 1e-2 * 1e-5 * 100.0, 1e-14);
  pair.force = 2.0;
  report.tolerance = 0.01; // a tenth at most
  EXPECT_NEAR(feti::allowedForceError(report, pair), 0.2, 1e-14);
  report.tolerance = 1e-4;
  report.allowedError = 0.05; // the rule "balanced"
  EXPECT_NEAR(feti::allowedForceError(report, pair), 0.1, 1e-14);
  report.allowedError = 0.0;
  report.audit.displacementForce = 1e11; // a stiff body that has gone far
  EXPECT_NEAR(feti::allowedForceError(report, pair), 0.02 + 0.01, 1e-12);
}

// Tractions of a node: by the largest one of the pair, and what rounding errors of forces make on the
// smallest area.
TEST(PairErrors, what_is_allowed_at_a_node) {
  run::RunReport report;
  report.tolerance = 1e-4;
  report.audit.forces = 100.0;
  feti::PairError pair{{2.0, 0.0, 5.0, 0.3, 0.1}, "Contact/c"};
  EXPECT_NEAR(feti::allowedTractionError(report, pair), 3.0 * 0.01 * 5.0, 1e-14);
  EXPECT_NEAR(feti::forceExcess(report, pair), 2.0, 1e-14);
  pair.error = 0.06; // of 0.02
  EXPECT_NEAR(feti::forceExcess(report, pair), 3.0, 1e-14);
  pair.force = 1e-5; // a hundredth of what counts
  EXPECT_NEAR(feti::allowedTractionError(report, pair), 100.0 * 3.0 * 0.01 * 5.0, 1e-12);
  pair.force = 0.0;
  EXPECT_NEAR(feti::allowedTractionError(report, pair), 3.0 * 0.01 * 1e-5 * 100.0 / 0.1, 1e-14);
  report.audit.displacementForce = 1e10;
  EXPECT_NEAR(feti::allowedTractionError(report, pair), 3e-4 + 1e-3 / 0.1, 1e-12);
  report.audit.displacementForce = 0.0;
  report.pairErrors = {{{2.0, 0.0}, "Contact/no areas"}};
  EXPECT_EQ(feti::forceExcess(report), 0.0);
}

// An answer that the solver came no further with: beyond what the estimate may be wrong by it is none.
TEST(PairErrors, forces_that_are_wrong_beyond_doubt_are_told) {
  run::RunReport report;
  report.tolerance = 1e-4;
  report.audit.forces = 100.0;
  EXPECT_EQ(feti::wrongForcesText(report), "");
  report.pairErrors = {{{1.0, 0.02}, "Contact/a"}, {{1.0, 0.039}, "Contact/b"}};
  EXPECT_EQ(feti::wrongForcesText(report), "");
  report.pairErrors[1].error = 0.041;
  EXPECT_NE(feti::wrongForcesText(report).find("\"Contact/b\" have an estimated relative error of 4.1e-02"),
            std::string::npos)
      << feti::wrongForcesText(report);
  // Of one node alone.
  report.pairErrors = {{{1.0, 1e-3, 2.0, 0.5, 0.1}, "Contact/c"}};
  EXPECT_NE(feti::wrongForcesText(report).find("1.0e-03, of its largest traction at one node 2.5e-01, and"),
            std::string::npos)
      << feti::wrongForcesText(report);
}

TEST(PairErrors, doubtful_forces_are_named) {
  run::RunReport report;
  report.tolerance = 1e-6;
  report.audit.forces = 100.0;
  report.pairErrors = {
      {{1.0, 1e-5}, "Contact/good"}, {{1e-6, 5e-7}, "Contact/small"}, {{0.0, 1e-9}, "Tie/none"}};
  EXPECT_EQ(run::doubtfulForces(report),
            "Forces with a large estimated relative error: \"Contact/small\" (5e-01). They are small "
            "relative to all "
            "forces of the scene; a smaller \"Solver/Tolerance\" reduces the error down to rounding level");
}

} // namespace test_pair_errors
