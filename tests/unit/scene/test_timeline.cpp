// SPDX-License-Identifier: BSD-3-Clause

/// Histories and steps, and decks that make no sense.

#include "Harmos_Errors.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

namespace test_timeline {

using namespace Harmos;

namespace {

scene::Timeline timelineOf(const std::vector<std::string>& assignments) {
  ParameterSpec deck("deck", "A deck.");
  scene::Timeline::addTo(deck);
  Teuchos::ParameterList list = deck.defaults();
  for (const std::string& assignment : assignments) {
    const std::size_t sign = assignment.find('=');
    deck.set(list, assignment.substr(0, sign), assignment.substr(sign + 1), "test");
  }
  return scene::Timeline::fromDeck(deck.validated(list, "test"));
}

// The message of the deck's fault; "" without.
std::string faultOf(const std::vector<std::string>& assignments) {
  try {
    timelineOf(assignments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expectFault(const std::vector<std::string>& assignments, const std::string& part) {
  const std::string fault = faultOf(assignments);
  EXPECT_NE(fault.find(part), std::string::npos) << fault;
}

} // namespace

TEST(Timeline, histories_are_piecewise_linear_and_constant_outside) {
  const scene::History history({1.0, 2.0, 4.0}, {-1.0, 3.0, 0.0});
  EXPECT_EQ(history(0.0), -1.0);
  EXPECT_EQ(history(1.0), -1.0);
  EXPECT_EQ(history(1.5), 1.0);
  EXPECT_EQ(history(2.0), 3.0);
  EXPECT_EQ(history(3.0), 1.5);
  EXPECT_EQ(history(4.0), 0.0);
  EXPECT_EQ(history(9.0), 0.0);
}

TEST(Timeline, magnitudes_go_up_over_several_steps_and_are_there_in_one) {
  scene::Scene scene;
  scene.bodies.resize(1);
  addForce(scene, 0, fem::Point{1.0, 0.0, 0.0});
  const scene::Effect& force = *scene.effects[0];
  EXPECT_EQ(scene.timeline.factor(force, scene.timeline.end()), 1.0);
  scene.timeline = scene::Timeline({1.0, 4.0});
  EXPECT_EQ(scene.timeline.factor(force, 1.0), 0.25);
  EXPECT_EQ(scene.timeline.factor(force, 4.0), 1.0);
  scene.timeline.follow(force, "constant");
  EXPECT_EQ(scene.timeline.factor(force, 1.0), 1.0);
  scene.timeline.add("wave", scene::History({1.0, 2.0}, {0.5, 2.0}));
  scene.timeline.follow(force, "wave");
  scene.timeline.check(scene.effects);
  EXPECT_EQ(scene.timeline.factor(force, 1.0), 0.5);
  EXPECT_EQ(scene.timeline.corners(), (std::vector<double>{0.0, 1.0, 2.0, 4.0}));
}

// Who gives a time wants a row of steps.csv, be it one.
TEST(Timeline, a_time_that_is_given_is_a_step) {
  EXPECT_FALSE(timelineOf({}).hasSteps());
  EXPECT_FALSE(timelineOf({"Steps/End time=2"}).hasSteps());
  EXPECT_TRUE(timelineOf({"Steps/Times={2}"}).hasSteps());
  EXPECT_EQ(timelineOf({"Steps/Times={2}"}).end(), 2.0);
  EXPECT_TRUE(timelineOf({"Steps/Number=2"}).hasSteps());
}

TEST(Timeline, nonsense_is_refused) {
  EXPECT_EQ(faultOf({"Steps/Number=4", "Steps/End time=2"}), "");
  EXPECT_EQ(faultOf({"Steps/Times={1,2.5}"}), "");
  expectFault({"Steps/Number=0"}, "\"Steps/Number\" = 0 is out of range");
  expectFault({"Steps/Times={1,3,2}"},
              "\"Steps/Times\": times must increase, but 2.00e+00 comes after 3.00e+00");
  expectFault({"Steps/Times={1,2}", "Steps/Number=2"}, "give one of the two");
  const std::string a = "Steps/Histories/a/";
  expectFault({a + "Times={0,2,1}", a + "Values={0,1,2}"},
              "\"Steps/Histories/a\": times must increase, but 1.00e+00 comes after 2.00e+00");
  expectFault({a + "Times={0,1}", a + "Values={0}"}, "2 times and 1 values");
  expectFault({a + "Values={0}"}, "at least one time");
  expectFault({"Steps/Histories/ramp/Times={0}", "Steps/Histories/ramp/Values={0}"},
              "\"ramp\" exists already");
}

TEST(Timeline, histories_belong_to_magnitudes_and_are_defined) {
  scene::Scene scene;
  scene.bodies.resize(1);
  addForce(scene, 0, fem::Point{1.0, 0.0, 0.0});
  addObstacle(scene, {0, "bottom"}, {});
  scene.timeline.add("press", scene::History({0.0}, {1.0}));
  const auto fault = [&](std::size_t effect, const std::string& history) -> std::string {
    scene.timeline.follow(*scene.effects[effect], history);
    try {
      scene.timeline.check(scene.effects);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(fault(0, "press"), "");
  EXPECT_NE(fault(0, "pres").find("is not defined; did you mean \"press\"?"), std::string::npos);
  scene.timeline.follow(*scene.effects[0], "press");
  EXPECT_NE(fault(1, "press").find("has no magnitude"), std::string::npos);
}

} // namespace test_timeline
