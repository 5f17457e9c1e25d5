// SPDX-License-Identifier: BSD-3-Clause

/// Friction that makes no sense is refused, with the reason; friction on surfaces that two contacts share.

#include "Harmos_Contact.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Effects.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_friction {

using namespace Harmos;

namespace {

// A lower block and an upper one.
scene::Scene blocks(scene::Physics physics = scene::Physics::PlaneStrain) {
  scene::Scene scene;
  scene.physics = physics;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin[1] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  return scene;
}

// What a deck with a contact "joint", an obstacle "floor" and a tie "seam" is told about its friction.
std::string refusalOf(const std::function<void(Teuchos::ParameterList& frictions)>& fill,
                      scene::Physics physics = scene::Physics::PlaneStrain) {
  scene::EffectRegistry registry;
  effects::registerEffects(registry);
  ParameterSpec spec("deck", "A deck.");
  registry.addParameters(spec);
  Teuchos::ParameterList list;
  Teuchos::ParameterList& effects = list.sublist("Effects");
  for (const char* place : {"Contact/joint", "Tie/seam"}) {
    const std::string text = place;
    effects.sublist(text.substr(0, text.find('/')))
        .sublist(text.substr(text.find('/') + 1))
        .set("First", "upper/bottom")
        .set("Second", "lower/top");
  }
  if (physics != scene::Physics::Membrane)
    effects.sublist("Obstacle").sublist("floor").set("Part", "lower/bottom");
  fill(effects.sublist("Friction"));
  return inputErrorOf([&] {
    scene::Scene scene = blocks(physics);
    registry.addEffects(spec.validated(list, "test"), scene);
    for (const auto& effect : scene.effects)
      effect->check(scene);
  });
}

std::string refusalOf(const std::string& contact, double slipBound) {
  return refusalOf([&](Teuchos::ParameterList& frictions) {
    frictions.sublist("f").set("Contact", contact).set("Law", "Tresca").set("Slip bound", slipBound);
  });
}

} // namespace

TEST(Friction, decks_that_make_no_sense_are_refused) {
  EXPECT_EQ(refusalOf("joint", 0.5), "");
  EXPECT_EQ(refusalOf("floor", 0.0), "");
  EXPECT_EQ(refusalOf("Obstacle/floor", 1.0), "");
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      EXPECT_TRUE(contains(text, word)) << word << " in: " << text;
  };
  expect(refusalOf("joint", -1.0), {"Effects/Friction/f/Slip bound", "negative"});
  expect(refusalOf("jiont", 1.0), {"\"Effects/Friction/f/Contact\"", "jiont", "did you mean \"joint\""});
  expect(refusalOf("", 1.0), {"Effects/Friction/f/Contact"});
  expect(refusalOf("seam", 1.0), {"tie \"seam\"", "does not slip"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f").set("Contact", "joint").set("Coefficient", 1.0);
           frictions.sublist("g").set("Contact", "joint").set("Law", "Tresca").set("Slip bound", 2.0);
         }),
         {"friction \"f\"", "friction \"g\"", "contact \"joint\""});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f")
               .set("Contact", "joint")
               .set("Law", "Tresca")
               .set("Slip bound", 1.0)
               .set("Coefficient", 0.3);
         }),
         {"Effects/Friction/f/Coefficient", "Tresca's law does not use it"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f").set("Contact", "joint").set("Slip bound", 1.0);
         }),
         {"Effects/Friction/f/Slip bound", "Coulomb's law does not use it"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) { frictions.sublist("f").set("Contact", "joint"); }),
         {"Effects/Friction/f/Coefficient", "missing"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f").set("Contact", "joint").set("Coefficient", -0.1);
         }),
         {"Effects/Friction/f/Coefficient", "negative"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f").set("Contact", "joint").set("Law", "Tresca");
         }),
         {"Effects/Friction/f/Slip bound", "missing"});
  expect(refusalOf([](Teuchos::ParameterList& frictions) {
           frictions.sublist("f").set("Contact", "joint").set("Law", "Trseca").set("Slip bound", 1.0);
         }),
         {"Law", "Tresca", "Coulomb"});
  expect(refusalOf(
             [](Teuchos::ParameterList& frictions) {
               frictions.sublist("f").set("Contact", "joint").set("Coefficient", 1.0);
             },
             scene::Physics::Membrane),
         {"membrane"});
}

// Effects that were constructed directly.
TEST(Friction, contacts_that_are_not_in_the_scene_are_refused) {
  scene::Scene scene = blocks();
  effects::SurfacePair pair;
  pair.first = {1, "bottom"};
  pair.second = {0, "top"};
  const auto contact = std::make_shared<effects::Contact>(pair, 0.0, "joint");
  scene.effects.push_back(std::make_shared<effects::Friction>(contact, 1.0, "f"));
  const auto refusal = [&] { return inputErrorOf([&] { runScene(scene, 1e-6); }); };
  EXPECT_TRUE(contains(refusal(), "contact \"joint\", which is not an effect of the scene")) << refusal();
  scene.effects.push_back(contact);
  scene.effects.front() = std::make_shared<effects::Friction>(
      contact, [](const fem::Point& x) { return x[0] - 0.5; }, "f");
  EXPECT_TRUE(contains(refusal(), "friction \"f\" has a slip bound of -")) << refusal();
  scene.effects.front() = std::make_shared<effects::Friction>(
      contact, effects::Coulomb([](const fem::Point& x) { return x[0] - 0.5; }), "f");
  EXPECT_TRUE(contains(refusal(), "friction \"f\" has a coefficient of -")) << refusal();
}

// Two contacts name the same surfaces, the second one with sides exchanged: there are no rows twice, and the
// friction of either acts.
TEST(Friction, of_contacts_that_share_their_surfaces) {
  const auto comm = testComm();
  for (bool isSecond : {false, true}) {
    scene::Scene scene = blocks();
    std::vector<std::shared_ptr<const scene::Effect>> contacts;
    for (bool exchanged : {false, true}) {
      effects::SurfacePair pair;
      pair.first = {exchanged ? 0 : 1, exchanged ? "top" : "bottom"};
      pair.second = {exchanged ? 1 : 0, exchanged ? "bottom" : "top"};
      contacts.push_back(std::make_shared<effects::Contact>(pair, 0.0, exchanged ? "b" : "a"));
      scene.effects.push_back(contacts.back());
    }
    scene.effects.push_back(std::make_shared<effects::Friction>(contacts[isSecond ? 1 : 0], 3.0));
    const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*comm, scene);
    const scene::ContactSetup setup = scene::setUpContact(*comm, scene, owned);
    ASSERT_EQ(setup.pointCount, 5);
    ASSERT_EQ(globalSum(*comm, static_cast<long long>(setup.slips.size())), 5);
    double limits = 0.0;
    for (const contact::SlipPoint& slip : setup.slips) {
      limits += slip.limit;
      const fem::Point &n = setup.points[slip.point].normal, &t = slip.tangents[0];
      EXPECT_NEAR(n[0] * t[0] + n[1] * t[1], 0.0, 1e-15);
      EXPECT_NEAR(t[0] * t[0] + t[1] * t[1], 1.0, 1e-15);
    }
    EXPECT_NEAR(globalSum(*comm, limits), 3.0, 1e-12); // the bound on a surface of length one
    long long rows = 0;
    for (const ConstraintRow& row : setup.rows)
      rows += row.kind == ConstraintRow::Kind::Limited ? 1 : 0;
    EXPECT_EQ(globalSum(*comm, rows), 5);
  }
}

} // namespace test_friction
