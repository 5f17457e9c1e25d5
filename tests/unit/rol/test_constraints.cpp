// SPDX-License-Identifier: BSD-3-Clause

/// Constraints: linear ones, alone and together, of one side and of two; others; those that cannot be met.

#include "Harmos_Minimise.hpp"
#include "Harmos_RolProblems.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace test_constraints {

using namespace Harmos;

namespace {

const double infinity = std::numeric_limits<double>::infinity();

TestFunction squares() {
  return {[](const Design& x) { return product(x, x); },
          [](const Design& x) {
            Design result = x;
            for (double& number : result)
              number *= 2.0;
            return result;
          }};
}

Teuchos::ParameterList tight() {
  Teuchos::ParameterList options;
  options.sublist("Status Test").set("Gradient Tolerance", 1e-5);
  return options;
}

} // namespace

// Nearest to (1, 1, 1) with a sum between limits: t(1, 1, 1) with t from the limit that holds.
TEST(Constraints, a_limit_of_one_side_and_of_two) {
  struct Case {
    double lower, upper, expected;
  };
  for (const auto& [lower, upper, expected] :
       {Case{-infinity, 1.5, 1.5}, Case{-infinity, 4.0, 3.0}, Case{4.5, infinity, 4.5},
        Case{2.0, infinity, 3.0}, Case{0.0, 2.0, 2.0}, Case{3.5, 4.0, 3.5}, Case{2.0, 4.0, 3.0},
        Case{-infinity, infinity, 3.0}}) {
    SCOPED_TRACE(std::to_string(lower) + " to " + std::to_string(upper));
    auto cost = bowl(Design(3, 1.0), Design(3, 1.0));
    auto sum = linearFunction(Design(3, 1.0));
    auto problem = inBox(cost, 3, 0.3, -2.0, 2.0);
    problem.constraints = {limited("sum", sum, lower, upper, true)};
    const auto outcome = rol::minimise(problem, tight());
    EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
    EXPECT_LT(distance(outcome.design, Design(3, expected / 3.0)), 1e-4); // the gradient is the distance
    EXPECT_LT(outcome.violation, 1e-9);
    EXPECT_NEAR(outcome.constraints[0], product(outcome.design, Design(3, 1.0)), 1e-14);
    EXPECT_EQ(sum.gradientDesigns.size(), 1u);
    EXPECT_EQ(sum.designs.size(), 2u); // at the start, and at the end
  }
}

// Nearest to (2, 0, 0) with x + y + z = 1, x − y ≤ 0.5 and x ≤ 0.6: by hand (0.6, 0.45, −0.05) without the
// bound on z.
TEST(Constraints, two_linear_ones_together) {
  auto cost = bowl(Design(3, 1.0), {2.0, 0.0, 0.0});
  auto sum = linearFunction({1.0, 1.0, 1.0}), difference = linearFunction({1.0, -1.0, 0.0});
  auto problem = inBox(cost, 3, 0.0, -1.0, 1.0);
  problem.space.upper[0] = 0.6;
  problem.constraints = {limited("sum", sum, 1.0, 1.0, true),
                         limited("difference", difference, -infinity, 0.1, true)};
  const auto outcome = rol::minimise(problem, tight());
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  // x = 0.6 leaves y + z = 0.4 with y ≥ 0.5: the limit holds, z = −0.1.
  EXPECT_LT(distance(outcome.design, {0.6, 0.5, -0.1}), 1e-4);
  EXPECT_LT(outcome.violation, 1e-6);
}

TEST(Constraints, a_volume_that_no_design_has) {
  auto cost = bowl(Design(3, 1.0), Design(3, 1.0));
  auto volume = linearFunction({1.0, -2.0, 3.0});
  auto problem = inBox(cost, 3, 0.0, -1.0, 2.0); // from −1 − 4 − 3 = −8 to 2 + 2 + 6 = 10
  for (const auto& [lower, upper] :
       {std::pair(10.5, infinity), std::pair(-infinity, -8.25), std::pair(11.0, 11.0)}) {
    problem.constraints = {limited("volume", volume, lower, upper, true)};
    const auto message = inputErrorOf([&] { rol::minimise(problem); });
    EXPECT_TRUE(contains(message, "no design within the bounds satisfies the constraint \"volume\""))
        << message;
    EXPECT_TRUE(contains(message, "at least -8.000000e+00 and at most 1.000000e+01")) << message;
    EXPECT_TRUE(contains(message, lower == upper ? "is to be 1.100000e+01" : "is to lie between")) << message;
    EXPECT_TRUE(contains(message, "widen the bounds")) << message;
  }
  EXPECT_TRUE(cost.designs.empty()); // before anything is computed
  // The corner itself may be asked for.
  problem.constraints = {limited("volume", volume, 10.0, 10.0, true)};
  EXPECT_LT(distance(rol::minimise(problem).design, {2.0, -1.0, 2.0}), 1e-6);
  // Without bounds all can be reached.
  problem.space.upper[1] = infinity;
  problem.constraints = {limited("volume", volume, -infinity, -20.0, true)};
  EXPECT_TRUE(rol::minimise(problem).isConverged());
}

TEST(Constraints, two_that_contradict_each_other) {
  auto cost = bowl(Design(2, 1.0), Design(2, 1.0));
  auto sum = linearFunction({1.0, 1.0}), other = linearFunction({1.0, 1.01});
  auto problem = inBox(cost, 2, 0.0, -1.0, 1.0);
  problem.constraints = {limited("sum", sum, 1.0, 1.0, true), limited("other", other, -1.0, -1.0, true)};
  const auto message = inputErrorOf([&] { rol::minimise(problem); });
  EXPECT_TRUE(contains(message, "satisfies all constraints")) << message;
}

TEST(Constraints, those_that_make_no_sense) {
  auto cost = bowl(Design(2, 1.0), Design(2, 1.0));
  auto sum = linearFunction({1.0, 1.0}), nothing = linearFunction({0.0, 0.0});
  auto problem = inBox(cost, 2, 0.0, -1.0, 1.0);
  const auto message = [&] { return inputErrorOf([&] { rol::minimise(problem); }); };
  problem.constraints = {limited("sum", sum, 0.0, 1.0, true), limited("sum", sum, 0.0, 1.0, true)};
  EXPECT_TRUE(contains(message(), "two constraints have the name \"sum\"")) << message();
  problem.constraints = {limited("sum", sum, 1.0, 0.0, true)};
  EXPECT_TRUE(contains(message(), "\"sum\": its lower limit")) << message();
  problem.constraints = {limited("nothing", nothing, -1.0, 1.0, true)};
  EXPECT_TRUE(contains(message(), "\"nothing\" does not depend on the design")) << message();
}

TEST(Constraints, one_that_is_said_to_be_linear_and_is_not) {
  auto cost = bowl(Design(2, 1.0), Design(2, 1.0));
  auto circle = squares();
  auto problem = inBox(cost, 2, 0.2, -1.0, 1.0);
  problem.constraints = {limited("circle", circle, -1.0, 1.0, true)};
  const auto outcome = rol::minimise(problem);
  EXPECT_EQ(outcome.ending, rol::Ending::Missed);
  EXPECT_FALSE(outcome.isConverged());
  EXPECT_TRUE(contains(outcome.reason, "declared linear")) << outcome.reason;
}

// The least of x + 2y on a circle and in its disc: −(1, 2)√(2/5).
TEST(Constraints, a_circle_and_a_disc) {
  for (const double lower : {2.0, -infinity}) {
    auto cost = linearFunction({1.0, 2.0});
    auto circle = squares();
    auto problem = inBox(cost, 2, 0.5, -2.0, 2.0);
    problem.constraints = {limited("circle", circle, lower, 2.0, false)};
    std::vector<rol::Iterate> outer;
    int inner = 0;
    const auto outcome = rol::minimise(problem, tight(), [&](const rol::Iterate& iterate) {
      EXPECT_NEAR(iterate.cost, product(iterate.design, {1.0, 2.0}), 1e-12);
      if (iterate.isInner)
        ++inner;
      else
        outer.push_back(iterate);
      return true;
    });
    EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
    EXPECT_LT(distance(outcome.design, {-std::sqrt(0.4), -2.0 * std::sqrt(0.4)}), 1e-3);
    EXPECT_LT(outcome.violation, 1e-5);
    EXPECT_NEAR(outcome.constraints[0], 2.0, 1e-4);
    EXPECT_GT(inner, static_cast<int>(outer.size()));
    // At the start 0.5 in the place of 2, with a gradient of √2 on a box whose diagonal is √32.
    EXPECT_NEAR(outer[0].violation, lower == 2.0 ? 1.5 / 8.0 : 0.0, 1e-12);
    EXPECT_EQ(outer.back().design, outcome.design);
    EXPECT_LE(outcome.values, 150);
  }
}

// Nearest to (2, 2, 1) in the disc x² + y² + z² ≤ 2.5 with x = y and z = 0.5: x = y = √(9/8).
TEST(Constraints, a_disc_and_linear_ones) {
  auto cost = bowl(Design(3, 1.0), {2.0, 2.0, 1.0});
  auto disc = squares();
  auto diagonal = linearFunction({1.0, -1.0, 0.0});
  auto problem = inBox(cost, 3, 0.2, -2.0, 2.0);
  problem.space.upper[2] = 0.5;
  problem.constraints = {limited("disc", disc, -infinity, 2.5, false),
                         limited("diagonal", diagonal, 0.0, 0.0, true)};
  const auto outcome = rol::minimise(problem, tight());
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_LT(distance(outcome.design, {std::sqrt(1.125), std::sqrt(1.125), 0.5}), 1e-3);
  EXPECT_LT(outcome.violation, 1e-5);
}

TEST(Constraints, the_monitor_stops_inner_iterations) {
  auto cost = linearFunction({1.0, 2.0});
  auto circle = squares();
  auto problem = inBox(cost, 2, 0.5, -2.0, 2.0);
  problem.constraints = {limited("circle", circle, 2.0, 2.0, false)};
  Design last;
  const auto outcome = rol::minimise(problem, {}, [&](const rol::Iterate& iterate) {
    last = iterate.design;
    return !iterate.isInner;
  });
  EXPECT_EQ(outcome.ending, rol::Ending::Stopped);
  EXPECT_EQ(outcome.design, last);
  EXPECT_LE(outcome.values, 6);
}

} // namespace test_constraints
