// SPDX-License-Identifier: BSD-3-Clause

/// Designs without an answer, and errors, in the midst of a minimisation.

#include "Harmos_Minimise.hpp"
#include "Harmos_RolProblems.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_refusals {

using namespace Harmos;

namespace {

// A skew bowl that has no answer where the sum of the numbers is above a limit.
class Walled : public sensitivity::DesignFunction {
 public:
  Walled(std::size_t n, double optimum, double limit)
      : limit_(limit), bowl_(skewBowl(n, 30.0, Design(n, optimum))) {}

  double value(const Design& design, double tolerance) override {
    if (sum(design) > limit_)
      throw sensitivity::RefusedDesign("body lifts off at " + std::to_string(sum(design)));
    return bowl_.value(design, tolerance);
  }
  Design gradient(const Design& design, double tolerance) override {
    EXPECT_LE(sum(design), limit_); // never asked for where there is no value
    return bowl_.gradient(design, tolerance);
  }

  static double sum(const Design& design) { return product(design, Design(design.size(), 1.0)); }

 private:
  double limit_;
  TestFunction bowl_;
};

sensitivity::DesignProblem problemOf(sensitivity::DesignFunction& cost, std::size_t n) {
  auto unused = linearFunction(Design(n, 1.0));
  auto result = inBox(unused, n, -0.5, -2.0, 2.0);
  result.cost = &cost;
  return result;
}

struct Method {
  const char* type;
  const char* model;
};
const std::vector<Method> methods = {{"Trust Region", "Lin-More"},
                                     {"Trust Region", "SPG"},
                                     {"Line Search", "Lin-More"},
                                     {"Spectral Gradient", "Lin-More"}};

Teuchos::ParameterList optionsOf(const Method& method) {
  Teuchos::ParameterList options;
  options.sublist("Step").set("Type", method.type);
  options.sublist("Step").sublist("Trust Region").set("Subproblem Model", method.model);
  return options;
}

} // namespace

// The optimum is on the near side of the wall, and first steps go beyond it.
TEST(Refusals, a_refused_step_is_taken_back) {
  for (const auto& method : methods) {
    if (std::string(method.type) == "Spectral Gradient")
      continue; // its next step is the longest that it knows where the last one was cut short
    SCOPED_TRACE(std::string(method.type) + " " + method.model);
    Walled cost(6, 0.1, 0.7);
    const auto outcome = rol::minimise(problemOf(cost, 6), optionsOf(method), {}, 2.0);
    EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
    EXPECT_GT(outcome.refused, 0);
    EXPECT_TRUE(contains(outcome.refusal, "body lifts off")) << outcome.refusal;
    // The first gradient is below 0.6·√6·30 = 44, the tolerance 1e-3 of it, the least curvature 1.
    EXPECT_LT(distance(outcome.design, Design(6, 0.1)), 0.05);
  }
}

// What was refused long before the end does not explain it.
TEST(Refusals, old_refusals_do_not_end_a_run) {
  Walled cost(6, 0.1, 0.7);
  Teuchos::ParameterList options;
  options.sublist("Status Test").set("Gradient Tolerance", 1e-15);
  const auto outcome = rol::minimise(problemOf(cost, 6), options, {}, 2.0);
  EXPECT_GT(outcome.refused, 0);
  EXPECT_EQ(outcome.ending, rol::Ending::StepTolerance) << outcome.reason;
  EXPECT_LT(distance(outcome.design, Design(6, 0.1)), 1e-4);
}

TEST(Refusals, a_wall_before_the_optimum_ends_the_run_with_the_best_design) {
  for (const auto& method : methods) {
    SCOPED_TRACE(std::string(method.type) + " " + method.model);
    Walled cost(6, 0.5, 0.7);
    std::vector<double> costs;
    auto options = optionsOf(method);
    options.sublist("Status Test").set("Iteration Limit", 300);
    const auto outcome = rol::minimise(problemOf(cost, 6), options, [&](const rol::Iterate& iterate) {
      costs.push_back(iterate.cost);
      return true;
    });
    EXPECT_EQ(outcome.ending, rol::Ending::Refused) << outcome.reason;
    EXPECT_FALSE(outcome.isConverged());
    EXPECT_TRUE(contains(outcome.reason, "body lifts off")) << outcome.reason;
    EXPECT_TRUE(contains(outcome.reason, "bounds of the design")) << outcome.reason;
    EXPECT_LE(Walled::sum(outcome.design), 0.7);
    EXPECT_GT(Walled::sum(outcome.design), 0.0);
    EXPECT_EQ(outcome.cost, *std::min_element(costs.begin(), costs.end()));
  }
}

TEST(Refusals, the_first_design_has_none_to_step_back_to) {
  Walled cost(6, 0.5, -10.0);
  try {
    rol::minimise(problemOf(cost, 6));
    FAIL() << "no error";
  } catch (const sensitivity::RefusedDesign& error) {
    EXPECT_TRUE(contains(error.what(), "body lifts off"));
  }
}

TEST(Refusals, a_constraint_may_refuse) {
  auto cost = bowl(Design(2, 1.0), Design(2, 1.5));
  int refused = 0;
  TestFunction circle(
      [&](const Design& x) {
        if (x[0] > 1.2) {
          ++refused;
          throw sensitivity::RefusedDesign("too far");
        }
        return product(x, x);
      },
      [](const Design& x) {
        return Design{2.0 * x[0], 2.0 * x[1]};
      });
  auto problem = inBox(cost, 2, 0.2, -2.0, 2.0);
  problem.constraints = {limited("circle", circle, 0.0, 2.0, false)};
  const auto outcome = rol::minimise(problem, {}, {}, 1.0);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_GT(refused, 0);
  EXPECT_EQ(outcome.refused, refused);
  EXPECT_LT(distance(outcome.design, {1.0, 1.0}), 1e-2);
}

namespace {

struct NoStandardException {
  int number;
};

} // namespace

TEST(Refusals, other_errors_go_through_unchanged) {
  for (const auto& method : methods)
    for (const bool isStandard : {true, false}) {
      int count = 0;
      auto good = skewBowl(6, 30.0, Design(6, 0.1));
      TestFunction cost(
          [&](const Design& x) -> double {
            if (++count < 4)
              return good.value(x, 0.0);
            if (isStandard)
              throw NumericalError("no equilibrium", {{"subdomain", "7"}});
            throw NoStandardException{5};
          },
          [&](const Design& x) { return good.gradient(x, 0.0); });
      try {
        rol::minimise(inBox(cost, 6, -0.5, -2.0, 2.0), optionsOf(method));
        FAIL() << "no error";
      } catch (const NumericalError& error) {
        EXPECT_TRUE(isStandard);
        EXPECT_STREQ(error.what(), "no equilibrium");
        ASSERT_EQ(error.data().size(), 1u);
        EXPECT_EQ(error.data()[0].second, "7");
      } catch (const NoStandardException& error) {
        EXPECT_FALSE(isStandard);
        EXPECT_EQ(error.number, 5);
      }
      EXPECT_EQ(count, 4);
    }
}

// ROL's augmented Lagrangian catches all errors where it scales constraints.
TEST(Refusals, errors_that_ROL_keeps_to_itself_come_out) {
  for (int last = 1; last < 6; ++last) {
    int count = 0;
    auto cost = bowl(Design(2, 1.0), Design(2, 1.5));
    TestFunction circle([&](const Design& x) { return product(x, x); },
                        [&](const Design& x) -> Design {
                          if (++count >= last)
                            throw NumericalError("the " + std::to_string(last) + "th gradient");
                          return {2.0 * x[0], 2.0 * x[1]};
                        });
    auto problem = inBox(cost, 2, 0.2, -2.0, 2.0);
    problem.constraints = {limited("circle", circle, 1.0, 1.0, false)};
    EXPECT_EQ(numericalErrorOf([&] { rol::minimise(problem); }),
              "the " + std::to_string(last) + "th gradient");
    EXPECT_EQ(count, last);
  }
}

TEST(Refusals, errors_of_the_monitor_go_through) {
  auto cost = bowl({1.0, 30.0}, {0.5, -0.5});
  EXPECT_EQ(numericalErrorOf([&] {
              rol::minimise(inBox(cost, 2, 0.0, -1.0, 1.0), {},
                            [](const rol::Iterate&) -> bool { throw NumericalError("disk full"); });
            }),
            "disk full");
}

} // namespace test_refusals
