// SPDX-License-Identifier: BSD-3-Clause

/// Bodies that move farther than the scene is large are named.

#include "Harmos_Drift.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

using namespace Harmos;

namespace {

// Two blocks of size 2 × 1 above each other, moved by so much each.
std::string textOf(double lower, double upper) {
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
  }
  return run::driftText(comm, scene, owned, u);
}

} // namespace

TEST(Drift, bodies_that_move_farther_than_the_scene_is_large) {
  EXPECT_EQ(textOf(0.1, -1.9), ""); // the scene is 2 large
  const std::string one = textOf(0.1, -2.1), both = textOf(3.0, 865.0);
  EXPECT_TRUE(contains(one, "drift: \"upper\" moved by up to 2.1")) << one;
  EXPECT_TRUE(contains(both, "\"lower\", \"upper\" moved by up to 8.6")) << both;
  EXPECT_TRUE(contains(both, "prescribe a displacement")) << both;
}
