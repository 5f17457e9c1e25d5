// SPDX-License-Identifier: BSD-3-Clause

/// Bodies that move farther than the scene is large are named.

#include "Harmos_Drift.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

namespace test_drift {

using namespace Harmos;

namespace {

// Two blocks of size 2 × 1 above each other, moved by so much each; the lower one is stretched along x.
std::string textOf(double lower, double upper, double prescribed = 0.0, double stretch = 0.0) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {2.0, 1.0, 1.0};
  options.subdomains = {2, 1, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin = {0.0, 1.0, 0.0};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  const Teuchos::Comm<int>& comm = *testComm();
  std::vector<scene::OwnedSubdomain> owned;
  feti::TornVector u;
  for (int s = comm.getRank(); s < 4; s += comm.getSize()) {
    const int body = s / 2;
    owned.push_back({s, body, scene.bodies[static_cast<std::size_t>(body)].subdomain(s % 2)});
    u.emplace_back(2 * static_cast<std::size_t>(owned.back().mesh.mesh->numberOfNodes()),
                   body == 0 ? lower : upper);
    for (std::size_t k = 0; k < u.back().size(); k += 2)
      u.back()[k] += body == 0 ? stretch * owned.back().mesh.position(static_cast<int>(k / 2))[0] : 0.0;
  }
  return run::driftText(comm, scene, owned, u, prescribed);
}

} // namespace

TEST(Drift, bodies_that_move_farther_than_the_scene_is_large) {
  EXPECT_EQ(textOf(0.1, -1.9), ""); // the scene is 2 large
  const std::string one = textOf(0.1, -2.1), both = textOf(3.0, 865.0);
  EXPECT_TRUE(contains(one, "drift: \"upper\" moved by up to 2.1")) << one;
  EXPECT_TRUE(contains(both, "\"lower\", \"upper\" moved by up to 8.6")) << both;
  EXPECT_TRUE(contains(both, "Prescribe a displacement")) << both;
}

// What moves as far as it was told, or as others deform, does not drift.
TEST(Drift, bodies_that_follow) {
  EXPECT_EQ(textOf(0.0, 3.0, 0.4), "");
  EXPECT_NE(textOf(0.0, 3.0, 0.2), "");
  // Stretching by s deforms by s/√12·2 at the root mean square over equal intervals of a length of 2, about.
  EXPECT_EQ(textOf(0.0, 3.0, 0.0, 0.8), "");
  EXPECT_NE(textOf(0.0, 3.0, 0.0, 0.1), "");
}

// A body that turns does not deform, in the plane and in space.
TEST(Drift, rotations_are_rigid) {
  for (const int dimension : {2, 3}) {
    scene::Scene scene;
    scene.physics = dimension == 2 ? scene::Physics::PlaneStrain : scene::Physics::Solid;
    fem::StructuredBlock::Options options;
    options.size = {2.0, 1.0, 1.0};
    if (dimension == 3)
      options.cellType = fem::CellType::Hexahedron8;
    scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
    std::vector<scene::OwnedSubdomain> owned;
    feti::TornVector u;
    if (testComm()->getRank() == 0) {
      owned.push_back({0, 0, scene.bodies[0].subdomain(0)});
      const auto& mesh = owned[0].mesh;
      u.emplace_back();
      for (int node = 0; node < mesh.mesh->numberOfNodes(); ++node) {
        const fem::Point x = mesh.position(node), w = {dimension == 3 ? 300.0 : 0.0, 0.0, 865.0};
        u[0].push_back(w[1] * x[2] - w[2] * x[1]);
        u[0].push_back(w[2] * x[0] - w[0] * x[2]);
        if (dimension == 3)
          u[0].push_back(w[0] * x[1] - w[1] * x[0]);
      }
    }
    const std::string text = run::driftText(*testComm(), scene, owned, u, 0.0);
    EXPECT_TRUE(contains(text, "drift: \"block\"")) << text;
  }
}

} // namespace test_drift
