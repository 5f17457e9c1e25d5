// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Pipeline.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace test_pipeline {

using namespace Harmos;

namespace {

scene::Scene grid(int s, int bodies) {
  scene::Scene scene;
  for (int b = 0; b < bodies; ++b) {
    const auto rectangle = std::make_shared<const fem::StructuredBlock>(
        fem::makeRectangle(fem::Point{0, 0, 0}, std::array<double, 2>{1, 1}, std::array<int, 2>{s, s},
                           std::array<int, 2>{1, 1}, 100 * b));
    scene::Body body;
    body.subdomains = s * s;
    body.subdomain = [rectangle](int k) { return rectangle->subdomain(k); };
    scene.bodies.push_back(body);
  }
  return scene;
}

} // namespace

// Every subdomain on exactly one rank, in order, and shares that differ by one at most; also with more ranks
// than subdomains.
TEST(Decomposition, shares_are_disjoint_complete_and_even) {
  for (long long total : {1, 2, 8, 18})
    for (int ranks : {1, 2, 3, 5, 40}) {
      long long next = 0, least = 1000, most = 0;
      for (int rank = 0; rank < ranks; ++rank) {
        const scene::Share share = scene::shareOf(rank, ranks, total);
        EXPECT_EQ(share.begin, next);
        next = share.end;
        least = std::min(least, share.end - share.begin);
        most = std::max(most, share.end - share.begin);
      }
      EXPECT_EQ(next, total);
      EXPECT_LE(most - least, 1);
    }
}

TEST(Decomposition, each_rank_makes_its_share) {
  const scene::Scene scene = grid(3, 2);
  const auto comm = testComm();
  const scene::Share share = scene::shareOf(comm->getRank(), comm->getSize(), 18);
  long long next = share.begin;
  for (const scene::OwnedSubdomain& item : scene::decompose(*comm, scene)) {
    EXPECT_EQ(item.number, next);
    EXPECT_EQ(item.body, next < 9 ? 0 : 1);
    ++next;
  }
  EXPECT_EQ(next, share.end);
}

TEST(Decomposition, congruent_subdomains_share_matrix_and_kernel) {
  const scene::Scene scene = grid(3, 1);
  const auto subdomains = scene::assemble(scene, scene::decompose(*testComm(), scene));
  for (const feti::Subdomain& subdomain : subdomains) {
    EXPECT_EQ(subdomain.stiffness.get(), subdomains[0].stiffness.get());
    EXPECT_EQ(subdomain.motions.get(), subdomains[0].motions.get());
  }
}

// Two membranes as in the model problem, but the second one is pulled up, away from the first that it lies
// on: no contact forces hold it, and the message says which one.
TEST(Pipeline, body_that_is_pulled_away_is_named) {
  scene::Scene scene;
  for (int b = 0; b < 2; ++b) {
    const auto rectangle = std::make_shared<const fem::StructuredBlock>(
        fem::makeRectangle(fem::Point{static_cast<double>(b), 0, 0}, std::array<double, 2>{1, 1},
                           std::array<int, 2>{2, 2}, std::array<int, 2>{4, 4}, 1000 * b));
    scene::Body body;
    body.name = b == 0 ? "lower" : "upper";
    body.subdomains = 4;
    body.subdomain = [rectangle](int k) { return rectangle->subdomain(k); };
    scene.bodies.push_back(body);
    addForce(scene, b, std::vector<fem::BoxLoad>{{1.0, {static_cast<double>(b), 0.0}, {b + 1.0, 1.0}}});
  }
  prescribe(scene, {0, "left"}, 0);
  addContact(scene, {0, "right"}, {1, "left"});
  ParameterSpec deck("deck", "A deck.");
  run::RunOptions::addTo(deck);
  for (const char* form : {"primal", "dual"}) {
    Teuchos::ParameterList list = deck.defaults();
    list.sublist("Decomposition").set("Dirichlet", std::string(form));
    run::RunOptions options = run::RunOptions::fromDeck(list);
    options.writeFields = false;
    options.outputDirectory = "pulled_away";
    run::RunReport report;
    run::runScene(testComm(), scene, options, Log(), std::chrono::steady_clock::now(), report);
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(report.result.reason, qp::Reason::Infeasible) << form;
    EXPECT_NE(report.reason.find("unconstrained rigid-body mode under load: \"upper\""), std::string::npos)
        << report.reason;
    EXPECT_EQ(report.reason.find("lower\""), std::string::npos) << report.reason;
  }
}

// Pressed down by its top onto a floor without friction, a block may slide and turn: rows of G of these
// motions are rounding errors, which must not be taken for something that holds them, nor those motions be of
// any size.
TEST(Pipeline, motions_that_nothing_holds_stay_at_rest) {
  constexpr double pressed = 1e-3;
  for (fem::CellType type :
       {fem::CellType::Hexahedron8, fem::CellType::Tetrahedron4, fem::CellType::Hexahedron27})
    for (int elements : {1, 2, 3}) {
      fem::StructuredBlock::Options options;
      options.cellType = type;
      options.elements = {elements, elements + 1, elements};
      options.size = {1.3, 0.7, 0.9};
      scene::Scene scene;
      scene.physics = scene::Physics::Solid;
      scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
      prescribe(scene, {0, "top"}, 2, -pressed);
      contact::Obstacle floor;
      floor.direction = {0.0, 0.0, 1.0};
      addObstacle(scene, {0, "bottom"}, floor);
      const TestRun run = runScene(scene, 1e-8);
      EXPECT_TRUE(run.report.converged) << run.report.reason;
      EXPECT_EQ(run.report.kernelDimension, 3);
      EXPECT_EQ(run.report.coarseDimension, 0);
      EXPECT_LE(run.report.audit.largestDisplacement, 1.01 * pressed);
    }
}

TEST(RunReport, json_has_no_nan) {
  run::RunReport report;
  report.audited = true;
  report.audit.energy = std::nan("");
  report.reason = "a \"quoted\" reason";
  const std::string json = run::toJson(report);
  EXPECT_NE(json.find("\"energy\": null"), std::string::npos);
  EXPECT_NE(json.find("a \\\"quoted\\\" reason"), std::string::npos);
}

TEST(AtomicFile, appears_whole_or_not_at_all) {
  if (testComm()->getRank() != 0)
    return;
  const std::string directory = "/tmp/harmos_test_" + std::to_string(getpid()) + "/a/b";
  io::makeDirectory(directory);
  io::writeAtomically(directory + "/file", "new\n");
  std::ifstream stream(directory + "/file");
  std::string text;
  EXPECT_TRUE(std::getline(stream, text) && text == "new");
  EXPECT_FALSE(std::filesystem::exists(io::partPath(directory + "/file")));
  // A directory stands in the way of the name: the error says so and the part file is not taken for the
  // result.
  io::makeDirectory(directory + "/taken/inside");
  EXPECT_THROW(io::writeAtomically(directory + "/taken", "x"), InputError);
  EXPECT_THROW(io::writeAtomically("/proc/no/file", "x"), InputError);
  EXPECT_THROW(io::makeDirectory(directory + "/file/below"), InputError);
  std::filesystem::remove_all("/tmp/harmos_test_" + std::to_string(getpid()));
}

// The audit objects to jumps of a hundred times the tolerance, to forces that are no balance, and to what is
// no number.
TEST(RunReport, audit_agrees_or_objects) {
  run::RunReport report;
  report.tolerance = 1e-4;
  report.audit.largestDisplacement = 2.0;
  report.audit.forces = 3.0;
  EXPECT_TRUE(feti::auditAgrees(report));
  report.audit.gluingJump = report.audit.penetration = 1.9e-2;
  report.audit.equilibrium = 2.9e-4;
  EXPECT_TRUE(feti::auditAgrees(report));
  for (double feti::KktAudit::*field :
       {&feti::KktAudit::gluingJump, &feti::KktAudit::penetration, &feti::KktAudit::equilibrium})
    for (double bad : {0.6, std::nan("")}) {
      run::RunReport wrong = report;
      wrong.audit.*field = bad;
      EXPECT_FALSE(feti::auditAgrees(wrong));
    }
}

// What the rule "balanced" claims is the error that it allows, whatever tolerance it has come to: else the
// audit asks for the next one at each that is reached, down to rounding errors.
TEST(RunReport, audit_of_a_balanced_run_goes_by_the_error_it_allows) {
  run::RunReport report;
  report.tolerance = 1e-8;
  report.audit.energyNorm = 2.0;
  report.solverError = 1e-3;
  EXPECT_FALSE(feti::auditAgrees(report));
  report.allowedError = 1e-3; // of the energy norm
  EXPECT_TRUE(feti::auditAgrees(report));
  report.solverError = 3e-3;
  EXPECT_FALSE(feti::auditAgrees(report));
}

} // namespace test_pipeline
