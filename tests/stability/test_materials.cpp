// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of materials.
///
///  - Jumps across and along interfaces: with scaling by multiplicity the preconditioner averages jumps with
///    equal weights, and its condition grows with the ratio of the moduli; with an absolute regularisation
///    the digits of soft parts are wiped out. Cure: scaling by the diagonal of K (Klawonn, Widlund 2001,
///    Comm. Pure Appl. Math. 54; Rixen, Farhat 1999, IJNME 44), regularisation weighted by it.
///  - Nearly incompressible: elements of the first order lock as ν → 1/2. Cure: projected dilatation, B-bar
///    (Hughes 1980, IJNME 15).

#include "Harmos_HardCase.hpp"
#include "Harmos_PlateMesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numeric>

using namespace Harmos;
using fem::Point;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem.
constexpr double tolerance = 1e-10;

double products(const scene::RunReport& report) {
  return report.result.counters.hessianApplications;
}

int place(double x, int n) {
  return std::min(n - 1, static_cast<int>(x * n));
}

// A plate of n × n cells on a floor, held sideways at its left, pressed and drawn; cut into subdomains, with
// a modulus for each region.
scene::Scene plate(int n, const std::function<int(const Point&)>& part,
                   const std::function<int(const Point&)>& region, const std::vector<double>& moduli) {
  fem::StructuredBlock::Options options;
  options.elements = {n, n, 1};
  fem::BodyMesh body = wholeBlock(options);
  body.mesh.regions = cellsBy(body.mesh, region);
  std::vector<fem::Material> materials;
  for (double modulus : moduli)
    materials.push_back(fem::Material::isotropic(modulus, 0.3));
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  long long next = 0;
  scene.bodies.push_back(tornBody(body, cellsBy(body.mesh, part), next, materials));
  prescribe(scene, {0, "left"}, 0);
  addTraction(scene, {0, "top"}, {0.0, -0.01, 0.0});
  addTraction(scene, {0, "right"}, {0.005, 0.005, 0.0});
  contact::Obstacle floor;
  floor.direction = {0.0, 1.0, 0.0};
  addObstacle(scene, {0, "bottom"}, floor);
  return scene;
}

void study(const std::string& name, const scene::Scene& scene) {
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* scaling : {"stiffness", "multiplicity"}) {
    const TestRun run = runScene(scene, tolerance, {std::string("Dual operator/Scaling=") + scaling});
    const Deviation off = deviation(reference, run);
    const std::string what = name + ", " + scaling;
    tellFigure(what + ": converged", run.report.converged);
    tellFigure(what + ": agrees", scene::auditAgrees(run.report));
    tellFigure(what + ": products", products(run.report));
    tellFigure(what + ": displacement", off.displacement);
    tellFigure(what + ": force", off.force);
    tellFigure(what + ": energy", off.energy);
    tellFigure(what + ": condition", run.report.localCondition);
    if (!run.report.converged && testComm()->getRank() == 0)
      std::cout << run.report.reason << std::endl;
  }
}

} // namespace

TEST(Stability, material_jump_across_interfaces) {
  const auto squares = [](const Point& x) { return 3 * place(x[1], 3) + place(x[0], 3); };
  for (double jump : {1.0, 1e2, 1e4, 1e6})
    study("jump " + std::to_string(jump),
          plate(9, squares, [&](const Point& x) { return squares(x) % 2; }, {1.0, jump}));
  study("1e-3 to 1e9",
        plate(9, squares, [&](const Point& x) { return squares(x) % 4; }, {1.0, 1e9, 1e-3, 1e3}));
}

TEST(Stability, material_jump_along_interfaces) {
  const auto squares = [](const Point& x) { return 3 * place(x[1], 3) + place(x[0], 3); };
  // Layers of a third of a subdomain.
  for (double jump : {1.0, 1e2, 1e4, 1e6})
    study("jump " + std::to_string(jump),
          plate(9, squares, [&](const Point& x) { return place(x[1], 9) % 2; }, {1.0, jump}));
  study("1e-3 to 1e9",
        plate(9, squares, [&](const Point& x) { return place(x[1], 9) % 4; }, {1.0, 1e9, 1e-3, 1e3}));
}

namespace {

// A block that is pushed up by its bottom against a rigid cylinder, its sides held: force of the contact.
scene::Scene pressed(int n, double poisson, fem::Dilatation dilatation) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {n / 2, n / 2, 1};
  scene.bodies.push_back(blockBody("rubber", options, fem::Material::isotropic(1.0, poisson)));
  scene.bodies[0].dilatation = dilatation;
  prescribe(scene, {0, "left"}, 0);
  for (int component : {0, 1})
    prescribe(scene, {0, "bottom"}, component, component == 1 ? 0.05 : 0.0);
  contact::Obstacle punch;
  punch.shape = contact::Obstacle::Shape::Cylinder;
  punch.direction = {0.0, 0.0, 1.0};
  punch.radius = 1.0;
  punch.point = {0.5, 2.0, 0.0};
  addObstacle(scene, {0, "top"}, punch);
  return scene;
}

double total(const std::vector<double>& forces) {
  return std::accumulate(forces.begin(), forces.end(), 0.0);
}

} // namespace

TEST(Stability, nearly_incompressible) {
  for (double poisson : {0.3, 0.49, 0.4999}) {
    const double fine = total(referenceSolution(pressed(16, poisson, fem::Dilatation::Projected)).force);
    for (fem::Dilatation dilatation : {fem::Dilatation::Projected, fem::Dilatation::Full}) {
      const scene::Scene scene = pressed(8, poisson, dilatation);
      const ReferenceSolution reference = referenceSolution(scene);
      ASSERT_TRUE(reference.solvable);
      const TestRun run = runScene(scene, tolerance);
      const std::string name = std::string(dilatation == fem::Dilatation::Full ? "full" : "projected") +
                               ", " + std::to_string(poisson);
      tellFigure("products, " + name, products(run.report));
      tellFigure("deviation, " + name, deviation(reference, run).largest());
      tellFigure("condition, " + name, run.report.localCondition);
      tellFigure("force over fine mesh's, " + name, total(reference.force) / fine);
      tellFigure("converged, " + name, run.report.converged);
    }
  }
}
