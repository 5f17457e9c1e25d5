// SPDX-License-Identifier: BSD-3-Clause

/// Friction by Tresca's law against theory: a strip that is pulled and let go, a round column that is
/// twisted, a shoe that sticks or slides, a plate whose bounds are those of its own Coulomb friction; and two
/// solutions of the same problem on other numbers of ranks, in other forms, and with slips in the place of
/// friction.

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

#include <algorithm>
#include <cmath>
#include <iostream>

using namespace Harmos;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

contact::Obstacle floorBelow(bool isSpace = false) {
  contact::Obstacle floor;
  floor.direction = isSpace ? Point{0, 0, 1} : Point{0, 1, 0};
  return floor;
}

// A body's bottom on a rigid floor at the origin, with friction.
template<class Bound>
void addFloor(scene::Scene& scene, Bound slipBound) {
  const auto floor = std::make_shared<effects::RigidObstacle>(effects::Part{0, "bottom"},
                                                              floorBelow(scene.components() == 3), "floor");
  scene.effects.push_back(floor);
  scene.effects.push_back(std::make_shared<effects::Friction>(floor, slipBound, "friction"));
}

const run::Forces::Of& forceOf(const run::RunReport& report, const std::string& path) {
  for (const run::Forces::Of& effect : report.forces.effects)
    if (effect.path == path)
      return effect;
  throw InternalError("no force of " + path);
}

// Length 1, height h, one cell high, pulled by a force F at its right end; its top stays level.
constexpr double young = 1.0;

// τ, force a length.
double stripResistance(int cells) {
  return 0.08 / cells;
}

scene::Scene strip(int cells, double force) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStress;
  fem::StructuredBlock::Options options;
  options.size = {1.0, 1.0 / cells, 1.0};
  options.subdomains = {4, 1, 1};
  options.elements = {cells / 4, 1, 1};
  scene.bodies.push_back(blockBody("strip", options, fem::Material::isotropic(young, 0.0)));
  prescribe(scene, {0, "top"}, 1, -1e-3 / cells);
  addTraction(scene, {0, "right"}, Point{force * cells, 0, 0});
  addFloor(scene, stripResistance(cells));
  return scene;
}

scene::Scene pulledAndLetGo(int cells, double force, const std::vector<double>& times) {
  scene::Scene scene = strip(cells, force);
  scene.timeline = scene::Timeline(times);
  scene.timeline.add("pull", scene::History({0.0, 1.0, 2.0}, {0.0, 1.0, 0.0}));
  for (const auto& effect : scene.effects)
    if (effect->kind() == "Traction")
      scene.timeline.follow(*effect, "pull");
  return scene;
}

// The largest displacement to the right.
double furthest(const TestRun& run) {
  double most = 0.0;
  for (const std::vector<double>& u : run.solution.displacement)
    for (std::size_t k = 0; k < u.size(); k += 2)
      most = std::max(most, u[k]);
  return globalMax(*testComm(), most);
}

} // namespace

// A bar on a rough floor, force F against a resistance τ a length: it slips over F/τ, and its end moves by
// F²/(2EAτ). Let go again, the slip turns round over half of that, and half of the displacement stays. Both
// errors are of second order: the bar is a row of squares.
TEST(Friction, strip_pulled_and_let_go) {
  std::vector<double> sizes, ofEnd, ofRest;
  for (int cells : {20, 40, 80, 160}) {
    const double resistance = stripResistance(cells), stiffness = young / cells;
    const double force = 0.6 * resistance;
    const TestRun run = runScene(pulledAndLetGo(cells, force, {1.0, 2.0}), 1e-10);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const double end = force * force / (2.0 * stiffness * resistance);
    const TestRun pulled = runScene(strip(cells, force), 1e-10);
    ASSERT_TRUE(pulled.report.converged) << pulled.report.reason;
    // A whole number of cells: the point at the end of the slip sticks, or is about to slip.
    EXPECT_NEAR(static_cast<double>(countOf(pulled.report, run::Friction::Slips)), 0.6 * cells, 1.0);
    EXPECT_EQ(run.report.steps[0].slipping, pulled.report.steps[0].slipping);
    sizes.push_back(1.0 / cells);
    ofEnd.push_back(std::abs(furthest(pulled) / end - 1.0));
    ofRest.push_back(std::abs(furthest(run) / (0.5 * end) - 1.0));
  }
  std::cout << "errors at 160 cells: end " << ofEnd.back() << ", rest " << ofRest.back() << "; rates "
            << fittedRate(sizes, ofEnd) << " and " << fittedRate(sizes, ofRest) << "\n";
  EXPECT_NEAR(fittedRate(sizes, ofEnd), 2.0, 0.2);
  EXPECT_NEAR(fittedRate(sizes, ofRest), 2.0, 0.2);
  EXPECT_LE(ofEnd.back(), 2e-4);
  EXPECT_LE(ofRest.back(), 2e-4);
}

// Of what is pulled into the bar half is stored and half lost, F³/(6EAτ) each; the trapezoidal rule knows the
// work to 1/(4n²) of it in n steps.
TEST(Friction, work_is_stored_or_dissipated) {
  constexpr int cells = 80, steps = 8;
  const double resistance = stripResistance(cells), force = 0.6 * resistance;
  const double half = std::pow(force, 3) / (6.0 * young / cells * resistance);
  std::vector<double> times;
  for (int k = 1; k <= 2 * steps; ++k)
    times.push_back(static_cast<double>(k) / steps);
  const TestRun run = runScene(pulledAndLetGo(cells, force, times), 1e-10);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  const run::StepRow &up = run.report.steps[steps - 1], &down = run.report.steps.back();
  constexpr double ofMesh = 0.02, ofSteps = 0.5 / (steps * steps);
  EXPECT_NEAR(up.dissipated, half, ofMesh * half);
  EXPECT_NEAR(up.energy, half, ofMesh * half);
  EXPECT_NEAR(up.externalWork, up.energy + up.dissipated, ofSteps * up.externalWork);
  EXPECT_NEAR(down.externalWork, down.energy + down.dissipated, ofSteps * up.externalWork);
  for (std::size_t k = 1; k < run.report.steps.size(); ++k)
    EXPECT_GE(run.report.steps[k].dissipated, run.report.steps[k - 1].dissipated);
  EXPECT_GT(down.dissipated, up.dissipated);
}

// A column on a rough floor, its top turned until all of it but the axis slips: M = ∫τ r dA = 2πτR³/3.
TEST(Friction, round_column_twisted) {
  constexpr double radius = 0.5, slipBound = 2e-4;
  const double exact = 2.0 / 3.0 * std::acos(-1.0) * slipBound * std::pow(radius, 3);
  std::vector<double> sizes, errors;
  for (int cells : {4, 6, 8, 12}) {
    scene::Scene scene;
    scene.physics = Physics::Solid;
    fem::StructuredBlock::Options options;
    options.cellType = CellType::Hexahedron8;
    options.origin = {-1, -1, 0};
    options.size = {2, 2, 0.5};
    options.subdomains = {2, 2, 1};
    options.elements = {cells, cells, 2};
    options.map = [](const Point& x) {
      return Point{radius * x[0] * std::sqrt(1.0 - 0.5 * x[1] * x[1]),
                   radius * x[1] * std::sqrt(1.0 - 0.5 * x[0] * x[0]), x[2]};
    };
    // Poisson's ratio is 0: it would not slip around alone, but outwards too.
    scene.bodies.push_back(blockBody("column", options, fem::Material::isotropic(young, 0.0)));
    constexpr double angle = 0.05;
    prescribe(scene, {0, "top"}, 0, [](const Point& x) { return -angle * x[1]; });
    prescribe(scene, {0, "top"}, 1, [](const Point& x) { return angle * x[0]; });
    prescribe(scene, {0, "top"}, 2, -0.01);
    addFloor(scene, slipBound);
    const TestRun run = runScene(scene, 1e-8);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const run::Forces::Of& force = forceOf(run.report, "Obstacle/floor");
    sizes.push_back(1.0 / cells);
    errors.push_back(std::abs(-force.resultant.moment[2] / exact - 1.0));
    EXPECT_LE(countOf(run.report, run::Friction::Sticks), 1);
    EXPECT_TRUE(force.hasFriction);
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_NEAR(force.tangential[d], 0.0, 1e-6 * exact / radius);
    // Ten times the solver's tolerance, of the displacement of the rim.
    expectTrescasLaw(
        run.report, [](const Point&) { return slipBound; }, 1e-7 * angle * radius);
  }
  std::cout << "M/exact - 1 = " << errors.back() << ", rate " << fittedRate(sizes, errors) << "\n";
  // Two, but for the four places where the map makes corners of the disc.
  EXPECT_NEAR(fittedRate(sizes, errors), 1.8, 0.25);
  EXPECT_LE(errors.back(), 1e-3);
}

namespace {

// Code_Aster SSNV128, see design: a square of side 0.04 on a rigid plane.
scene::Scene grecoPlate(const std::function<double(const Point&)>& slipBound) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {0.04, 0.04, 1.0};
  options.subdomains = {4, 2, 1};
  options.elements = {8, 5, 1};
  scene.bodies.push_back(blockBody("plate", options, fem::Material::isotropic(1.3e11, 0.2)));
  prescribe(scene, {0, "right"}, 0);
  addTraction(scene, {0, "top"}, Point{0, -5e7, 0});
  addTraction(scene, {0, "left"}, Point{15e7, 0, 0});
  addFloor(scene, slipBound);
  return scene;
}

} // namespace

// Bounds of pressure, as they come out of solutions with the last ones, settle at Coulomb's law with a
// coefficient of one; frozen there, displacements are the published ones.
TEST(Friction, greco_plate_with_frozen_bounds) {
  std::map<long long, double> pressures; // by micrometres of x
  const auto key = [](double x) { return std::llround(x * 1e6); };
  const auto slipBound = [&](const Point& x) {
    const auto known = pressures.find(key(x[0]));
    return known == pressures.end() ? 5e7 : std::max(0.0, known->second);
  };
  TestRun run;
  double change = 1.0;
  for (int update = 0; update < 60 && change > 1e-9; ++update) {
    run = runScene(grecoPlate(slipBound), 1e-10);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    change = 0.0;
    for (std::size_t k = 0; k < run.report.contact.size(); ++k) {
      double& pressure = pressures[key(run.report.contactPoints[k].position[0])];
      change = std::max(change, std::abs(run.report.contact[k].pressure - pressure) / 1e8);
      pressure = run.report.contact[k].pressure;
    }
  }
  EXPECT_LE(change, 1e-9);
  std::map<long long, double> displacement;
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k + 1 < run.solution.displacement[i].size(); k += 2)
      if (const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / 2)); x[1] == 0.0)
        displacement[key(x[0])] = run.solution.displacement[i][k];
  // Q4, 32 × 10 equal elements.
  const std::map<double, double> published = {{0.0, 2.84594e-5},
                                              {0.00125, 2.70792e-5},
                                              {0.005, 2.27403e-5},
                                              {0.0075, 1.97271e-5},
                                              {0.01125, 1.53642e-5}};
  for (const auto& [x, value] : published) {
    const auto here = displacement.find(key(x));
    const double most = globalMax(*testComm(), here == displacement.end() ? 0.0 : here->second);
    EXPECT_NEAR(most, value, 0.5e-10 + 1e-12) << x;
  }
}

namespace {

// A shoe of length two and height one on the floor, under a weight, pushed by so much of what friction holds.
scene::Scene shoe(double share, const std::string& name = "shoe") {
  constexpr double slipBound = 0.01;
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {2.0, 1.0, 1.0};
  options.subdomains = {2, 2, 1};
  options.elements = {4, 4, 1};
  scene.bodies.push_back(blockBody(name, options, fem::Material::isotropic(young, 0.3)));
  addTraction(scene, {0, "top"}, Point{share * slipBound, -0.05, 0});
  addFloor(scene, slipBound);
  return scene;
}

// A block on a longer one that does not match it, glued to nothing: weight and friction alone hold it.
scene::Scene draggedBlock(double slipBound) {
  scene::Scene scene;
  scene.physics = Physics::Solid;
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Hexahedron8;
  options.size = {2, 2, 1};
  options.subdomains = {2, 2, 1};
  options.elements = {3, 3, 3};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(young, 0.3)));
  options.origin = {0.5, 0.5, 1};
  options.size = {1, 1, 0.5};
  options.elements = {2, 2, 2};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(young, 0.3)));
  for (int c = 0; c < 3; ++c)
    prescribe(scene, {0, "bottom"}, c);
  prescribe(scene, {0, "left"}, 0); // a symmetry plane that meets no contact
  addTraction(scene, {1, "top"}, Point{0.02, 0.01, -0.05});
  effects::SurfacePair pair;
  pair.first = {1, "bottom"};
  pair.second = {0, "top"};
  const auto contact = std::make_shared<effects::Contact>(pair, 0.0, "joint");
  scene.effects.push_back(contact);
  scene.effects.push_back(std::make_shared<effects::Friction>(contact, slipBound));
  return scene;
}

} // namespace

// SSNV503 with a given bound: a body that friction alone holds sticks below it, and slides away above.
TEST(Friction, shoe_sticks_or_slides) {
  const TestRun sticks = runScene(shoe(0.99), 1e-8);
  ASSERT_TRUE(sticks.report.converged) << sticks.report.reason;
  const run::Forces::Of& force = forceOf(sticks.report, "Obstacle/floor");
  EXPECT_NEAR(force.tangential[0], -0.99 * 0.01 * 2.0, 1e-8);
  EXPECT_NEAR(force.normal[1], 0.05 * 2.0, 1e-8);
  EXPECT_GT(countOf(sticks.report, run::Friction::Sticks), 0);
  const TestRun slides = runScene(shoe(1.01, "left shoe"), 1e-8);
  EXPECT_FALSE(slides.report.converged);
  EXPECT_NE(slides.report.reason.find("infeasible"), std::string::npos) << slides.report.reason;
  EXPECT_NE(slides.report.reason.find("left shoe"), std::string::npos) << slides.report.reason;
  // To a millionth of the bound.
  const TestRun barely = runScene(shoe(1.0 - 1e-6), 1e-8);
  EXPECT_TRUE(barely.report.converged) << barely.report.reason;
}

// On any number of ranks, by any method, in FETI and Total FETI, with rows weighted or not.
TEST(Friction, the_way_does_not_matter) {
  const scene::Scene scene = draggedBlock(0.026);
  const TestRun run = runScene(scene, 1e-9);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  EXPECT_GT(countOf(run.report, run::Friction::Sticks), 3);
  EXPECT_GT(countOf(run.report, run::Friction::Slips), 3);
  expectTrescasLaw(
      run.report, [](const Point&) { return 0.026; }, 1e-8);
  EXPECT_LE(run.report.audit.slipError, 1e-8);
  const TestRun alone = runScene(scene, 1e-9, {}, Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)));
  // Energies are known to the square of what displacements are known to.
  EXPECT_NEAR(run.report.audit.energy, alone.report.audit.energy, 1e-12);
  const int products = alone.report.result.counters.hessianApplications;
  EXPECT_NEAR(run.report.result.counters.hessianApplications, products, 0.2 * products);
  for (const std::vector<std::string>& way : std::vector<std::vector<std::string>>{
           {"Solver/Method=SMALBE"},
           {"Decomposition/Dirichlet=dual"},
           {"Dual operator/Expert/Weights=stiffness"},
           {"Dual operator/Form=implicit", "Dual operator/Preconditioner=lumped"}}) {
    const TestRun other = runScene(scene, 1e-9, way);
    ASSERT_TRUE(other.report.converged) << way.front() << ": " << other.report.reason;
    EXPECT_NEAR(other.report.audit.energy, run.report.audit.energy, 1e-12) << way.front();
    EXPECT_LE(largestDifference(other, run), 1e-6) << way.front();
    EXPECT_EQ(countOf(other.report, run::Friction::Slips), countOf(run.report, run::Friction::Slips));
  }
}

// A bound of zero is no friction; a large one a surface that does not slip.
TEST(Friction, limits_of_the_bound) {
  const auto plate = [](double slipBound) {
    return runScene(grecoPlate([slipBound](const Point&) { return slipBound; }), 1e-10);
  };
  scene::Scene without = grecoPlate([](const Point&) { return 0.0; });
  removeEffects(without, "Friction");
  const TestRun none = runScene(without, 1e-10), zero = plate(0.0), all = plate(1e12);
  ASSERT_TRUE(none.report.converged && zero.report.converged && all.report.converged);
  EXPECT_LE(largestDifference(none, zero), 1e-8 * none.report.audit.largestDisplacement);
  EXPECT_EQ(zero.report.audit.frictionWork, 0.0);
  EXPECT_EQ(countOf(all.report, run::Friction::Slips), 0);
  EXPECT_NEAR(all.report.audit.frictionWork, 0.0, 1e-8 * std::abs(all.report.audit.energy));
}

// Nodes that are dragged over the floor by what prescribes their displacement: the force there is known.
TEST(Friction, nodes_that_are_prescribed_slip_too) {
  for (const char* form : {"primal", "dual"}) {
    constexpr double slipBound = 0.01, shift = 0.3;
    scene::Scene scene;
    scene.physics = Physics::PlaneStrain;
    fem::StructuredBlock::Options options;
    options.size = {2.0, 1.0, 1.0};
    options.subdomains = {2, 1, 1};
    options.elements = {4, 4, 1};
    scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(young, 0.3)));
    prescribe(scene, {0, "left"}, 0, -shift);
    addTraction(scene, {0, "top"}, Point{0, -0.05, 0});
    addFloor(scene, slipBound);
    const TestRun run = runScene(scene, 1e-9, {std::string("Decomposition/Dirichlet=") + form});
    ASSERT_TRUE(run.report.converged) << form << ": " << run.report.reason;
    EXPECT_EQ(countOf(run.report, run::Friction::Sticks), 0) << form;
    // The whole of the bound, on the whole length, held by the left side.
    EXPECT_NEAR(forceOf(run.report, "Obstacle/floor").tangential[0], 2.0 * slipBound, 1e-8) << form;
    EXPECT_LE(run.report.forces.balance, 1e-7);
  }
}
