// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of materials.
///
///  - Jumps across and along interfaces: with scaling by multiplicity the preconditioner averages jumps with
///    equal weights, and its condition grows with the ratio of the moduli; with an absolute regularisation
///    the digits of soft parts are wiped out. Cure: scaling by the diagonal of K (Klawonn, Widlund 2001,
///    Comm. Pure Appl. Math. 54; Rixen, Farhat 1999, IJNME 44), regularisation weighted by it.
///  - Jumps within subdomains: a diagonal cannot weigh them. Cure: adaptive coarse vectors (Spillane, Rixen
///  2013, IJNME 95).
///  - Thin and nearly incompressible solids: condensed inverses lose what rounding leaves of bending. Cure:
///  solves in
///    their place; and an end that names the cause where K itself has lost it.
///  - Nearly incompressible: elements of the first order lock as ν → 1/2. Cure: projected dilatation, B-bar
///    (Hughes 1980, IJNME 15).

#include "Harmos_Exchange.hpp"
#include "Harmos_HardCase.hpp"
#include "Harmos_PlateMesh.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

using namespace Harmos;
using fem::Point;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem.
constexpr double tolerance = 1e-10;

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
  addObstacle(scene, {0, "bottom"}, halfSpace({}, {0.0, 1.0, 0.0}));
  return scene;
}

// Reached with weighted rows; without, though the preconditioner is scaled by stiffness, only in so many more
// products, where no directions are kept that would make up for it.
void expectJump(const scene::Scene& scene, double ratio, const std::string& name, double factor) {
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  // K itself is known to ε of its stiffest entries, which stand beside soft ones.
  const double bound = 1e3 * tolerance + 100 * std::numeric_limits<double>::epsilon() * ratio;
  const TestRun run = runScene(scene, tolerance); // weights are chosen where materials differ
  expectReference(reference, run, bound, name);
  tellFigure(name + ": products", products(run.report));
  tellFigure(name + ": deviation", deviation(reference, run).largest());
  const auto most = static_cast<int>(factor * products(run.report));
  const TestRun off = runScene(scene, tolerance,
                               {"Dual operator/Expert/Weights=none", "Solver/Expert/PDAS/Kept directions=0",
                                "Solver/Maximum iterations=" + std::to_string(most)});
  if (factor > 1.0)
    EXPECT_FALSE(off.report.converged) << name;
}

} // namespace

TEST(Stability, material_jump_across_interfaces) {
  const auto squares = [](const Point& x) { return 3 * place(x[1], 3) + place(x[0], 3); };
  const auto black = [&](const Point& x) { return squares(x) % 2; };
  for (const auto& [jump, factor] : {std::make_pair(1.0, 1.0), {1e2, 1.0}, {1e4, 2.0}, {1e6, 2.0}})
    expectJump(plate(9, squares, black, {1.0, jump}), jump, "1 to " + std::to_string(static_cast<int>(jump)),
               factor);
  const auto four = [&](const Point& x) { return squares(x) % 4; };
  expectJump(plate(6, squares, four, {1.0, 1e9, 1e-3, 1e3}), 1e12, "1e-3 to 1e9", 2.0);
}

TEST(Stability, material_jump_along_interfaces) {
  const auto squares = [](const Point& x) { return 3 * place(x[1], 3) + place(x[0], 3); };
  const auto layers = [](const Point& x) { return place(x[1], 9) % 2; }; // a third of a subdomain each
  for (const auto& [jump, factor] : {std::make_pair(1.0, 1.0), {1e2, 1.0}, {1e4, 2.0}, {1e6, 2.0}})
    expectJump(plate(9, squares, layers, {1.0, jump}), jump, "1 to " + std::to_string(static_cast<int>(jump)),
               factor);
  const auto four = [](const Point& x) { return place(x[1], 6) % 4; }; // half a subdomain each
  expectJump(plate(6, squares, four, {1.0, 1e9, 1e-3, 1e3}), 1e12, "1e-3 to 1e9", 2.0);
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
    const double fine = total(referenceSolution(pressed(12, poisson, fem::Dilatation::Projected)).force);
    const std::string name = "nu = " + std::to_string(poisson);
    for (fem::Dilatation dilatation : {fem::Dilatation::Projected, fem::Dilatation::Full}) {
      const bool locks = dilatation == fem::Dilatation::Full;
      const scene::Scene scene = pressed(8, poisson, dilatation);
      const ReferenceSolution reference = referenceSolution(scene);
      ASSERT_TRUE(reference.solvable);
      const std::string which = name + (locks ? ", full" : "");
      const TestRun run = runScene(scene, tolerance);
      expectReference(reference, run, 1e3 * tolerance, which);
      double force = 0.0;
      for (const run::ContactState& state : run.report.contact)
        force += state.force;
      if (!locks)
        EXPECT_NEAR(force, fine, 0.05 * fine) << which; // the error of the mesh
      else if (poisson > 0.499)
        EXPECT_GT(force, 3.0 * fine) << which;
      tellFigure(which + ": products", products(run.report));
      tellFigure(which + ": deviation", deviation(reference, run).largest());
      tellFigure(which + ": force over that of the fine mesh", force / fine);
    }
  }
}

TEST(Stability, material_jump_within_subdomains) {
  // Channels one cell wide, across all cuts and each other.
  const auto squares = [](const Point& x) { return 4 * place(x[1], 4) + place(x[0], 4); };
  const auto channels = [](const Point& x) {
    return place(x[0], 16) % 4 == 1 || place(x[1], 16) % 4 == 2 ? 1 : 0;
  };
  for (double jump : {1e-4, 1.0, 1e6}) {
    const scene::Scene scene = plate(16, squares, channels, {1.0, jump});
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    // Rounding of K, see expectJump().
    const double rounding = 100 * std::numeric_limits<double>::epsilon() * std::max(jump, 1.0 / jump);
    std::ostringstream name;
    name << "1 to " << jump;
    const TestRun with = runScene(scene, tolerance, {"Dual operator/Expert/Adaptive coarse vectors=all"});
    const TestRun without = runScene(
        scene, tolerance,
        {"Dual operator/Expert/Adaptive coarse vectors=none", "Solver/Expert/PDAS/Kept directions=0"});
    expectReference(reference, with, 1e3 * tolerance + rounding, name.str());
    if (jump < 1.0)
      EXPECT_GE(products(without.report), 3.0 * products(with.report));
    tellFigure(name.str() + ": products", products(with.report));
    tellFigure(name.str() + ": products without", products(without.report));
    tellFigure(name.str() + ": vectors", with.report.adaptiveVectors);
    tellFigure(name.str() + ": deviation", deviation(reference, with).largest());
  }
}

namespace {

// A foil that is held at its left and bent by a load: four by four cells, one thick, nearly incompressible.
scene::Scene foil(double thickness, fem::CellType type = fem::CellType::Hexahedron8, int elements = 2) {
  scene::Scene scene;
  scene.physics = Physics::Solid;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.subdomains = {2, 2, 1};
  options.elements = {elements, elements, 1};
  options.size = {1.0, 1.0, thickness};
  scene.bodies.push_back(blockBody("foil", options, fem::Material::isotropic(1.0, 0.4999)));
  prescribe(scene, {0, "left"}, 0);
  prescribe(scene, {0, "left"}, 2);
  prescribe(scene, {0, "front"}, 1);
  addTraction(scene, {0, "top"}, {0.0, 0.0, -1e-6 * thickness * thickness * thickness});
  return scene;
}

} // namespace

TEST(Stability, thin_and_nearly_incompressible_solid) {
  constexpr double loose = 1e-4;
  for (double thickness : {1e-2, 2e-4}) {
    const scene::Scene scene = foil(thickness);
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    const TestRun run = runScene(scene, loose, {"Dual operator/Form=condensed"});
    std::ostringstream name;
    name << "1 to " << thickness;
    expectReference(reference, run, 100 * loose, name.str()); // what the audit promises
    tellFigure(name.str() + ": products", products(run.report));
    tellFigure(name.str() + ": condition", run.report.localCondition);
    tellFigure(name.str() + ": deviation", deviation(reference, run).largest());
  }
  // On linear tetrahedra condensed inverses are not exact enough, and solves take their place.
  constexpr double thin = 3e-4;
  const scene::Scene tetrahedra = foil(thin, fem::CellType::Tetrahedron4, 1);
  feti::LocalInverseOptions condensed;
  condensed.form = feti::DualForm::Condensed;
  const TestFeti feti(modelOf(tetrahedra), feti::DirichletForm::Dual, condensed);
  EXPECT_GT(globalSum(*testComm(), static_cast<long long>(feti.inverses.replacedFactorizations())), 0);
  EXPECT_LE(globalMax(*testComm(), feti.inverses.defect()), 1e-8);
  // c ε κ, κ of a plate: the square of length over thickness, times bulk over shear modulus, 1/(1 − 2ν)
  // about.
  const double rounding =
      10.0 * std::numeric_limits<double>::epsilon() / (thin * thin) / (1.0 - 2.0 * 0.4999);
  const ReferenceSolution reference = referenceSolution(tetrahedra);
  const TornRun solved = solveTorn(feti, tolerance);
  expectReference(reference, solved, 1e3 * tolerance + rounding, "tetrahedra");
  tellFigure("tetrahedra: products", products(solved.report));
  tellFigure("tetrahedra: deviation", deviation(reference, solved).largest());
  // Of less than κε no solver can know: the run says so when it gives up.
  const TestRun tight = runScene(foil(3e-4), 1e-2 * tolerance, {"Solver/Maximum iterations=300"});
  EXPECT_FALSE(tight.report.converged);
  EXPECT_TRUE(contains(tight.report.reason, "attainable accuracy: rounding errors of a subdomain's matrix"))
      << tight.report.reason;
  // Thinner still, and K itself does not tell bending from rigid motion.
  const std::string text = numericalErrorOf([&] { runScene(foil(1e-4), loose); });
  EXPECT_TRUE(contains(text, "attainable accuracy: the matrix of a subdomain") &&
              contains(text, "body \"foil\""))
      << text;
}
