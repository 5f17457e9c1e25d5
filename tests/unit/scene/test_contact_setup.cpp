// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_contact_setup {

using namespace Harmos;

namespace {

// A short block above a long one, 0.01 apart.
scene::Scene blocks() {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {2.0, 1.0, 1.0};
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material()));
  options.size[0] = 1.0;
  options.origin[1] = 1.01;
  scene.bodies.push_back(blockBody("upper", options, fem::Material()));
  return scene;
}

// With a contact between them.
scene::Scene stack(double reach = 0.0) {
  scene::Scene scene = blocks();
  addContact(scene, {0, "top"}, {1, "bottom"}, 0.0, reach);
  return scene;
}

scene::ContactSetup setUp(const scene::Scene& scene) {
  const auto comm = testComm();
  const auto owned = scene::decompose(*comm, scene);
  scene::checkBoundaryParts(*comm, scene, owned);
  return scene::setUpContact(*comm, scene, owned);
}

} // namespace

// The nodes of the lower block beyond the upper one have no counterpart, and the user learns how many; a
// reach shorter than the gap finds none at all.
TEST(ContactSetup, nodes_without_counterpart_are_told) {
  const scene::ContactSetup setup = setUp(stack());
  EXPECT_LT(setup.pointCount, 5);
  EXPECT_GE(setup.pointCount, 3);
  EXPECT_EQ(globalSum(*testComm(), static_cast<long long>(setup.points.size())), setup.pointCount);
  for (const contact::ContactPoint& point : setup.points)
    EXPECT_NEAR(point.gap, 0.01, 1e-12);
  ASSERT_EQ(setup.notes.size(), 1u);
  EXPECT_TRUE(contains(setup.notes[0], std::to_string(5 - setup.pointCount) + " of the 5 nodes of lower/top"))
      << setup.notes[0];
  EXPECT_NE(inputErrorOf([&] { setUp(stack(0.005)); }), "");
}

TEST(ContactSetup, references_that_lead_nowhere_are_refused) {
  scene::Scene scene = blocks();
  addContact(scene, {5, "top"}, {1, "bottom"});
  EXPECT_TRUE(contains(inputErrorOf([&] { setUp(scene); }), "names body number 5"));
  scene = stack();
  prescribe(scene, {0, "bottom"}, 2);
  EXPECT_TRUE(contains(inputErrorOf([&] { setUp(scene); }),
                       "component 2, but the number of components per node is 2"));
  scene = blocks();
  addContact(scene, {0, "top"}, {1, "botom"});
  EXPECT_TRUE(contains(inputErrorOf([&] { setUp(scene); }), "did you mean \"bottom\"?"));
}

// A part that has nodes alone, a corner for instance, can be held, but not pulled at.
TEST(ContactSetup, tractions_need_sides) {
  scene::Scene scene = stack();
  const auto whole = scene.bodies[0].subdomain;
  scene.bodies[0].subdomain = [whole](int k) {
    fem::PlacedMesh mesh = whole(k);
    if (k == 0)
      mesh.sets["corner"] = {0};
    return mesh;
  };
  prescribe(scene, {0, "corner"}, 0);
  EXPECT_EQ(inputErrorOf([&] { setUp(scene); }), "");
  addTraction(scene, {0, "corner"}, fem::Point{});
  EXPECT_TRUE(contains(inputErrorOf([&] { setUp(scene); }), "no cell sides on the boundary"));
}

// A node of two contacts shows the one that is closed, whatever their order.
TEST(ContactFields, node_of_two_contacts_shows_the_closed_one) {
  scene::Scene scene = stack();
  const auto owned = scene::decompose(*testComm(), scene);
  std::vector<contact::ContactPoint> points(2);
  for (contact::ContactPoint& point : points) {
    point.node = 0;
    point.terms = {{0, 1.0}};
  }
  const run::ContactState open{0.0, 0.0, 0.5, false}, closed{3.0, 1.5, 0.0, true};
  for (const auto& states : {std::vector<run::ContactState>{open, closed}, {closed, open}}) {
    const run::ContactFields fields = run::contactFields(*testComm(), owned, points, states);
    for (std::size_t i = 0; i < owned.size(); ++i)
      for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
        const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
        const bool isIt = owned[i].mesh.boundaryNumbers[k] == 0;
        EXPECT_EQ(fields.activeSet[i][node], isIt ? 2 : 0);
        EXPECT_EQ(fields.pressure[i][node], isIt ? 3.0 : 0.0);
      }
  }
}

// Which fields there are is a matter of the scene: a step whose contacts are all open has those of friction
// and adhesion, too. What acts on the second side is the negative.
TEST(ContactFields, kinds_are_those_of_the_scene) {
  scene::Scene scene = stack();
  const auto owned = scene::decompose(*testComm(), scene);
  std::vector<contact::ContactPoint> points(1);
  points[0].node = 0;
  points[0].terms = {{0, 1.0}, {1, -1.0}};
  run::ContactState state{0.0, 0.0, 0.5, false};
  state.isBound = true;
  state.damage = 0.25;
  state.jump = {1.0, 2.0, 3.0};
  state.wholeTraction = {4.0, 5.0, 6.0};
  const run::ContactFields none = run::contactFields(*testComm(), owned, points, {state});
  EXPECT_TRUE(none.friction.empty() && none.slip.empty() && none.damage.empty() && none.jump.empty());
  const run::ContactFields fields = run::contactFields(*testComm(), owned, points, {state}, {true, true});
  ASSERT_EQ(fields.friction.size(), owned.size());
  ASSERT_EQ(fields.damage.size(), owned.size());
  for (std::size_t i = 0; i < owned.size(); ++i) {
    const auto nodes = static_cast<std::size_t>(owned[i].mesh.mesh->numberOfNodes());
    EXPECT_EQ(fields.friction[i], std::vector<unsigned char>(nodes, 0));
    EXPECT_EQ(fields.slip[i], std::vector<double>(3 * nodes, 0.0));
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
      const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
      const long long number = owned[i].mesh.boundaryNumbers[k];
      const double sign = number == 0 ? 1.0 : number == 1 ? -1.0 : 0.0;
      EXPECT_EQ(fields.damage[i][node], 0.25 * std::abs(sign));
      EXPECT_EQ(fields.jump[i][3 * node + 1], 2.0 * sign);
      EXPECT_EQ(fields.interfaceTraction[i][3 * node + 2], 6.0 * sign);
    }
  }
}

} // namespace test_contact_setup
