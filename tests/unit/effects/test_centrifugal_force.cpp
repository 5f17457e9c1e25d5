// SPDX-License-Identifier: BSD-3-Clause

/// Bodies that turn, against exact solutions.

#include "Harmos_CentrifugalForce.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_centrifugal_force {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double young = 2.0, density = 1.5, speed = 0.1;

// A quarter of a plate, or of a block, that turns about z; the planes x = 0 and y = 0 are symmetric. Without
// sideways contraction each direction is a bar: E u'' = −ρω²x, u = ρω²/E (L²x/2 − x³/6).
scene::Scene turning(CellType type, const fem::Point& axis = {0.0, 0.0, 3.0}) {
  const bool isSpace = fem::shapeOf(type).dimension == 3;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStress;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 1};
  options.size = {2.0, 1.0, 1.0};
  scene.bodies.push_back(blockBody("plate", options, fem::Material::isotropic(young, 0.0)));
  prescribe(scene, {0, "left"}, 0);
  prescribe(scene, {0, isSpace ? "front" : "bottom"}, 1);
  if (isSpace)
    prescribe(scene, {0, "bottom"}, 2);
  scene.effects.push_back(std::make_shared<effects::CentrifugalForce>(
      0, effects::CentrifugalForce::Rotation{density, speed, {0.0, 0.0, 5.0}, axis}));
  return scene;
}

} // namespace

// Corners of cells have the exact displacement in one dimension, whatever the order (Douglas, Dupont 1974).
TEST(CentrifugalForce, bars_in_two_directions) {
  constexpr double allowed = 1e-10; // of the solver, 1e-13, times the condition
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Hexahedron8, CellType::Hexahedron27}) {
    const TestRun run = runScene(turning(type), 1e-13);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    double worst = 0.0;
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
      const fem::PlacedMesh& mesh = run.solution.owned[i].mesh;
      for (int cell = 0; cell < mesh.mesh->numberOfCells(); ++cell)
        for (int corner = 0; corner < fem::shapeOf(type).corners; ++corner) {
          const int node = mesh.mesh->cell(cell)[corner], m = mesh.mesh->dimension();
          const Point x = mesh.position(node);
          const std::array<double, 3> length = {2.0, 1.0, 0.0};
          for (std::size_t c = 0; c < static_cast<std::size_t>(m); ++c) {
            const double exact = c == 2 ? 0.0
                                        : density * speed * speed / young *
                                              (length[c] * length[c] * x[c] / 2.0 - x[c] * x[c] * x[c] / 6.0);
            worst = std::max(
                worst,
                std::abs(run.solution.displacement[i][static_cast<std::size_t>(node * m) + c] - exact));
          }
        }
    }
    EXPECT_LE(globalMax(*testComm(), worst), allowed * 0.02) << fem::shapeOf(type).name;
  }
}

TEST(CentrifugalForce, refuses_axes_that_make_no_sense) {
  EXPECT_TRUE(contains(failureOf(turning(CellType::Hexahedron8, {0, 0, 0})), "zero vector"));
  EXPECT_TRUE(contains(failureOf(turning(CellType::Quadrilateral4, {1, 0, 1})), "normal to it"));
}

} // namespace test_centrifugal_force
