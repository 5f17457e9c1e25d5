// SPDX-License-Identifier: BSD-3-Clause

/// Forces that a run tells, against what equilibrium says of them.

#include "Harmos_ElasticFoundation.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_forces {

using namespace Harmos;

namespace {

constexpr double tolerance = 1e-10;
// Of forces: residuals by the condition of these F, a hundred at most, of loads of the order of one.
constexpr double bound = 1e3 * tolerance;

using fem::Point;

const std::vector<std::vector<std::string>> settings = {
    {}, {"Decomposition/Dirichlet=dual"}, {"Dual operator/Form=implicit"}};

run::Resultant of(const TestRun& run, const std::string& path) {
  for (const run::Forces::Of& effect : run.report.forces.effects)
    if (effect.path == path)
      return effect.resultant;
  ADD_FAILURE() << "no force of " << path;
  return {};
}

void expectNear(const Point& found, const Point& expected, const std::string& what) {
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(found[d], expected[d], bound) << what << ", component " << d;
}

Point sum(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

TestRun solved(const scene::Scene& scene, const std::vector<std::string>& assignments) {
  TestRun run = runScene(scene, tolerance, assignments);
  EXPECT_TRUE(run.report.converged) << run.report.reason;
  // Ten times what equilibrium is known to, with the sizes of forces that cancel.
  EXPECT_LE(run.report.forces.balance, 1e-8);
  return run;
}

// Two blocks on each other, unit squares or cubes; below 2 × 2 elements in each of 2 × 2 subdomains, above
// as many elements as asked for.
scene::Scene stacked(bool inSpace, int above) {
  scene::Scene scene;
  scene.physics = inSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = inSpace ? fem::CellType::Hexahedron8 : fem::CellType::Quadrilateral4;
  options.subdomains = {2, 2, inSpace ? 2 : 1};
  options.elements = {2, 2, inSpace ? 2 : 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.elements = {above, above, inSpace ? above : 1};
  (inSpace ? options.origin[2] : options.origin[1]) = 1.0;
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(3.0, 0.2)));
  return scene;
}

// The unit square, of 2 × 2 subdomains.
scene::Scene square(scene::Physics physics) {
  scene::Scene scene;
  scene.physics = physics;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {2, 2, 1};
  options.elements = {3, 3, 1};
  scene.bodies.push_back(blockBody("square", options, fem::Material::isotropic(1.0, 0.3)));
  return scene;
}

// ∫ and first moment of the pressure 1 + x on the unit square or edge: pressed everywhere.
constexpr double load = 1.5, momentArm = 5.0 / 6.0;
Point pressure(const Point& x, std::size_t up) {
  Point result{};
  result[up] = -(1.0 + x[0]);
  return result;
}

} // namespace

// The load is not in the middle: the moment tells whether forces are at their places. Meshes match.
TEST(Forces, eccentric_load_goes_through_every_joint) {
  for (bool inSpace : {false, true})
    for (bool tied : {false, true})
      for (const auto& setting : settings) {
        const std::string what = std::string(inSpace ? "space" : "plane") + (tied ? ", tie" : ", contact") +
                                 (setting.empty() ? "" : ", " + setting[0]);
        scene::Scene scene = stacked(inSpace, 2);
        const std::size_t up = inSpace ? 2 : 1;
        const std::string low = "bottom";
        if (tied)
          addTie(scene, {0, "top"}, {1, "bottom"});
        else
          addContact(scene, {0, "top"}, {1, "bottom"});
        for (int c = 0; c < (inSpace ? 3 : 2); ++c)
          prescribe(scene, {0, low}, c);
        if (!tied) { // what friction would do
          prescribe(scene, {1, "left"}, 0);
          if (inSpace)
            prescribe(scene, {1, "front"}, 1);
        }
        addTraction(scene, {1, "top"}, [up](const Point& x, const Point&) { return pressure(x, up); });
        const TestRun run = solved(scene, setting);
        // About y in space, about z in the plane; y = ½ on average.
        const run::Resultant joint = of(run, tied ? "Tie/1" : "Contact/1");
        EXPECT_NEAR(joint.force[up], -load, bound) << what;
        const std::size_t about = inSpace ? 1 : 2;
        const double sign = inSpace ? 1.0 : -1.0;
        double fromSide = 0.0; // where the upper block leans on its sides
        if (!tied)
          fromSide = of(run, "Prescribed displacement/left").moment[about];
        EXPECT_NEAR(joint.moment[about], sign * momentArm + fromSide, bound) << what;
        Point support{}, moment{};
        for (const run::Forces::Of& effect : run.report.forces.effects)
          if (effect.path.rfind("Prescribed displacement/", 0) == 0) {
            support = sum(support, effect.resultant.force);
            moment = sum(moment, effect.resultant.moment);
          }
        Point expected{};
        expected[up] = load;
        expectNear(support, expected, what);
        Point expectedMoment{};
        expectedMoment[about] = -sign * momentArm;
        if (inSpace)
          expectedMoment[0] = 0.5 * load;
        expectNear(moment, expectedMoment, what + ", moment");
      }
}

// Mortar joints hand on forces exactly, and a tie what is beyond it.
TEST(Forces, a_tie_bears_what_is_beyond_it) {
  for (int above : {2, 3})
    for (const auto& setting : settings) {
      scene::Scene scene = stacked(false, above);
      addTie(scene, {1, "bottom"}, {0, "top"});
      for (int c : {0, 1})
        prescribe(scene, {0, "bottom"}, c);
      addForce(scene, 0, Point{0.0, -0.25, 0.0});
      addForce(scene, 1, Point{0.125, -1.0, 0.0});
      const TestRun run = solved(scene, setting);
      expectNear(of(run, "Tie/1").force, {-0.125, 1.0, 0.0}, "tie");
    }
}

// Rows lose their terms at prescribed dofs, whose supports bear the row's force all the same.
TEST(Forces, a_support_bears_the_contact_on_its_own_nodes) {
  for (const auto& setting : settings) {
    scene::Scene scene = stacked(false, 2);
    addContact(scene, {1, "bottom"}, {0, "top"});
    prescribe(scene, {0, "bottom"}, 0);
    prescribe(scene, {0, "top"}, 1);
    prescribe(scene, {1, "left"}, 0);
    addTraction(scene, {1, "top"}, [](const Point& x, const Point&) { return pressure(x, 1); });
    const TestRun run = solved(scene, setting);
    EXPECT_NEAR(of(run, "Contact/1").force[1], load, bound);
    EXPECT_NEAR(of(run, "Prescribed displacement/top").force[1], load, bound);
  }
}

// The corner is held by both, and a row asked for by two effects is one.
TEST(Forces, what_two_effects_hold_counts_for_the_first) {
  for (const auto& setting : settings) {
    scene::Scene scene = square(scene::Physics::PlaneStrain);
    for (const char* side : {"left", "bottom"})
      for (int c : {0, 1})
        prescribe(scene, {0, side}, c);
    addTraction(scene, {0, "right"}, Point{0.5, -0.25, 0.0});
    const TestRun run = solved(scene, setting);
    Point total{};
    for (const run::Forces::Of& effect : run.report.forces.effects)
      total = sum(total, effect.resultant.force);
    expectNear(total, {-0.5, 0.25, 0.0}, "supports");

    removeEffects(scene, "Prescribed displacement");
    removeEffects(scene, "Traction");
    contact::Obstacle plane;
    plane.shape = contact::Obstacle::Shape::HalfSpace;
    plane.direction = {0.0, 1.0, 0.0};
    addObstacle(scene, {0, "bottom"}, plane);
    addObstacle(scene, {0, "bottom"}, plane);
    prescribe(scene, {0, "left"}, 0);
    addForce(scene, 0, Point{0.0, -1.0, 0.0});
    const TestRun standing = solved(scene, setting);
    EXPECT_NEAR(of(standing, "Obstacle/1").force[1], 1.0, bound);
    EXPECT_EQ(of(standing, "Obstacle/2").force[1], 0.0);
  }
}

TEST(Forces, a_foundation_carries_the_block) {
  for (const auto& setting : settings) {
    scene::Scene scene = square(scene::Physics::PlaneStrain);
    scene.effects.push_back(
        std::make_shared<effects::ElasticFoundation>(effects::Part{0, "bottom"}, 2.0, 1.0, "soil"));
    addTraction(scene, {0, "top"}, [](const Point& x, const Point&) { return pressure(x, 1); });
    const TestRun run = solved(scene, setting);
    const run::Resultant soil = of(run, "Elastic foundation/soil");
    expectNear(soil.force, {0.0, load, 0.0}, "force");
    expectNear(soil.moment, {0.0, 0.0, momentArm}, "moment");
  }
}

TEST(Forces, membranes_have_them_along_z) {
  for (const auto& setting : {settings[0], settings[1]}) {
    scene::Scene scene = square(scene::Physics::Membrane);
    addForce(scene, 0, std::vector<fem::BoxLoad>{{-2.0, {-1.0, -1.0}, {2.0, 2.0}}});
    prescribe(scene, {0, "left"}, 0);
    const run::Resultant edge = of(solved(scene, setting), "Prescribed displacement/left");
    expectNear(edge.force, {0.0, 0.0, 2.0}, "force");
    // At y = ½ on average; the edge is at x = 0.
    expectNear(edge.moment, {1.0, 0.0, 0.0}, "moment");
  }
}

} // namespace test_forces
