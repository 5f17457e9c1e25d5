// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Effects.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace test_registry {

using namespace Harmos;

namespace {

scene::EffectRegistry all() {
  scene::EffectRegistry registry;
  effects::registerEffects(registry);
  return registry;
}

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

// A deck with one effect of a kind, whose text parameters are given.
Teuchos::ParameterList deckWith(const scene::EffectRegistry& registry, const std::string& kind,
                                const std::map<std::string, std::string>& texts) {
  ParameterSpec spec("deck", "A deck.");
  registry.addParameters(spec);
  Teuchos::ParameterList list;
  Teuchos::ParameterList& effect = list.sublist("Effects").sublist(kind).sublist("it");
  for (const auto& [name, value] : texts)
    effect.set(name, value);
  return spec.validated(list, "test");
}

} // namespace

// Decks, logs and summaries use these names, and in this order.
TEST(EffectRegistry, knows_the_effects_of_the_package) {
  const scene::EffectRegistry registry = all();
  std::vector<std::string> names;
  for (const scene::EffectKind& kind : registry.kinds())
    names.push_back(kind.name);
  const std::vector<std::string> first = {
      "Tie",        "Linear constraint", "Pretension", "Contact", "Obstacle",
      "Body force", "Centrifugal force", "Traction",   "Force",   "Prescribed displacement"};
  ASSERT_GE(names.size(), first.size());
  EXPECT_EQ(std::vector<std::string>(names.begin(), names.begin() + static_cast<long>(first.size())), first);
}

TEST(EffectRegistry, refuses_a_second_effect_of_one_name) {
  scene::EffectRegistry registry = all();
  const scene::EffectKind twin = registry.kinds().front();
  try {
    registry.add(twin);
    FAIL() << "nothing was thrown";
  } catch (const InternalError& error) {
    EXPECT_TRUE(contains(error.what(), "two effects are registered by the name \"Tie\""));
  }
}

// What a deck does not name makes no object; what it names has the name that it has there.
TEST(EffectRegistry, makes_what_a_deck_names_and_nothing_else) {
  const scene::EffectRegistry registry = all();
  std::map<std::string, long long> before;
  for (const scene::EffectKind& kind : registry.kinds())
    before[kind.name] = scene::Effect::count(kind.name).made;
  {
    scene::Scene scene = blocks();
    registry.addEffects(deckWith(registry, "Contact", {{"First", "upper/bottom"}, {"Second", "lower/top"}}),
                        scene);
    ASSERT_EQ(scene.effects.size(), 1u);
    EXPECT_EQ(scene.effects[0]->label(), "contact \"it\"");
    EXPECT_EQ(scene.effectKinds(), std::vector<std::string>{"Contact"});
    for (const scene::EffectKind& kind : registry.kinds()) {
      const bool isOn = kind.name == "Contact";
      EXPECT_EQ(scene::Effect::count(kind.name).made - before[kind.name], isOn ? 1 : 0) << kind.name;
      EXPECT_EQ(scene::Effect::count(kind.name).living, isOn ? 1 : 0) << kind.name;
    }
  }
  EXPECT_EQ(scene::Effect::count("Contact").living, 0);
}

TEST(EffectRegistry, a_deck_may_name_registered_effects_only) {
  const std::string text = inputErrorOf([&] { deckWith(all(), "Contcat", {}); });
  EXPECT_TRUE(contains(text, "did you mean \"Contact\"")) << text;
  const std::string elsewhere = inputErrorOf([&] { deckWith(scene::EffectRegistry(), "Contact", {}); });
  EXPECT_TRUE(contains(elsewhere, "Effects/Contact")) << elsewhere;
}

TEST(EffectRegistry, lists_kinds_with_their_parameters) {
  std::ostringstream text;
  all().write(text);
  for (const char* word : {"Contact", "do not penetrate each other", "Gap", "Thermal strain", "Temperature"})
    EXPECT_TRUE(contains(text.str(), word)) << text.str();
}

// Effects that were constructed directly have no name; bodies and physics that are not theirs are refused.
TEST(Effect, references_that_make_no_sense_are_refused) {
  const auto refusal = [](scene::Scene scene) { return inputErrorOf([&] { runScene(scene, 1e-6); }); };
  scene::Scene scene = blocks();
  addForce(scene, 7, fem::Point{0, -1, 0});
  EXPECT_TRUE(contains(refusal(scene), "a body force names body number 7, but the scene has 2 bodies"));
  scene = blocks();
  addObstacle(scene, {0, "botom"}, contact::Obstacle());
  EXPECT_TRUE(contains(refusal(scene), "an obstacle names the boundary part \"botom\""));
  scene = blocks();
  addForce(scene, 0, std::vector<fem::BoxLoad>{{1.0, {0, 0}, {1, 1}}});
  EXPECT_TRUE(contains(refusal(scene), "a body force is that of a membrane, but the body is elastic"));
  scene = blocks(scene::Physics::Membrane);
  addForce(scene, 0, fem::Point{0, -1, 0});
  EXPECT_TRUE(contains(refusal(scene), "a body force is per volume, but the body is a membrane"));
  scene = blocks(scene::Physics::Membrane);
  addTemperature(scene, 0, 1.0);
  EXPECT_TRUE(contains(refusal(scene), "a thermal strain needs elastic bodies"));
}

} // namespace test_registry
