// SPDX-License-Identifier: BSD-3-Clause

/// Contact patch tests: two blocks on top of each other under a constant pressure, with meshes that match and
/// that do not, must answer with constant strain and constant contact pressure; and the tied ring of Lamé.

#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace Harmos;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

constexpr double pressure = 0.01;
// Of the solver; the answers may be wrong by the condition of the constraints times it.
constexpr double tolerance = 1e-13;

enum class Joint { Contact, Tie };

// Two blocks, the lower one [0,1]² × [0,1], the upper one above it; the left (and front) sides held sideways,
// the bottom held upward, a pressure on top. The upper block is held by the interface alone.
scene::Scene tower(CellType lower, CellType upper, const std::array<int, 3>& lowerElements,
                   const std::array<int, 3>& upperElements, Joint joint, double tilt) {
  const bool isSpace = fem::shapeOf(lower).dimension == 3;
  const int up = isSpace ? 2 : 1;
  scene::Scene scene;
  scene.physics = isSpace ? Physics::Solid : Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, isSpace ? 1 : 2, 1};
  options.cellType = lower;
  options.elements = lowerElements;
  // Inner nodes move, those of the sides stay in them.
  options.map = [tilt, isSpace](const Point& x) {
    const auto wave = [](double t) { return std::sin(3.14159265358979323846 * t); };
    Point y = x;
    y[0] += tilt * wave(x[0]) * wave(isSpace ? x[2] : x[1]);
    return y;
  };
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.cellType = upper;
  options.elements = upperElements;
  options.origin[static_cast<std::size_t>(up)] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  for (int body : {0, 1}) {
    prescribe(scene, {body, "left"}, 0);
    if (isSpace)
      prescribe(scene, {body, "front"}, 1);
  }
  prescribe(scene, {0, "bottom"}, up);
  Point down{};
  down[static_cast<std::size_t>(up)] = -pressure;
  addTraction(scene, {1, "top"}, down);
  if (joint == Joint::Contact)
    addContact(scene, {0, "top"}, {1, "bottom"});
  else
    addTie(scene, {0, "top"}, {1, "bottom"});
  return scene;
}

// Uniaxial stress: σ = −p upward, nothing else but σ_zz = −νp in plane strain.
void expectConstantStrain(const scene::Scene& scene, const TestRun& run, const std::string& what) {
  const double nu = 0.3, young = 1.0;
  const bool isSpace = scene.physics == Physics::Solid;
  const double down = isSpace ? -pressure / young : -pressure * (1 - nu * nu) / young;
  const double aside = isSpace ? nu * pressure / young : pressure * nu * (1 + nu) / young;
  EXPECT_TRUE(run.report.converged) << what << ": " << run.report.reason;
  double worst = 0.0;
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
      const auto m = static_cast<std::size_t>(scene.components());
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / m));
      const double exact = k % m + 1 == m ? down * x[k % m] : aside * x[k % m];
      worst = std::max(worst, std::abs(run.solution.displacement[i][k] - exact));
    }
  EXPECT_LE(globalMax(*testComm(), worst), 1e-10 * pressure * 2.0) << what;
  for (const run::ContactState& state : run.report.contact)
    EXPECT_NEAR(state.pressure, pressure, 1e-10 * pressure) << what;
}

} // namespace

TEST(ContactPatch, matching_meshes) {
  for (CellType type : {CellType::Triangle3, CellType::Quadrilateral4, CellType::Hexahedron8,
                        CellType::Tetrahedron4, CellType::Wedge6})
    for (double tilt : {0.0, 0.05}) {
      const scene::Scene scene = tower(type, type, {2, 2, 3}, {2, 2, 3}, Joint::Contact, tilt);
      expectConstantStrain(scene, runScene(scene, tolerance), fem::shapeOf(type).name);
    }
}

TEST(ContactPatch, matching_meshes_of_the_second_order) {
  for (CellType type :
       {CellType::Triangle6, CellType::Quadrilateral9, CellType::Hexahedron27, CellType::Tetrahedron10,
        CellType::Quadrilateral8, CellType::Hexahedron20, CellType::Wedge15, CellType::Wedge18}) {
    const scene::Scene scene = tower(type, type, {2, 2, 2}, {2, 2, 2}, Joint::Contact, 0.03);
    expectConstantStrain(scene, runScene(scene, tolerance), fem::shapeOf(type).name);
  }
}

TEST(ContactPatch, meshes_that_do_not_match) {
  const std::vector<std::pair<CellType, CellType>> pairs = {
      {CellType::Quadrilateral4, CellType::Quadrilateral4},
      {CellType::Quadrilateral4, CellType::Triangle3},
      {CellType::Quadrilateral9, CellType::Quadrilateral9},
      {CellType::Quadrilateral9, CellType::Triangle3},
      {CellType::Hexahedron8, CellType::Hexahedron8},
      {CellType::Hexahedron8, CellType::Tetrahedron4},
      {CellType::Tetrahedron4, CellType::Hexahedron8},
      {CellType::Hexahedron20, CellType::Tetrahedron10}};
  for (const auto& [lower, upper] : pairs)
    for (Joint joint : {Joint::Contact, Joint::Tie}) {
      const scene::Scene scene = tower(lower, upper, {2, 3, 2}, {3, 2, 2}, joint, 0.05);
      expectConstantStrain(scene, runScene(scene, tolerance),
                           fem::shapeOf(lower).name + " under " + fem::shapeOf(upper).name);
    }
}

// A rigid floor bears a constant pressure, whatever forces at nodes that has: at corners of serendipity
// elements they pull.
TEST(ContactPatch, on_a_rigid_floor) {
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Triangle6, CellType::Quadrilateral8, CellType::Tetrahedron10,
        CellType::Hexahedron8, CellType::Hexahedron27, CellType::Hexahedron20, CellType::Wedge15}) {
    scene::Scene scene = tower(type, type, {2, 3, 2}, {3, 2, 2}, Joint::Tie, 0.03);
    const auto effects = scene.effects;
    scene.effects.clear();
    // All but the support of the bottom.
    for (const auto& effect : effects)
      if (effect->boundaryParts().front().set != "bottom" || effect->tiesSurfaces())
        scene.effects.push_back(effect);
    contact::Obstacle floor;
    floor.direction = scene.components() == 3 ? Point{0.0, 0.0, 1.0} : Point{0.0, 1.0, 0.0};
    addObstacle(scene, {0, "bottom"}, floor);
    const TestRun run = runScene(scene, tolerance);
    expectConstantStrain(scene, run, fem::shapeOf(type).name + " on a floor");
    EXPECT_GE(globalSum(*testComm(), static_cast<long long>(run.report.contact.size())), 5);
  }
}

// The same contact named twice, once with the surfaces exchanged, is one contact.
TEST(ContactPatch, contact_that_is_named_twice) {
  const CellType type = CellType::Quadrilateral4;
  scene::Scene scene = tower(type, type, {2, 2, 1}, {2, 2, 1}, Joint::Contact, 0.0);
  const long long once = runScene(scene, tolerance).report.inequalities;
  addContact(scene, {1, "bottom"}, {0, "top"}, 0.5); // the smaller gap counts
  addContact(scene, {0, "top"}, {1, "bottom"});
  const TestRun run = runScene(scene, tolerance);
  EXPECT_EQ(run.report.inequalities, once);
  expectConstantStrain(scene, run, "named twice");
}

// A plate that is held all over, tied onto a block that is held at its side: wherever the plate is the first
// surface or the second, the block follows it. Rows of the tie are left out only where both end on held
// sides.
TEST(ContactPatch, tie_to_a_plate_that_is_held) {
  const double shift = 0.01;
  std::vector<double> energies;
  for (bool plateFirst : {false, true}) {
    scene::Scene scene =
        tower(CellType::Quadrilateral4, CellType::Quadrilateral4, {3, 2, 1}, {4, 2, 1}, Joint::Tie, 0.0);
    scene.effects.clear();
    for (int component : {0, 1}) {
      prescribe(scene, {0, "bottom"}, component);
      prescribe(scene, {1, "bottom"}, component, component == 0 ? shift : 0.0);
    }
    prescribe(scene, {0, "left"}, 1);
    if (plateFirst)
      addTie(scene, {1, "bottom"}, {0, "top"});
    else
      addTie(scene, {0, "top"}, {1, "bottom"});
    const TestRun run = runScene(scene, tolerance);
    EXPECT_TRUE(run.report.converged);
    double worst = 0.0;
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
      if (const auto top = run.solution.owned[i].mesh.sets.find("top");
          run.solution.owned[i].body == 0 && top != run.solution.owned[i].mesh.sets.end())
        for (int node : top->second)
          for (std::size_t c = 0; c < 2; ++c)
            worst = std::max(worst,
                             std::abs(run.solution.displacement[i][2 * static_cast<std::size_t>(node) + c] -
                                      (c == 0 ? shift : 0.0)));
    EXPECT_LE(globalMax(*testComm(), worst), 1e-9 * shift) << plateFirst;
    energies.push_back(run.report.audit.energy);
  }
  EXPECT_NEAR(energies[0], energies[1], 1e-9 * energies[0]);
}

// What is prescribed cannot be changed by contact or ties: scenes that ask for it are refused, whatever the
// form of the Dirichlet conditions.
TEST(ContactPatch, prescribed_displacements_that_contradict_contact_or_ties) {
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 1};
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  // The height that the bottom is held at, and that of the floor.
  const auto onFloor = [&](double height, double floorHeight) {
    scene.effects.clear();
    prescribe(scene, {0, "bottom"}, 1, height);
    prescribe(scene, {0, "bottom"}, 0);
    contact::Obstacle floor;
    floor.point[1] = floorHeight;
    floor.direction = {0.0, 1.0, 0.0};
    addObstacle(scene, {0, "bottom"}, floor);
  };
  onFloor(-0.1, 0.0);
  for (const char* form : {"primal", "dual"}) {
    const std::string text =
        inputErrorOf([&] { runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form}); });
    EXPECT_TRUE(contains(text, "contradict a contact or an obstacle")) << text;
  }
  onFloor(0.1, 0.0); // above it
  EXPECT_TRUE(runScene(scene, tolerance).report.converged);
  // On the floor, up to rounding of its height: that is no contradiction.
  for (double height : {1e-16, -1e-16}) {
    onFloor(0.0, height);
    EXPECT_TRUE(runScene(scene, tolerance).report.converged);
  }

  scene::Scene tied =
      tower(CellType::Quadrilateral4, CellType::Quadrilateral4, {2, 2, 1}, {2, 2, 1}, Joint::Tie, 0.0);
  removeEffects(tied, "Prescribed displacement");
  prescribe(tied, {0, "left"}, 0);
  prescribe(tied, {0, "bottom"}, 1);
  prescribe(tied, {1, "left"}, 0, 0.1);
  const std::string text = inputErrorOf([&] { runScene(tied, tolerance); });
  EXPECT_TRUE(contains(text, "a tie contradicts prescribed displacements")) << text;
}

// A contact row whose node is held in one component: the prescribed share belongs to the gap. A block is
// pushed by its held top, u_y = −0.02, onto a floor that leans by 45°, and slides sideways: x + y ≥ 0 below
// it.
TEST(ContactPatch, prescribed_share_of_a_contact_row) {
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {2, 2, 1};
  scene::Scene scene;
  scene.physics = Physics::PlaneStress;
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.0)));
  for (const char* set : {"left", "right", "bottom", "top"}) // rigid in y
    prescribe(scene, {0, set}, 1, -0.02);
  contact::Obstacle ramp;
  ramp.direction = {1.0, 1.0, 0.0};
  addObstacle(scene, {0, "left"}, ramp);
  addTraction(scene, {0, "right"}, Point{-0.001, 0, 0});
  for (const char* form : {"primal", "dual"}) {
    const TestRun run = runScene(scene, 1e-12, {std::string("Decomposition/Dirichlet=") + form});
    EXPECT_TRUE(run.report.converged) << run.report.reason;
    // The lower left corner meets the ramp: u_x + u_y = 0 there.
    double corner = 0.0;
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
      for (int node = 0; node < run.solution.owned[i].mesh.mesh->numberOfNodes(); ++node) {
        const Point x = run.solution.owned[i].mesh.position(node);
        if (std::abs(x[0]) + std::abs(x[1]) < 1e-12)
          corner = run.solution.displacement[i][2 * static_cast<std::size_t>(node)];
      }
    EXPECT_NEAR(globalMax(*testComm(), corner), 0.02, 1e-9) << form;
  }
}

// A gap closes before it bears, a penetration is pushed out: rigid motion of the upper block in ±z.
TEST(ContactPatch, initial_gap_and_penetration) {
  for (double gap : {0.02, -0.02}) {
    scene::Scene scene =
        tower(CellType::Quadrilateral4, CellType::Quadrilateral4, {2, 2, 1}, {3, 2, 1}, Joint::Contact, 0.0);
    removeEffects(scene, "Contact");
    addContact(scene, {0, "top"}, {1, "bottom"}, gap);
    TestRun run = runScene(scene, tolerance);
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
      if (run.solution.owned[i].body == 1)
        for (std::size_t k = 1; k < run.solution.displacement[i].size(); k += 2)
          run.solution.displacement[i][k] += gap;
    expectConstantStrain(scene, run, gap > 0 ? "gap" : "penetration");
  }
}

// A block that leans on two walls: the node in the corner has a row for each, which are independent.
TEST(ContactPatch, block_in_a_corner_of_obstacles) {
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {2, 2, 1};
  scene::Scene scene;
  scene.physics = Physics::PlaneStress;
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.25)));
  for (const char* set : {"right", "top"})
    addTraction(scene, {0, set}, [](const Point&, const Point& n) {
      return Point{-pressure * n[0], -pressure * n[1], 0.0};
    });
  contact::Obstacle wall, floor;
  wall.direction = {1.0, 0.0, 0.0};
  floor.direction = {0.0, 1.0, 0.0};
  addObstacle(scene, {0, "left"}, wall);
  addObstacle(scene, {0, "bottom"}, floor);
  const TestRun run = runScene(scene, tolerance);
  EXPECT_TRUE(run.report.converged) << run.report.reason;
  double worst = 0.0; // u = −p(1 − ν)x
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / 2));
      worst = std::max(worst, std::abs(run.solution.displacement[i][k] + 0.75 * pressure * x[k % 2]));
    }
  EXPECT_LE(globalMax(*testComm(), worst), 1e-10 * pressure);
  for (const run::ContactState& state : run.report.contact)
    EXPECT_NEAR(state.pressure, pressure, 1e-10 * pressure);
}

// A fibre of radius a tied in a ring [a, b] under an inner-less pressure q outside (plane strain), a quarter
// of it: the stress in the fibre is −p everywhere, and p follows from equal radial displacements at a:
//   fibre: u(a) = −p a (1 + ν_f)(1 − 2ν_f)/E_f,
//   ring:  u(r) = (1 + ν)/E · ((1 − 2ν) A r + B/r),  A = (p a² − q b²)/(b² − a²),  B = (p − q) a² b²/(b² −
//   a²)
// (Lamé; Timoshenko, Goodier: Theory of Elasticity, 1970, section 28).
TEST(Lame, fibre_tied_in_a_ring) {
  const double a = 0.4, b = 1.0, q = 0.01, ef = 10.0, nf = 0.2, em = 1.0, nm = 0.35;
  const double fibre = -a * (1 + nf) * (1 - 2 * nf) / ef; // u(a)/p
  const double c = (1 + nm) / em, d = b * b - a * a;
  const double fromP = c * ((1 - 2 * nm) * a * a / d * a + a * b * b / d);
  const double fromQ = -c * ((1 - 2 * nm) * b * b / d * a + a * b * b / d);
  const double p = fromQ * q / (fibre - fromP);
  const double half = std::acos(0.0);
  std::vector<double> h, errors;
  for (bool coarserFibre : {false, true}) { // as many elements around as the fibre has, or half as many again
    h.clear();
    errors.clear();
    for (int n : {2, 4, 8, 16}) {
      scene::Scene scene;
      scene.physics = Physics::PlaneStrain;
      fem::StructuredBlock::Options options;
      options.subdomains = {2, 2, 1};
      options.elements = {n, n, 1};
      options.map = [a](const Point& x) { // a square onto the quarter disc (Fong 2014)
        return Point{a * x[0] * std::sqrt(1 - x[1] * x[1] / 2), a * x[1] * std::sqrt(1 - x[0] * x[0] / 2),
                     0.0};
      };
      scene.bodies.push_back(blockBody("fibre", options, fem::Material::isotropic(ef, nf)));
      // Across x[0] the radius, along x[1] the angle. The fibre's nodes are not evenly spaced: none match.
      options.subdomains = {1, 4, 1};
      options.elements = {2 * n, coarserFibre ? n + n / 2 : n, 1};
      options.map = [a, b, half](const Point& x) {
        const double r = a + (b - a) * x[0], phi = half * x[1];
        return Point{r * std::cos(phi), r * std::sin(phi), 0.0};
      };
      scene.bodies.push_back(blockBody("ring", options, fem::Material::isotropic(em, nm)));
      prescribe(scene, {0, "left"}, 0);
      prescribe(scene, {0, "bottom"}, 1);
      // The ends of both circles lie on held sides.
      prescribe(scene, {1, "top"}, 0);
      prescribe(scene, {1, "bottom"}, 1);
      addTraction(scene, {1, "right"}, [q](const Point&, const Point& normal) {
        return Point{-q * normal[0], -q * normal[1], 0.0};
      });
      for (const char* side : {"right", "top"}) // of the square: half of the circle each
        addTie(scene, {0, side}, {1, "left"});
      const TestRun run = runScene(scene, 1e-10);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      double worst = 0.0;
      for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
        for (int node = 0; node < run.solution.owned[i].mesh.mesh->numberOfNodes(); ++node) {
          const Point x = run.solution.owned[i].mesh.position(node);
          const double r = std::hypot(x[0], x[1]);
          const bool inFibre = run.solution.owned[i].body == 0;
          const double radial =
              inFibre
                  ? fibre * p * r / a
                  : c * ((1 - 2 * nm) * (p * a * a - q * b * b) / d * r + (p - q) * a * a * b * b / d / r);
          for (std::size_t k = 0; k < 2; ++k)
            worst = std::max(worst,
                             std::abs(run.solution.displacement[i][2 * static_cast<std::size_t>(node) + k] -
                                      (r > 0 ? radial * x[k] / r : 0.0)));
        }
      h.push_back(1.0 / n);
      errors.push_back(globalMax(*testComm(), worst));
    }
    if (testComm()->getRank() == 0)
      std::cout << "Lame: largest errors of displacement " << errors[0] << " " << errors[1] << " "
                << errors[2] << " " << errors[3] << ", rate " << fittedRate(h, errors) << "\n";
    EXPECT_NEAR(fittedRate(h, errors), 2.0, 0.3);
    // Bilinear elements, h/a = 1/40 across the fibre: (h/a)^2 = 6e-4 of the largest displacement, below q
    // b/E.
    EXPECT_LE(errors.back(), 6e-4 * q * b / em);
  }
}
