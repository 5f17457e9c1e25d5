// SPDX-License-Identifier: BSD-3-Clause

/// Designs and their functions as ROL has them: inner products, ROL's own checks of derivatives, what is
/// asked for how often, tolerances, errors.

#include "Harmos_DesignAdapters.hpp"
#include "Harmos_RolProblems.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace test_adapters {

using namespace Harmos;

namespace {

const Design weights = {0.5, 2.0, 4.0, 1.0, 8.0};

// x₀² + x₁x₂ + sin x₃ + x₄³, whose derivatives have all kinds of sizes.
TestFunction mixed() {
  return {[](const Design& x) { return x[0] * x[0] + x[1] * x[2] + std::sin(x[3]) + x[4] * x[4] * x[4]; },
          [](const Design& x) {
            return Design{2.0 * x[0], x[2], x[1], std::cos(x[3]), 3.0 * x[4] * x[4]};
          }};
}

// The least of ROL's differences between derivatives and quotients, over its sequence of steps.
double leastError(const std::vector<std::vector<double>>& rows) {
  double result = std::numeric_limits<double>::infinity();
  for (const auto& row : rows) // step, by the derivative, by the quotient, difference
    result = std::min(result, row[3]);
  return result;
}

} // namespace

TEST(Adapters, products_are_those_of_the_weights) {
  const Design a = scatteredDesign(5, 1), b = scatteredDesign(5, 2);
  const auto x = rol::makeDesign(a, weights), y = rol::makeDesign(b, weights);
  double weighted = 0.0, inverse = 0.0;
  for (std::size_t k = 0; k < 5; ++k) {
    weighted += weights[k] * a[k] * b[k];
    inverse += a[k] * b[k] / weights[k];
  }
  EXPECT_NEAR(x->dot(*y), weighted, 1e-15);
  const auto f = rol::makeDerivative(a, weights), g = rol::makeDerivative(b, weights);
  EXPECT_NEAR(f->dot(*g), inverse, 1e-15);
  EXPECT_NEAR(f->apply(*y), product(a, b), 1e-15);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_DOUBLE_EQ(rol::numbersOf(f->dual())[k], a[k] / weights[k]);
}

TEST(Adapters, vectors_pass_the_checks_of_ROL) {
  std::ostringstream silence;
  for (const auto& make : {rol::makeDesign, rol::makeDerivative}) {
    const auto x = make(scatteredDesign(5, 1), weights), y = make(scatteredDesign(5, 2), weights),
               z = make(scatteredDesign(5, 3), weights);
    const auto errors = x->checkVector(*y, *z, false, silence);
    ASSERT_FALSE(errors.empty());
    for (const double error : errors)
      EXPECT_LT(error, 1e-13); // sums of five numbers of about ten
  }
}

TEST(Adapters, gradients_pass_the_check_of_ROL) {
  std::ostringstream silence;
  auto function = mixed();
  rol::DesignObjective objective(function);
  objective.setFactor(3.0);
  const auto x = rol::makeDesign(scatteredDesign(5, 1), weights),
             d = rol::makeDesign(scatteredDesign(5, 2), weights), g = rol::makeDerivative(Design(5), weights);
  // The best of quotients of second order has an error of about ε^(2/3), 4e-11.
  const auto rows = objective.checkGradient(*x, *g, *d, false, silence, 13, 2);
  EXPECT_LT(leastError(rows), 1e-8);
  EXPECT_GT(std::abs(rows[0][1]), 0.1);
  double tolerance = 0.0;
  objective.gradient(*g, *x, tolerance);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_DOUBLE_EQ(rol::numbersOf(*g)[k], 3.0 * function.gradient(scatteredDesign(5, 1), 0.0)[k]);
}

TEST(Adapters, constraints_pass_the_checks_of_ROL) {
  std::ostringstream silence;
  auto function = mixed();
  rol::DesignLimit limit(function, rol::Tolerances::AsUsual, 0.25, 2.0);
  const auto x = rol::makeDesign(scatteredDesign(5, 1), weights),
             d = rol::makeDesign(scatteredDesign(5, 2), weights), g = rol::makeDerivative(Design(5), weights);
  const auto c = rol::makeNumber(0.0), multiplier = rol::makeNumber(1.5);
  double tolerance = 0.0;
  limit.value(*c, *x, tolerance);
  EXPECT_DOUBLE_EQ(rol::numbersOf(*c)[0], 0.25 * (function.value(scatteredDesign(5, 1), 0.0) - 2.0));
  const auto rows = limit.checkApplyJacobian(*x, *d, *c, false, silence, 13, 2);
  EXPECT_LT(leastError(rows), 1e-8); // as above
  EXPECT_GT(std::abs(rows[0][1]), 0.01);
  EXPECT_LT(limit.checkAdjointConsistencyJacobian(*multiplier, *d, *x, *multiplier, *g, false, silence),
            1e-14);
  EXPECT_LT(leastError(limit.checkApplyAdjointHessian(*x, *multiplier, *d, *g, false, silence, 13, 2)), 1e-6);
}

TEST(Adapters, infinite_bounds_hold_nothing) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto bounds = rol::makeBounds({-infinity, 0.0}, {1.0, infinity}, {1.0, 1.0});
  EXPECT_EQ(rol::numbersOf(*bounds->getLowerBound()), Design({ROL::ROL_NINF<double>(), 0.0}));
  EXPECT_EQ(rol::numbersOf(*bounds->getUpperBound()), Design({1.0, ROL::ROL_INF<double>()}));
  const auto x = rol::makeDesign({-1e30, 1e30}, {1.0, 1.0});
  bounds->project(*x);
  EXPECT_EQ(rol::numbersOf(*x), Design({-1e30, 1e30}));
  const auto y = rol::makeDesign({2.0, -2.0}, {1.0, 1.0});
  bounds->project(*y);
  EXPECT_EQ(rol::numbersOf(*y), Design({1.0, 0.0}));
  const auto limits = rol::makeLimits(-infinity, 3.0);
  const auto z = rol::makeNumber(7.0);
  limits->project(*z);
  EXPECT_EQ(rol::numbersOf(*z)[0], 3.0);
}

TEST(Adapters, what_is_known_is_not_computed_again) {
  auto function = mixed();
  rol::GuardedFunction guarded(function);
  const Design a = scatteredDesign(5, 1), b = scatteredDesign(5, 2), c = scatteredDesign(5, 3);
  guarded.value(a, 0.0);
  guarded.value(b, 0.0);
  guarded.gradient(b, 0.0);
  EXPECT_EQ(guarded.value(a, 0.0), mixed().value(a, 0.0));
  EXPECT_EQ(guarded.gradient(b, 0.0), mixed().gradient(b, 0.0));
  EXPECT_EQ(guarded.values(), 2);
  EXPECT_EQ(guarded.gradients(), 1);
  EXPECT_EQ(guarded.knownValue(b), mixed().value(b, 0.0));
  guarded.value(c, 0.0); // the third takes the place of a, which was asked for longest ago
  EXPECT_FALSE(guarded.knownValue(a).has_value());
  EXPECT_EQ(guarded.value(a, 0.0), mixed().value(a, 0.0));
  EXPECT_EQ(guarded.values(), 4);
}

TEST(Adapters, a_tighter_tolerance_asks_again) {
  auto function = mixed();
  rol::GuardedFunction guarded(function);
  const Design a = scatteredDesign(5, 1);
  for (const double tolerance : {1e-2, 1e-1, 1e-4, 0.0, 1e-2})
    guarded.value(a, tolerance);
  EXPECT_EQ(function.tolerances, std::vector<double>({1e-2, 1e-4}));
  guarded.value(a, 1e-6);
  EXPECT_EQ(function.tolerances.back(), 1e-6);
}

TEST(Adapters, tolerances_of_ROL_are_passed_on_relatively) {
  auto function = bowl(Design(5, 1.0), Design(5, 4.0)); // 40 at zero, with a gradient of √(16 Σ 1/weights)
  const auto x = rol::makeDesign(Design(5, 0.0), weights), y = rol::makeDesign(Design(5, 1.0), weights);
  const auto g = rol::makeDerivative(Design(5), weights);
  rol::DesignObjective objective(function);
  objective.setFactor(2.0);
  double tolerance = 1e300;
  objective.value(*x, tolerance);
  objective.gradient(*g, *x, tolerance);
  EXPECT_EQ(function.tolerances.back(), 0.0); // of what size is not known yet, and all would do
  EXPECT_EQ(function.gradientTolerances.back(), 0.0);
  tolerance = 0.8; // of twice the function: 0.4 of 40
  objective.value(*y, tolerance);
  EXPECT_DOUBLE_EQ(function.tolerances.back(), 0.01);
  objective.gradient(*g, *y, tolerance);
  double sum = 0.0;
  for (const double weight : weights)
    sum += 16.0 / weight;
  EXPECT_DOUBLE_EQ(function.gradientTolerances.back(), 0.4 / std::sqrt(sum));

  rol::DesignObjective usual(function, rol::Tolerances::AsUsual);
  usual.value(*x, tolerance);
  usual.value(*y, tolerance);
  EXPECT_EQ(function.tolerances.back(), 0.0);
}

TEST(Adapters, a_refused_design_is_far_worse_but_finite) {
  TestFunction function(
      [](const Design& x) -> double {
        if (x[0] > 1.0)
          throw sensitivity::RefusedDesign("the mesh tangles");
        return x[0] - 7.0;
      },
      [](const Design&) { return Design{1.0}; });
  rol::GuardedFunction guarded(function);
  EXPECT_THROW(guarded.value({2.0}, 0.0), sensitivity::RefusedDesign); // nothing to step back to

  rol::GuardedFunction second(function);
  second.value({0.5}, 0.0);
  const double value = second.value({2.0}, 0.0);
  EXPECT_GT(value, 1e20);
  EXPECT_LT(value * value, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(second.isRefused({2.0}));
  EXPECT_FALSE(second.isRefused({0.5}));
  second.value({2.0}, 0.0);
  EXPECT_EQ(second.refusals().count, 1);
  EXPECT_EQ(second.refusals().message, "the mesh tangles");
  second.value({3.0}, 0.0);
  EXPECT_EQ(second.refusals().count, 2);
  EXPECT_EQ(second.value({0.5}, 0.0), -6.5);

  // Two functions of one problem refuse a design together.
  const auto refusals = std::make_shared<rol::Refusals>();
  rol::GuardedFunction one(function, refusals), other(function, refusals);
  for (auto* each : {&one, &other})
    each->value({0.5}, 0.0);
  for (const double number : {2.0, 3.0})
    for (auto* each : {&one, &other})
      each->value({number}, 0.0);
  EXPECT_EQ(refusals->count, 2);
}

TEST(Adapters, after_an_error_there_is_no_other_answer) {
  TestFunction function([](const Design&) { return 1.0; },
                        [](const Design&) -> Design {
                          throw NumericalError("no solution", {{"step", "3"}});
                        });
  rol::GuardedFunction guarded(function);
  guarded.value({1.0}, 0.0);
  EXPECT_THROW(guarded.gradient({1.0}, 0.0), NumericalError);
  EXPECT_EQ(numericalErrorOf([&] { guarded.value({1.0}, 0.0); }), "no solution");
  EXPECT_EQ(function.designs.size(), 1u);
  EXPECT_TRUE(guarded.error() != nullptr);
}

} // namespace test_adapters
