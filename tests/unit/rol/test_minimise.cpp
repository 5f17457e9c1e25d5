// SPDX-License-Identifier: BSD-3-Clause

/// Known optima, what they cost, what is told on the way, how a run ends, ROL's parameters.

#include "Harmos_Minimise.hpp"
#include "Harmos_RolOptions.hpp"
#include "Harmos_RolProblems.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <gtest/gtest.h>

#include <algorithm>

namespace test_minimise {

using namespace Harmos;

namespace {

// The least of ½Σ a (x − t)² with Σ v x = volume between bounds: x = clamp(t − λ v/a), λ by bisection.
Design levelled(const Design& a, const Design& target, const Design& v, double volume, double lower,
                double upper) {
  Design x(a.size());
  double least = -1e3, most = 1e3;
  for (int step = 0; step < 200; ++step) {
    const double multiplier = 0.5 * (least + most);
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] = std::clamp(target[k] - multiplier * v[k] / a[k], lower, upper);
    (product(v, x) > volume ? least : most) = multiplier;
  }
  return x;
}

struct Levelled {
  std::size_t n = 40;
  Design a = Design(n), target = Design(n), v = Design(n);
  Levelled() {
    for (std::size_t k = 0; k < n; ++k) {
      a[k] = std::pow(100.0, static_cast<double>(k) / static_cast<double>(n - 1)); // 1 to 100
      target[k] = 1.5 * scattered(static_cast<int>(k));
      v[k] = 1.0 + 0.5 * scattered(3 * static_cast<int>(k) + 1);
    }
  }
};

} // namespace

TEST(Minimise, bounds_and_a_volume) {
  const Levelled data;
  auto cost = bowl(data.a, data.target);
  auto volume = linearFunction(data.v);
  auto problem = inBox(cost, data.n, 0.0, -1.0, 1.0);
  for (std::size_t k = 0; k < data.n; ++k)
    problem.space.weights[k] = k % 3 == 0 ? 0.25 : 2.0;
  problem.constraints = {limited("volume", volume, 6.0, 6.0, true)};
  Teuchos::ParameterList options;
  options.sublist("Status Test").set("Gradient Tolerance", 1e-6);
  double first = 0.0;
  const auto outcome = rol::minimise(problem, options, [&](const rol::Iterate& iterate) {
    if (iterate.iteration == 0)
      first = iterate.gradientNorm;
    EXPECT_EQ(iterate.design, cost.gradientDesigns.back());
    EXPECT_LT(iterate.violation, 1e-10); // of rounding: projections are exact
    for (const double number : iterate.design)
      EXPECT_LE(std::abs(number), 1.0);
    return true;
  });
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  const Design optimum = levelled(data.a, data.target, data.v, 6.0, -1.0, 1.0);
  EXPECT_GT(std::count(optimum.begin(), optimum.end(), 1.0), 3);
  EXPECT_GT(std::count(optimum.begin(), optimum.end(), -1.0), 3);
  // The gradient is a 1e-6th of the first, of about 600 with the weights of a quarter, the least curvature
  // 1/2.
  EXPECT_LT(distance(outcome.design, optimum), 1e-2);
  EXPECT_NEAR(outcome.cost, cost.value(optimum, 0.0), 1e-5 * outcome.cost);
  EXPECT_LT(outcome.gradientNorm, 2e-6 * first); // which bounds may shorten by a half
  ASSERT_EQ(outcome.constraints.size(), 1u);
  EXPECT_NEAR(outcome.constraints[0], 6.0, 1e-9);
}

// The mean of pressures is held, and by the inequality of power means the least norm is that of the uniform
// one.
TEST(Minimise, the_least_norm_of_pressures_is_that_of_a_uniform_one) {
  const Pressures pressures{60};
  auto cost = pressureNorm(pressures);
  auto mean = meanPressure(pressures);
  auto problem = inBox(cost, 60, 0.0, -1.0, 1.0);
  problem.space.weights.assign(60, 1.0 / 60.0);
  const double held = mean.value(problem.space.start, 0.0);
  problem.constraints = {limited("force", mean, held, held, true)};
  const auto outcome = rol::minimise(problem);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_GT(cost.value(problem.space.start, 0.0), 1.4 * held);
  EXPECT_LT(outcome.cost, 1.0005 * held);
  const Design p = pressures.all(outcome.design);
  EXPECT_LT(*std::max_element(p.begin(), p.end()), 1.02 * held);
  EXPECT_GE(outcome.values, 10);
  EXPECT_LE(outcome.values, 40);
}

// Each evaluation of a real cost is a solution of a contact problem.
TEST(Minimise, evaluations_are_few) {
  const std::size_t n = 60;
  auto cost = skewBowl(n, 1e3, scatteredDesign(n, 4));
  auto volume = linearFunction(Design(n, 1.0 / 60.0));
  auto problem = inBox(cost, n, 0.0, -0.8, 0.8);
  problem.constraints = {limited("volume", volume, 0.1, 0.1, true)};
  const auto outcome = rol::minimise(problem);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_GE(outcome.values, 20);
  EXPECT_LE(outcome.values, 65);
  EXPECT_LE(outcome.gradients, outcome.values);
  EXPECT_EQ(static_cast<std::size_t>(outcome.values), cost.designs.size());
  EXPECT_EQ(static_cast<std::size_t>(outcome.gradients), cost.gradientDesigns.size());
  // The gradient is never asked for but where the value was asked for just before.
  for (const auto& design : cost.gradientDesigns)
    EXPECT_NE(std::find(cost.designs.begin(), cost.designs.end(), design), cost.designs.end());

  Teuchos::ParameterList options;
  options.sublist("Step").set("Type", "Spectral Gradient");
  options.sublist("Status Test").set("Iteration Limit", 200);
  auto again = skewBowl(n, 1e3, scatteredDesign(n, 4));
  problem.cost = &again;
  EXPECT_GT(rol::minimise(problem, options).values, 2 * outcome.values);
}

// Powers of two change no digit, but ROL has some tolerances without units, of projections and of ratios: the
// same number of designs, and the same ones but for these.
TEST(Minimise, units_do_not_matter) {
  const double length = std::ldexp(1.0, -10), energy = std::ldexp(1.0, 40), area = std::ldexp(1.0, -6);
  const Levelled data;
  std::vector<Design> asked[2];
  for (const bool inOtherUnits : {false, true}) {
    const double unit = inOtherUnits ? length : 1.0;
    Design target = data.target;
    for (double& number : target)
      number *= unit;
    auto cost = bowl(data.a, target, inOtherUnits ? energy : 1.0);
    auto volume = linearFunction(data.v);
    auto problem = inBox(cost, data.n, 0.0, -unit, unit);
    problem.space.weights.assign(data.n, inOtherUnits ? area : 1.0);
    problem.constraints = {limited("volume", volume, 6.0 * unit, 6.0 * unit, true)};
    EXPECT_TRUE(rol::minimise(problem).isConverged());
    asked[inOtherUnits] = cost.designs;
    for (auto& design : asked[inOtherUnits])
      for (double& number : design)
        number /= unit;
  }
  ASSERT_EQ(asked[0].size(), asked[1].size());
  for (std::size_t k = 0; k < asked[0].size(); ++k)
    EXPECT_LT(distance(asked[0][k], asked[1][k]), 1e-6) << k;
}

TEST(Minimise, two_runs_ask_for_the_same_designs) {
  std::vector<Design> asked[2];
  for (auto& designs : asked) {
    auto cost = skewBowl(30, 100.0, scatteredDesign(30, 4));
    auto one = linearFunction(Design(30, 1.0)), other = linearFunction(scatteredDesign(30, 5));
    auto problem = inBox(cost, 30, 0.0, -0.8, 0.8);
    problem.constraints = {limited("one", one, 1.0, 1.0, true), limited("other", other, -0.5, 0.5, true)};
    EXPECT_TRUE(rol::minimise(problem).isConverged());
    designs = cost.designs;
  }
  EXPECT_EQ(asked[0], asked[1]);
  // The projected start is asked for once, though ROL projects it again.
  EXPECT_GT(distance(asked[0][0], asked[0][1]), 1e-3);

  // And so do all ranks.
  const auto comm = testComm();
  Design first = asked[0].back();
  Teuchos::broadcast(*comm, 0, static_cast<int>(first.size()), first.data());
  EXPECT_EQ(first, asked[0].back());
}

// The volume holds nearly all of the first gradient; what it leaves is what the tolerance is about.
TEST(Minimise, a_gradient_that_a_constraint_holds) {
  const Levelled data;
  auto part = bowl(data.a, data.target);
  TestFunction cost([&](const Design& x) { return part.value(x, 0.0) + 1e5 * product(data.v, x); },
                    [&](const Design& x) {
                      Design result = part.gradient(x, 0.0);
                      for (std::size_t k = 0; k < x.size(); ++k)
                        result[k] += 1e5 * data.v[k];
                      return result;
                    });
  auto volume = linearFunction(data.v);
  auto problem = inBox(cost, data.n, 0.0, -1.0, 1.0);
  problem.constraints = {limited("volume", volume, 6.0, 6.0, true)};
  const auto outcome = rol::minimise(problem);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  // The first gradient without its normal part is below 600, the tolerance 1e-3 of it, the least curvature 1.
  EXPECT_LT(distance(outcome.design, levelled(data.a, data.target, data.v, 6.0, -1.0, 1.0)), 0.6);
  EXPECT_LT(outcome.cost - cost.value(levelled(data.a, data.target, data.v, 6.0, -1.0, 1.0), 0.0), 0.1);
  EXPECT_GT(outcome.iterations, 5);
}

// Spectral gradients go uphill; the outcome is the best that they passed.
TEST(Minimise, the_best_design_counts_where_the_last_is_none) {
  int uphill = 0;
  for (int limit = 8; limit < 20; ++limit) {
    auto cost = skewBowl(20, 100.0, scatteredDesign(20, 4));
    Teuchos::ParameterList options;
    options.sublist("Step").set("Type", "Spectral Gradient");
    options.sublist("Status Test").set("Iteration Limit", limit);
    std::vector<double> costs;
    const auto outcome =
        rol::minimise(inBox(cost, 20, 0.0, -0.8, 0.8), options, [&](const rol::Iterate& iterate) {
          costs.push_back(iterate.cost);
          return true;
        });
    EXPECT_EQ(outcome.cost, *std::min_element(costs.begin(), costs.end()));
    EXPECT_NEAR(cost.value(outcome.design, 0.0), outcome.cost, 1e-12 * costs[0]);
    uphill += costs.back() > outcome.cost;
  }
  EXPECT_GT(uphill, 0);
}

TEST(Minimise, without_bounds) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Design target = scatteredDesign(8, 3);
  auto cost = bowl(Design(8, 4.0), target);
  const auto outcome = rol::minimise(inBox(cost, 8, 0.0, -infinity, infinity));
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_LT(distance(outcome.design, target), 1e-2); // a thousandth of the first distance, which is below 3
  auto ring = linearFunction(Design(8, 1.0));
  auto problem = inBox(cost, 8, 0.0, -infinity, infinity);
  problem.constraints = {limited("sum", ring, 2.0, 2.0, true)};
  const auto held = rol::minimise(problem);
  EXPECT_TRUE(held.isConverged()) << held.reason;
  EXPECT_LT(distance(held.design, levelled(Design(8, 4.0), target, Design(8, 1.0), 2.0, -9.0, 9.0)), 1e-2);
}

TEST(Minimise, an_optimal_start_is_left_as_it_is) {
  auto cost = bowl({1.0, 4.0}, {2.0, 0.25});
  auto problem = inBox(cost, 2, 0.25, -1.0, 1.0);
  problem.space.start = {1.0, 0.25}; // held by its bound
  const auto outcome = rol::minimise(problem);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_EQ(outcome.design, Design({1.0, 0.25}));
  EXPECT_EQ(outcome.values, 1);
  EXPECT_EQ(outcome.iterations, 0);
}

TEST(Minimise, the_monitor_is_told_of_each_iterate_and_stops) {
  auto cost = skewBowl(20, 100.0, scatteredDesign(20, 4));
  const auto problem = inBox(cost, 20, 0.0, -0.8, 0.8);
  std::vector<rol::Iterate> told;
  const auto whole = rol::minimise(problem, {}, [&](const rol::Iterate& iterate) {
    told.push_back(iterate);
    return true;
  });
  ASSERT_GT(told.size(), 6u);
  EXPECT_EQ(told[0].iteration, 0);
  EXPECT_EQ(told[0].step, 0.0);
  EXPECT_EQ(told[0].design, problem.space.start);
  for (std::size_t k = 1; k < told.size(); ++k) {
    EXPECT_GT(told[k].iteration, told[k - 1].iteration);
    EXPECT_LT(told[k].cost, told[k - 1].cost);
    EXPECT_NEAR(told[k].cost, cost.value(told[k].design, 0.0), 1e-12 * told[0].cost);
    EXPECT_NEAR(told[k].step, distance(told[k].design, told[k - 1].design), 1e-12);
    EXPECT_GT(told[k].values, told[k - 1].values);
  }
  EXPECT_EQ(told.back().design, whole.design);
  EXPECT_EQ(told.back().values, whole.values);

  const auto part =
      rol::minimise(problem, {}, [&](const rol::Iterate& iterate) { return iterate.iteration < 3; });
  EXPECT_EQ(part.ending, rol::Ending::Stopped);
  EXPECT_FALSE(part.isConverged());
  EXPECT_EQ(part.iterations, 3);
  EXPECT_EQ(part.design, told[3].design);
  EXPECT_EQ(part.cost, told[3].cost);
  EXPECT_TRUE(contains(part.reason, "stopped")) << part.reason;
}

// The projected gradient of x = 0 in a bowl that its bounds do not hold: √(Σ (a t)²/w).
TEST(Minimise, the_gradient_norm_is_in_the_units_of_the_caller) {
  auto cost = bowl({2.0, 8.0}, {0.5, -0.25}, 1e6);
  auto problem = inBox(cost, 2, 0.0, -1.0, 1.0);
  problem.space.weights = {0.25, 4.0};
  double norm = 0.0;
  rol::minimise(problem, {}, [&](const rol::Iterate& iterate) {
    norm = iterate.gradientNorm;
    return false;
  });
  EXPECT_NEAR(norm, 1e6 * std::sqrt(1.0 / 0.25 + 4.0 / 4.0), 1.0);

  Teuchos::ParameterList options;
  options.sublist("Status Test").set("Use Relative Tolerances", false);
  options.sublist("Status Test").set("Gradient Tolerance", 100.0);
  options.sublist("Status Test").set("Step Tolerance", 1e-12);
  const auto outcome = rol::minimise(problem, options);
  EXPECT_TRUE(outcome.isConverged()) << outcome.reason;
  EXPECT_LT(outcome.gradientNorm, 100.0);

  // Steps in the units of the design, in a box whose diagonal is 400 of them.
  problem.space.lower.assign(2, -100.0);
  problem.space.upper.assign(2, 100.0);
  options.sublist("Status Test").set("Gradient Tolerance", 1e-30);
  options.sublist("Status Test").set("Step Tolerance", 0.01);
  std::vector<double> steps;
  const auto coarse = rol::minimise(problem, options, [&](const rol::Iterate& iterate) {
    steps.push_back(iterate.step);
    return true;
  });
  EXPECT_EQ(coarse.ending, rol::Ending::StepTolerance);
  ASSERT_GT(steps.size(), 2u);
  EXPECT_LE(steps.back(), 0.01);
  EXPECT_GT(*std::min_element(steps.begin() + 1, steps.end() - 1), 0.01);
}

TEST(Minimise, ends_without_an_optimum_are_told) {
  auto cost = skewBowl(20, 100.0, scatteredDesign(20, 4));
  const auto problem = inBox(cost, 20, 0.0, -0.8, 0.8);
  Teuchos::ParameterList options;
  options.sublist("Status Test").set("Iteration Limit", 2);
  const auto limited = rol::minimise(problem, options);
  EXPECT_EQ(limited.ending, rol::Ending::IterationLimit);
  EXPECT_TRUE(contains(limited.reason, "the limit of 2 iterations was reached; raise \"Iteration Limit\""));

  // Derivatives with the wrong sign: no step is better.
  TestFunction wrong([](const Design& x) { return product(x, x); },
                     [](const Design& x) {
                       return Design{-2.0 * x[0], -2.0 * x[1]};
                     });
  const auto stuck = rol::minimise(inBox(wrong, 2, 0.5, -1.0, 1.0));
  EXPECT_EQ(stuck.ending, rol::Ending::StepTolerance);
  EXPECT_TRUE(contains(stuck.reason, "too inaccurate")) << stuck.reason;
  EXPECT_EQ(stuck.design, Design({0.5, 0.5}));

  TestFunction none([](const Design&) { return std::nan(""); }, [](const Design& x) { return x; });
  const auto nothing = rol::minimise(inBox(none, 2, 0.5, -1.0, 1.0));
  EXPECT_EQ(nothing.ending, rol::Ending::NoNumber);
  EXPECT_TRUE(contains(nothing.reason, "not a number")) << nothing.reason;
}

TEST(Minimise, tolerances_are_passed_on_where_the_parameters_say_so) {
  for (const bool inexact : {false, true}) {
    auto cost = skewBowl(20, 100.0, scatteredDesign(20, 4));
    Teuchos::ParameterList options;
    options.sublist("General").set("Inexact Objective Function", inexact);
    options.sublist("General").set("Inexact Gradient", inexact);
    options.sublist("Step").sublist("Trust Region").set("Subproblem Model", "SPG");
    EXPECT_TRUE(rol::minimise(inBox(cost, 20, 0.0, -0.8, 0.8), options).isConverged());
    const auto asked = [](double tolerance) { return tolerance > 0.0 && tolerance < 1.0; };
    const auto values = std::count_if(cost.tolerances.begin(), cost.tolerances.end(), asked);
    const auto gradients =
        std::count_if(cost.gradientTolerances.begin(), cost.gradientTolerances.end(), asked);
    EXPECT_EQ(values > 5, inexact) << values;
    EXPECT_EQ(gradients > 5, inexact) << gradients;
    if (!inexact) {
      EXPECT_EQ(values + gradients, 0);
    }
  }
}

TEST(Minimise, nothing_is_printed) {
  auto cost = skewBowl(20, 100.0, scatteredDesign(20, 4));
  auto volume = linearFunction(Design(20, 1.0));
  auto problem = inBox(cost, 20, 0.0, -0.8, 0.8);
  problem.constraints = {limited("volume", volume, 1.0, 1.0, true)};
  Teuchos::ParameterList options;
  options.sublist("General").set("Output Level", 3);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto outcome = rol::minimise(problem, options);
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(outcome.isConverged());
}

TEST(Minimise, parameters_that_ROL_does_not_have_are_refused) {
  const auto message = [](auto set) {
    Teuchos::ParameterList options;
    set(options);
    return inputErrorOf([&] { rol::completeOptions(options, false); });
  };
  EXPECT_TRUE(
      contains(message([](auto& o) { o.sublist("Status Test").set("Gradient Tolerence", 1e-3); }),
               "no parameter \"Status Test/Gradient Tolerence\"; did you mean \"Gradient Tolerance\""));
  EXPECT_TRUE(contains(message([](auto& o) { o.sublist("Steps"); }), "did you mean \"Step\""));
  EXPECT_TRUE(contains(message([](auto& o) { o.set("Step", 1.0); }), "\"Step\" is a list of ROL"));
  EXPECT_TRUE(contains(message([](auto& o) { o.sublist("Status Test").set("Iteration Limit", 2.5); }),
                       "\"Status Test/Iteration Limit\" of ROL is of the type int"));
  EXPECT_TRUE(contains(message([](auto& o) { o.sublist("Step").set("Type", "Trust Regoin"); }),
                       "no method \"Trust Regoin\""));
  EXPECT_TRUE(contains(message([](auto& o) { o.sublist("Step").set("Type", "Augmented Lagrangian"); }),
                       "for this problem"));
  Teuchos::ParameterList whole;
  whole.sublist("Status Test").set("Gradient Tolerance", 1);
  EXPECT_EQ(rol::completeOptions(whole, false).sublist("Status Test").get<double>("Gradient Tolerance"), 1.0);
  EXPECT_EQ(message([](auto& o) {
              o.sublist("Step").sublist("Spectral Gradient").set("Maximum Storage Size", 5);
              o.sublist("General").sublist("Polyhedral Projection").set("Absolute Tolerance", 1e-9);
            }),
            "");
}

} // namespace test_minimise
