// SPDX-License-Identifier: BSD-3-Clause

/// Coulomb's friction against published values, statics by hand, and itself: a plate that lifts off, slips
/// and sticks; patches on slopes, shoes and wedges that hold or do not; loading and unloading.

#include "Harmos_Contact.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_FrictionResults.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <map>

using namespace Harmos;
using effects::Coulomb;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

// A side of the first body on a rigid plane, with friction.
void addPlane(scene::Scene& scene, const std::string& side, const Point& direction, double coefficient,
              const Point& origin = {0, 0, 0}) {
  contact::Obstacle plane;
  plane.direction = direction;
  plane.point = origin;
  const auto obstacle =
      std::make_shared<effects::RigidObstacle>(effects::Part{0, side}, plane, "plane " + side);
  scene.effects.push_back(obstacle);
  scene.effects.push_back(
      std::make_shared<effects::Friction>(obstacle, Coulomb(coefficient), "friction " + side));
}

// Code_Aster SSNV128: a square of side 0.04 on a rigid plane with a coefficient of one. In space a slice of
// it.
scene::Scene grecoPlate(double coefficient, CellType cell = CellType::Quadrilateral4) {
  const bool isSpace = cell == CellType::Hexahedron8, isQuadratic = cell == CellType::Quadrilateral9;
  scene::Scene scene;
  scene.physics = isSpace ? Physics::Solid : Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = cell;
  options.size = {0.04, 0.04, 1.0};
  options.subdomains = {4, 2, 1};
  options.elements = {isQuadratic ? 4 : 8, 5, 1};
  if (isSpace) {
    options.size = {0.04, 0.002, 0.04};
    options.subdomains = {4, 1, 2};
    options.elements = {8, 1, 5};
  }
  scene.bodies.push_back(blockBody("plate", options, fem::Material::isotropic(1.3e11, 0.2)));
  prescribe(scene, {0, "right"}, 0);
  if (isSpace)
    for (const char* side : {"front", "back"})
      prescribe(scene, {0, side}, 1);
  const Point up = isSpace ? Point{0, 0, 1} : Point{0, 1, 0};
  addTraction(scene, {0, "top"}, isSpace ? Point{0, 0, -5e7} : Point{0, -5e7, 0});
  addTraction(scene, {0, "left"}, Point{15e7, 0, 0});
  addPlane(scene, "bottom", up, coefficient);
  return scene;
}

// Displacements to the right on the plane, by micrometres of x.
std::map<long long, double> along(const TestRun& run, int components) {
  std::map<long long, double> mine;
  const auto step = static_cast<std::size_t>(components);
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k + step <= run.solution.displacement[i].size(); k += step) {
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / step));
      if (x[step - 1] == 0.0)
        mine[std::llround(x[0] * 1e6)] = run.solution.displacement[i][k];
    }
  std::map<long long, double> all;
  for (long long key = 0; key <= 40000; key += 625)
    if (const double most = globalMax(*testComm(), mine.count(key) > 0 ? mine[key] : -1.0); most > -1.0)
      all[key] = most;
  return all;
}

} // namespace

TEST(Coulomb, greco_plate) {
  const TestRun run = runScene(grecoPlate(1.0), 1e-9);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  expectCoulombsLaw(run.report, 1.0, 1e-9 * run.report.audit.largestDisplacement);
  EXPECT_GT(countOf(run.report, run::Friction::Sticks), 3);
  EXPECT_GT(countOf(run.report, run::Friction::Slips), 10);
  const std::map<long long, double> found = along(run, 2);
  // Q4, 32 × 10 equal elements: all digits. The average of codes: 5 %.
  const std::map<long long, std::pair<double, double>> published = {{0, {2.84594e-5, 2.86e-5}},
                                                                    {1250, {2.70792e-5, 2.72e-5}},
                                                                    {5000, {2.27403e-5, 2.28e-5}},
                                                                    {7500, {1.97271e-5, 1.98e-5}},
                                                                    {11250, {1.53642e-5, 1.50e-5}}};
  for (const auto& [x, values] : published) {
    EXPECT_NEAR(found.at(x), values.first, 0.5e-10 + 1e-12) << x;
    EXPECT_NEAR(found.at(x), values.second, 0.05 * values.second) << x;
  }
  // A slice of it in space is the same.
  const TestRun slice = runScene(grecoPlate(1.0, CellType::Hexahedron8), 1e-9);
  ASSERT_TRUE(slice.report.converged) << slice.report.reason;
  for (const auto& [x, value] : along(slice, 3))
    EXPECT_NEAR(value, found.at(x), 1e-6 * found.at(0)) << x;
}

// Elements of second order, against the published Q8.
TEST(Coulomb, greco_plate_of_second_order) {
  const TestRun run = runScene(grecoPlate(1.0, CellType::Quadrilateral9), 1e-9);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  const std::map<long long, double> found = along(run, 2);
  const std::map<long long, double> published = {
      {0, 2.85985e-5}, {1250, 2.72076e-5}, {5000, 2.28269e-5}, {7500, 1.97916e-5}, {11250, 1.54064e-5}};
  for (const auto& [x, value] : published)
    EXPECT_NEAR(found.at(x), value, 0.005 * value) << x;
}

// On any number of ranks, by any method, in FETI and Total FETI.
TEST(Coulomb, the_way_does_not_matter) {
  const scene::Scene scene = grecoPlate(0.5);
  const TestRun run = runScene(scene, 1e-9);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  expectCoulombsLaw(run.report, 0.5, 1e-9 * run.report.audit.largestDisplacement);
  const TestRun alone = runScene(scene, 1e-9, {}, Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)));
  EXPECT_NEAR(run.report.audit.energy, alone.report.audit.energy, 1e-9 * std::abs(alone.report.audit.energy));
  for (const std::vector<std::string>& way : std::vector<std::vector<std::string>>{
           {"Solver/Method=SMALBE"}, {"Decomposition/Dirichlet=dual"}, {"Dual operator/Form=implicit"}}) {
    const TestRun other = runScene(scene, 1e-9, way);
    ASSERT_TRUE(other.report.converged) << way.front() << ": " << other.report.reason;
    // Of the limits ten times the tolerance, times what strains make of them.
    EXPECT_LE(largestDifference(other, run), 1e-6 * run.report.audit.largestDisplacement) << way.front();
    EXPECT_EQ(countOf(other.report, run::Friction::Slips), countOf(run.report, run::Friction::Slips));
  }
}

TEST(Coulomb, no_coefficient_is_no_friction) {
  scene::Scene without = grecoPlate(0.0);
  removeEffects(without, "Friction");
  const TestRun none = runScene(without, 1e-10), zero = runScene(grecoPlate(0.0), 1e-10);
  ASSERT_TRUE(none.report.converged && zero.report.converged) << zero.report.reason;
  EXPECT_LE(largestDifference(none, zero), 1e-8 * none.report.audit.largestDisplacement);
  EXPECT_EQ(zero.report.audit.frictionWork, 0.0);
}

namespace {

// A patch on a slope, drawn up it by so much of its weight (NAFEMS CGS-4).
scene::Scene patchOnSlope(double slope, double coefficient, double ratio) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {4, 1, 1};
  options.subdomains = {2, 1, 1};
  options.elements = {4, 2, 1};
  options.map = [slope](const Point& x) { return Point{x[0], x[1] + slope * x[0], x[2]}; };
  scene.bodies.push_back(blockBody("patch", options, fem::Material::isotropic(1.0, 0.3)));
  addForce(scene, 0, Point{ratio * 1e-3, -1e-3, 0});
  addPlane(scene, "bottom", Point{-slope, 1, 0}, coefficient);
  return scene;
}

// A trapezium between two walls that come together below it, pressed down.
scene::Scene wedge(double slope, double coefficient) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.origin = {-1, 0, 0};
  options.size = {2, 1, 1};
  options.subdomains = {2, 1, 1};
  options.elements = {4, 4, 1};
  options.map = [slope](const Point& x) { return Point{x[0] * (1.0 + slope * x[1]), x[1], x[2]}; };
  scene.bodies.push_back(blockBody("wedge", options, fem::Material::isotropic(1.0, 0.3)));
  addTraction(scene, {0, "top"}, Point{0, -0.01, 0});
  addPlane(scene, "left", Point{1, slope, 0}, coefficient, {-1, 0, 0});
  addPlane(scene, "right", Point{-1, slope, 0}, coefficient, {1, 0, 0});
  return scene;
}

} // namespace

// (tan α + μ)/(1 − μ tan α) = 0.412371 for tan α = 0.1, μ = 0.3: a thousandth below that it sticks, a
// thousandth above it slides, whatever the mesh.
TEST(Coulomb, inclined_patch) {
  constexpr double slope = 0.1, coefficient = 0.3;
  const double exact = (slope + coefficient) / (1.0 - coefficient * slope);
  EXPECT_NEAR(exact, 0.412371, 5e-7);
  const TestRun sticks = runScene(patchOnSlope(slope, coefficient, exact * (1.0 - 1e-3)), 1e-8);
  ASSERT_TRUE(sticks.report.converged) << sticks.report.reason;
  EXPECT_GT(countOf(sticks.report, run::Friction::Sticks), 0);
  const TestRun slides = runScene(patchOnSlope(slope, coefficient, exact * (1.0 + 1e-3)), 1e-8);
  EXPECT_FALSE(slides.report.converged);
  EXPECT_NE(slides.report.reason.find("infeasible"), std::string::npos) << slides.report.reason;
  EXPECT_NE(slides.report.reason.find("patch"), std::string::npos) << slides.report.reason;
  // By its weight alone it sticks where the slope is below the coefficient.
  EXPECT_TRUE(runScene(patchOnSlope(0.29, 0.3, 0.0), 1e-8).report.converged);
  EXPECT_FALSE(runScene(patchOnSlope(0.31, 0.3, 0.0), 1e-8).report.converged);
}

// SSNV503: 99 % of what friction holds, and 101 %.
TEST(Coulomb, shoe_sticks_or_slides) {
  for (double share : {0.99, 1.01}) {
    const TestRun run = runScene(patchOnSlope(0.0, 0.4, share * 0.4), 1e-8);
    EXPECT_EQ(run.report.converged, share < 1.0) << run.report.reason;
    if (share > 1.0) {
      EXPECT_NE(run.report.reason.find("patch"), std::string::npos) << run.report.reason;
    }
  }
}

// Walls hold up what is pressed between them: by friction too where it is there. With a coefficient above the
// slope the wedge would jam: forces of its own could stay.
TEST(Coulomb, wedge) {
  for (double coefficient : {0.0, 0.1, 0.3, 0.6, 1.0}) {
    constexpr double slope = 0.2;
    const TestRun run = runScene(wedge(slope, coefficient), 1e-8);
    ASSERT_TRUE(run.report.converged) << coefficient << ": " << run.report.reason;
    expectCoulombsLaw(run.report, coefficient, 1e-8 * run.report.audit.largestDisplacement);
    double up = 0.0;
    for (const run::Forces::Of& effect : run.report.forces.effects)
      if (effect.hasFriction)
        up += effect.normal[1] + effect.tangential[1];
    EXPECT_NEAR(up, 0.01 * 2.0 * (1.0 + slope), 1e-7) << coefficient;
  }
}

// Pressed, pushed and let go: what friction takes it keeps, and the rest is stored or was spent.
TEST(Coulomb, work_of_twenty_steps) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {2, 1, 1};
  options.subdomains = {4, 2, 1};
  options.elements = {6, 6, 1};
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  addTraction(scene, {0, "top"}, Point{0, -0.05, 0});
  addTraction(scene, {0, "left"}, Point{0.03, 0, 0});
  addPlane(scene, "bottom", Point{0, 1, 0}, 0.5);
  std::vector<double> times;
  for (int k = 1; k <= 20; ++k)
    times.push_back(0.1 * k);
  scene.timeline = scene::Timeline(times);
  scene.timeline.add("push", scene::History({0.0, 0.2, 1.0, 2.0}, {0.0, 0.0, 1.0, 0.0}));
  scene.timeline.add("press", scene::History({0.0, 0.2, 2.0}, {0.0, 1.0, 1.0}));
  int traction = 0;
  for (const auto& effect : scene.effects)
    if (effect->kind() == "Traction")
      scene.timeline.follow(*effect, traction++ == 0 ? "press" : "push");
  const TestRun run = runScene(scene, 1e-8);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  ASSERT_EQ(run.report.steps.size(), 20U);
  const run::StepRow& last = run.report.steps.back();
  for (std::size_t k = 1; k < 20; ++k)
    EXPECT_GE(run.report.steps[k].dissipated, run.report.steps[k - 1].dissipated - 1e-8 * last.externalWork);
  EXPECT_GT(last.dissipated, 0.0);
  EXPECT_GT(last.dissipated, run.report.steps[9].dissipated * 1.01);
  // The trapezoidal rule of each of the two ramps: 1/(4n²), n from 8 on.
  EXPECT_NEAR(last.externalWork, last.energy + last.dissipated, 0.01 * run.report.steps[9].externalWork);
}
