// SPDX-License-Identifier: BSD-3-Clause

/// Bodies at finite displacements whose answer is known: uniform stretch in closed form, across contacts and
/// ties of meshes that do not match; a block that is turned; small loads.

#include "Harmos_Exchange.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_finite_patch {

using namespace Harmos;
using fem::CellType;
using fem::Material;
using fem::Point;
using scene::Physics;

namespace {

constexpr double young = 1.0, poisson = 0.3;
constexpr double lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
                 shear = 0.5 * young / (1 + poisson);
// Of solves and of Newton's iterations. Answers are better than that by the last iteration's contraction, and
// may be worse by the condition of the constraints, some hundred.
constexpr double tolerance = 1e-11, bound = 1e-9;

Material materialOf(Material::Law law) {
  Material material = Material::isotropic(young, poisson);
  material.law = law;
  return material;
}

// First Piola–Kirchhoff stress along an axis for stretches along the axes.
double nominal(Material::Law law, const Point& stretch, std::size_t axis) {
  if (law == Material::Law::NeoHookean)
    return shear * (stretch[axis] - 1.0 / stretch[axis]) +
           lame * std::log(stretch[0] * stretch[1] * stretch[2]) / stretch[axis];
  double trace = 0.0;
  for (const double s : stretch)
    trace += 0.5 * (s * s - 1.0);
  return stretch[axis] * (lame * trace + shear * (stretch[axis] * stretch[axis] - 1.0));
}

// Stretches of a bar that is free along some axes: by bisection, alternating.
Point freeStretches(Material::Law law, Point stretch, const std::vector<std::size_t>& free) {
  for (int sweep = 0; sweep < 200; ++sweep)
    for (const std::size_t axis : free) {
      double low = 0.1, high = 3.0;
      for (int k = 0; k < 100; ++k) {
        stretch[axis] = 0.5 * (low + high);
        (nominal(law, stretch, axis) < 0.0 ? low : high) = stretch[axis];
      }
    }
  return stretch;
}

enum class Joint { Contact, Tie };

// Two blocks, one above the other, of height one each; sides held sideways at the left (and front), the top
// goes down.
scene::Scene tower(CellType lower, CellType upper, Joint joint, Material::Law law, double down) {
  const bool isSpace = fem::shapeOf(lower).dimension == 3;
  const int up = isSpace ? 2 : 1;
  scene::Scene scene;
  scene.physics = isSpace ? Physics::Solid : Physics::PlaneStrain;
  scene.strains = fem::Strains::Finite;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 1, 1};
  options.cellType = lower;
  options.elements = {2, isSpace ? 2 : 3, 2};
  options.map = [isSpace](const Point& x) {
    const auto wave = [](double t) { return std::sin(3.14159265358979323846 * t); };
    Point y = x;
    y[0] += 0.04 * wave(x[0]) * wave(isSpace ? x[2] : x[1]);
    return y;
  };
  scene.bodies.push_back(blockBody("lower", options, materialOf(law)));
  options.cellType = upper;
  options.elements = {3, isSpace ? 3 : 2, 2};
  options.origin[static_cast<std::size_t>(up)] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, materialOf(law)));
  for (int body : {0, 1}) {
    prescribe(scene, {body, "left"}, 0);
    if (isSpace)
      prescribe(scene, {body, "front"}, 1);
  }
  prescribe(scene, {0, "bottom"}, up);
  prescribe(scene, {1, "top"}, up, -down);
  if (joint == Joint::Contact)
    addContact(scene, {0, "top"}, {1, "bottom"});
  else
    addTie(scene, {0, "top"}, {1, "bottom"});
  return scene;
}

double forceOn(const run::RunReport& report, const std::string& path, std::size_t component) {
  for (const run::Forces::Of& effect : report.forces.effects)
    if (effect.path == path)
      return effect.resultant.force[component];
  ADD_FAILURE() << "no force of " << path;
  return 0.0;
}

void expectUniform(const scene::Scene& scene, Material::Law law, double down, Joint joint,
                   const std::string& what) {
  SCOPED_TRACE(what);
  const bool isSpace = scene.physics == Physics::Solid;
  const std::size_t up = isSpace ? 2 : 1;
  Point stretch = {1.0, 1.0, 1.0};
  stretch[up] = 1.0 - 0.5 * down;
  stretch =
      freeStretches(law, stretch, isSpace ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{0});
  const double force = nominal(law, stretch, up); // of an area of one at rest
  const TestRun run = runScene(scene, tolerance);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  double worst = 0.0;
  const auto m = static_cast<std::size_t>(scene.components());
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / m));
      worst = std::max(worst, std::abs(run.solution.displacement[i][k] - (stretch[k % m] - 1.0) * x[k % m]));
    }
  EXPECT_LE(globalMax(*testComm(), worst), bound);
  EXPECT_NEAR(forceOn(run.report, joint == Joint::Contact ? "Contact/1" : "Tie/1", up), force, bound);
  const double cauchy = force / (stretch[0] * (isSpace ? stretch[1] : 1.0));
  for (const run::ContactState& state : run.report.contact)
    EXPECT_NEAR(state.pressure, -cauchy, bound);
}

} // namespace

TEST(FinitePatch, uniform_stretch_across_interfaces) {
  const std::vector<std::pair<CellType, CellType>> pairs = {
      {CellType::Triangle3, CellType::Quadrilateral4},
      {CellType::Quadrilateral4, CellType::Triangle6},
      {CellType::Triangle6, CellType::Triangle3},
      {CellType::Quadrilateral9, CellType::Quadrilateral8},
      {CellType::Quadrilateral8, CellType::Quadrilateral9},
      {CellType::Hexahedron8, CellType::Tetrahedron4},
      {CellType::Tetrahedron10, CellType::Hexahedron8},
      {CellType::Tetrahedron4, CellType::Tetrahedron10},
      {CellType::Hexahedron20, CellType::Hexahedron27},
      {CellType::Hexahedron27, CellType::Wedge15},
      {CellType::Wedge6, CellType::Hexahedron20},
      {CellType::Wedge15, CellType::Wedge18},
      {CellType::Wedge18, CellType::Wedge6}};
  constexpr double down = 0.4;
  for (const auto& [lower, upper] : pairs)
    for (const Joint joint : {Joint::Contact, Joint::Tie})
      for (const Material::Law law : {Material::Law::Linear, Material::Law::NeoHookean}) {
        const bool isSpace = fem::shapeOf(lower).dimension == 3;
        if (isSpace && (joint == Joint::Contact) != (law == Material::Law::NeoHookean))
          continue; // half of them, for time
        expectUniform(tower(lower, upper, joint, law, down), law, down, joint,
                      fem::shapeOf(lower).name + " under " + fem::shapeOf(upper).name);
      }
}

// A block whose left side is turned by 90° about the origin, in one step, follows without stress, in any law.
TEST(FinitePatch, turned_block) {
  for (const CellType type : {CellType::Quadrilateral4, CellType::Triangle6, CellType::Hexahedron8})
    for (const Material::Law law : {Material::Law::Linear, Material::Law::NeoHookean}) {
      SCOPED_TRACE(fem::shapeOf(type).name);
      scene::Scene scene;
      const bool isSpace = fem::shapeOf(type).dimension == 3;
      scene.physics = isSpace ? Physics::Solid : Physics::PlaneStrain;
      scene.strains = fem::Strains::Finite;
      fem::StructuredBlock::Options options;
      options.cellType = type;
      options.subdomains = {2, 2, 1};
      options.elements = {3, 2, 2};
      scene.bodies.push_back(blockBody("block", options, materialOf(law)));
      prescribe(scene, {0, "left"}, 0, [](const Point& x) { return -x[1] - x[0]; });
      prescribe(scene, {0, "left"}, 1, [](const Point& x) { return x[0] - x[1]; });
      if (isSpace)
        prescribe(scene, {0, "left"}, 2);
      const TestRun run = runScene(scene, 1e-12);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      double worst = 0.0;
      const auto m = static_cast<std::size_t>(scene.components());
      for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
        const fem::Mesh& mesh = *run.solution.owned[i].mesh.mesh;
        for (int node = 0; node < mesh.numberOfNodes(); ++node) {
          const Point x = run.solution.owned[i].mesh.position(node);
          const double* u = run.solution.displacement[i].data() + static_cast<std::size_t>(node) * m;
          worst = std::max({worst, std::abs(u[0] + x[1] + x[0]), std::abs(u[1] - x[0] + x[1])});
        }
      }
      EXPECT_LE(globalMax(*testComm(), worst), 1e-10);
      // Stress in units of E: forces of the supports, by areas of one.
      for (const run::Forces::Of& effect : run.report.forces.effects)
        for (const double component : effect.resultant.force)
          EXPECT_LE(std::abs(component), 1e-10);
    }
}

// The answer to a small load is that of small displacements, but for a share that goes with the load.
TEST(FinitePatch, small_loads) {
  const auto answer = [](double load, fem::Strains strains) {
    scene::Scene scene;
    scene.physics = Physics::PlaneStrain;
    scene.strains = strains;
    fem::StructuredBlock::Options options;
    options.subdomains = {4, 1, 1};
    options.elements = {4, 4, 1};
    options.size = {4.0, 1.0, 1.0};
    options.cellType = CellType::Quadrilateral4;
    scene.bodies.push_back(blockBody("beam", options, materialOf(Material::Law::Linear)));
    options.origin = {2.6, -1.0, 0.0}; // no node comes over its edge
    options.size = {1.7, 1.0, 1.0};
    options.subdomains = {1, 1, 1};
    options.elements = {5, 4, 1};
    scene.bodies.push_back(blockBody("support", options, materialOf(Material::Law::NeoHookean)));
    for (int component : {0, 1}) {
      prescribe(scene, {0, "left"}, component);
      prescribe(scene, {1, "bottom"}, component);
    }
    addTraction(scene, {0, "top"}, {0.3 * load, -load, 0.0});
    addContact(scene, {0, "bottom"}, {1, "top"});
    const TestRun run = runScene(scene, tolerance);
    EXPECT_TRUE(run.report.converged) << run.report.reason;
    std::vector<double> values;
    for (const std::vector<double>& part : run.solution.displacement)
      for (const double value : part)
        values.push_back(value / load);
    for (std::size_t d : {0U, 1U})
      values.push_back(forceOn(run.report, "Contact/1", d) / load);
    return values;
  };
  const std::vector<double> small = answer(1e-5, fem::Strains::Small);
  std::vector<double> loads = {1e-5, 1e-4, 1e-3, 1e-2}, errors;
  for (const double load : loads) {
    const std::vector<double> finite = answer(load, fem::Strains::Finite);
    double worst = 0.0, size = 0.0;
    for (std::size_t k = 0; k < small.size(); ++k) {
      worst = std::max(worst, std::abs(finite[k] - small[k]));
      size = std::max(size, std::abs(small[k]));
    }
    errors.push_back(globalMax(*testComm(), worst) / globalMax(*testComm(), size));
  }
  const double rate = fittedRate(loads, errors);
  EXPECT_GT(rate, 0.9);
  EXPECT_LT(rate, 1.1);
  EXPECT_LT(errors.front(), 1e-3);
}

// Of an application's own, say.
class UnknownEffect : public scene::Effect {
 public:
  UnknownEffect() : Effect("Unknown", "own") {}
};

TEST(FinitePatch, what_does_not_go_with_it_is_told) {
  scene::Scene scene =
      tower(CellType::Quadrilateral4, CellType::Quadrilateral4, Joint::Contact, Material::Law::Linear, 0.1);
  scene.effects.push_back(std::make_shared<UnknownEffect>());
  EXPECT_NE(failureOf(scene).find("does not work with \"Model/Kinematics\" = \"finite\""), std::string::npos);
}

} // namespace test_finite_patch
