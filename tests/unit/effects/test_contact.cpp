// SPDX-License-Identifier: BSD-3-Clause

/// Soft contact against its law, p = k · penetration.

#include "Harmos_Contact.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_contact {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double young = 2.0, stiffness = 5.0, gap = 0.002;
// Of the solver. Errors of the answer are by the condition of the problem larger, here below 1e3.
constexpr double tolerance = 1e-13, allowed = 1e-9;

// Two blocks without sideways contraction, one on the other, pressed by p on top.
scene::Scene stacked(CellType lower, CellType upper, double pressure, double apart = 0.0,
                     double adjust = 0.0) {
  const bool isSpace = fem::shapeOf(lower).dimension == 3;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  for (const CellType type : {lower, upper}) {
    const bool isUpper = !scene.bodies.empty();
    options.cellType = type;
    options.origin =
        isSpace ? Point{0, 0, isUpper ? 1.0 + apart : 0.0} : Point{0, isUpper ? 1.0 + apart : 0.0, 0};
    options.elements = isUpper ? std::array<int, 3>{3, 2, 2} : std::array<int, 3>{2, 3, 2};
    options.subdomains = {2, 1, 1};
    scene.bodies.push_back(
        blockBody(isUpper ? "upper" : "lower", options, fem::Material::isotropic(young, 0.0)));
  }
  for (int body = 0; body < 2; ++body) {
    prescribe(scene, {body, "left"}, 0);
    if (isSpace)
      prescribe(scene, {body, "front"}, 1);
  }
  const int up = isSpace ? 2 : 1;
  prescribe(scene, {0, "bottom"}, up);
  Point down{};
  down[static_cast<std::size_t>(up)] = -pressure;
  addTraction(scene, {1, "top"}, down);
  effects::SurfacePair pair;
  pair.first = {0, "top"};
  pair.second = {1, "bottom"};
  scene.effects.push_back(
      std::make_shared<effects::Contact>(pair, effects::Contact::Options{gap, stiffness, adjust}, ""));
  return scene;
}

} // namespace

// u = −p y/E below, −p y/E − gap − p/k above: all elements reproduce it, matching or not.
TEST(SoftContact, blocks_penetrate_by_pressure_over_stiffness) {
  for (const auto& [lower, upper] : {std::pair(CellType::Quadrilateral4, CellType::Quadrilateral4),
                                     std::pair(CellType::Triangle6, CellType::Quadrilateral8),
                                     std::pair(CellType::Hexahedron8, CellType::Tetrahedron4),
                                     std::pair(CellType::Hexahedron20, CellType::Hexahedron20)})
    for (double p : {0.001, 0.1}) {
      SCOPED_TRACE(fem::shapeOf(lower).name + " under " + fem::shapeOf(upper).name);
      const scene::Scene scene = stacked(lower, upper, p);
      const TestRun run = runScene(scene, tolerance);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      const auto m = static_cast<std::size_t>(scene.components());
      double worst = 0.0;
      for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
        for (std::size_t k = m - 1; k < run.solution.displacement[i].size(); k += m) {
          const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / m));
          const double jump = run.solution.owned[i].body == 1 ? gap + p / stiffness : 0.0;
          worst = std::max(worst, std::abs(run.solution.displacement[i][k] + p * x[m - 1] / young + jump));
        }
      EXPECT_LE(globalMax(*testComm(), worst), allowed * p);
      EXPECT_FALSE(globalMax(*testComm(), static_cast<long long>(run.report.contact.size())) == 0);
      for (const run::ContactState& state : run.report.contact)
        EXPECT_NEAR(state.pressure, p, allowed * p);
    }
}

// Meshes a small distance apart, or overlapping, are taken to touch: the upper block moves as if it lay on
// the lower one. Distances beyond what is adjusted stay.
TEST(AdjustedContact, distances_are_taken_to_be_zero) {
  const double p = 0.01;
  for (double apart : {0.003, -0.003, 0.02}) {
    const scene::Scene scene = stacked(CellType::Quadrilateral4, CellType::Triangle3, p, apart, 0.01);
    const TestRun run = runScene(scene, tolerance);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const double closed = gap + p / stiffness + (apart > 0.01 ? apart : 0.0);
    double worst = 0.0;
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
      for (std::size_t k = 1; k < run.solution.displacement[i].size(); k += 2) {
        const bool isUpper = run.solution.owned[i].body == 1;
        const double y =
            run.solution.owned[i].mesh.position(static_cast<int>(k / 2))[1] - (isUpper ? apart : 0.0);
        worst = std::max(
            worst, std::abs(run.solution.displacement[i][k] + p * y / young + (isUpper ? closed : 0.0)));
      }
    EXPECT_LE(globalMax(*testComm(), worst), allowed * p) << apart;
  }
}

} // namespace test_contact
