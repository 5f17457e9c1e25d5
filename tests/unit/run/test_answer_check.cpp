// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunReport.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_answer_check {

using namespace Harmos;

namespace {

// A block pressed onto another, both clamped at the far side; contact closes in part.
scene::Scene pressed(int subdomains, int elements) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {subdomains, subdomains, 1};
  options.elements = {elements, elements, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin = {0.0, 1.0, 0.0};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(10.0, 0.3)));
  for (int c : {0, 1})
    prescribe(scene, {0, "bottom"}, c);
  prescribe(scene, {1, "left"}, 0);
  prescribe(scene, {1, "left"}, 1);
  addTraction(scene, {1, "top"}, {0.0, -0.02, 0.0});
  addContact(scene, {0, "top"}, {1, "bottom"}, 0.002);
  return scene;
}

// A thin strip of soft material, cut across many times, bent by its own end.
scene::Scene strip(int subdomains) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.size = {static_cast<double>(subdomains), 0.05, 1.0};
  options.subdomains = {subdomains, 1, 1};
  options.elements = {20, 2, 1};
  scene.bodies.push_back(blockBody("strip", options, fem::Material::isotropic(1.0, 0.3)));
  for (int c : {0, 1})
    prescribe(scene, {0, "left"}, c);
  addTraction(scene, {0, "right"}, {0.0, 1e-9, 0.0});
  return scene;
}

// The dual energy lacks ½‖u − u*‖² of its maximum exactly: an independent measure of the solver's error, in
// the energy norm and without the factor of half that norms have not.
double missing(const TestRun& run, double best) {
  return std::sqrt(2.0 * std::max(0.0, best - run.report.audit.energy));
}

} // namespace

// The estimate bounds the solver's error (hypercircle), and is no more than a few times as large; the
// tolerance it leads to keeps that error below its share of the discretisation error.
TEST(AnswerCheck, balanced_runs_keep_the_share) {
  const std::vector<std::string> balanced = {"Solver/Tolerance rule=balanced"};
  for (const char* preconditioner : {"Dirichlet", "lumped", "none"})
    for (int elements : {4, 8, 16}) {
      const scene::Scene scene = pressed(3, elements);
      const std::string choice = std::string("Dual operator/Preconditioner=") + preconditioner;
      const TestRun exact = runScene(scene, 1e-11);
      ASSERT_TRUE(exact.report.converged);
      for (double share : {1.0, 0.1}) {
        const TestRun run = runScene(
            scene, 1e-4, {balanced[0], choice, "Solver/Expert/Solver error share=" + std::to_string(share)});
        ASSERT_TRUE(run.report.converged) << run.report.reason;
        const run::RunReport& report = run.report;
        const double solver = missing(run, exact.report.audit.energy);
        // A bound, but for the rounding errors of the difference of energies.
        EXPECT_LE(solver, 1.001 * report.solverError) << preconditioner << elements;
        if (std::string(preconditioner) == "Dirichlet")
          EXPECT_GE(solver, 0.05 * report.solverError) << preconditioner << elements;
        EXPECT_LE(report.solverError, 1.1 * share * report.discretisationError * report.audit.energyNorm)
            << preconditioner << elements;
        EXPECT_EQ(report.toleranceRule, "balanced");
        EXPECT_GT(report.tolerance, 1e-6);
      }
    }
}

// The tolerance follows the mesh: errors of elements of the first order fall like h, and so does what the
// solver is asked for.
TEST(AnswerCheck, balanced_tolerances_fall_with_the_mesh) {
  std::vector<double> h, error;
  for (int elements : {4, 8, 16, 32}) {
    const TestRun run = runScene(pressed(2, elements), 1e-4, {"Solver/Tolerance rule=balanced"});
    h.push_back(1.0 / elements);
    error.push_back(run.report.discretisationError);
  }
  // Corners that are clamped and edges of the contact zone have singular stresses: less than 1.
  EXPECT_GT(fittedRate(h, error), 0.6);
  EXPECT_LT(fittedRate(h, error), 1.1);
}

// Where F is badly conditioned, small residuals say little about jumps. What it guards against: "converged"
// with pieces that have come apart.
TEST(AnswerCheck, jumps_that_contradict_small_residuals) {
  const scene::Scene scene = strip(12);
  const std::vector<std::string> weak = {"Dual operator/Preconditioner=none"};
  const TestRun run = runScene(scene, 1e-3, weak);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  EXPECT_TRUE(feti::auditAgrees(run.report));
  EXPECT_LT(run.report.reachedTolerance, 0.5 * 1e-3);
  EXPECT_EQ(run.report.tolerance, 1e-3);
}

} // namespace test_answer_check
