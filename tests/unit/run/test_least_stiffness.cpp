// SPDX-License-Identifier: BSD-3-Clause

/// The least stiffness that a few motions show, of diagonal ones, on one rank.

#include "Harmos_LeastStiffness.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_least_stiffness {

using namespace Harmos;

namespace {

// K̂ = diag(reference), K_T = diag(reference · share): shares are what is looked for.
struct Diagonal {
  std::vector<double> reference, share;
  int motions = 0;

  run::StiffnessActions actions() {
    const auto scaled = [](const feti::TornVector& v, const std::vector<double>& by, bool inverse) {
      feti::TornVector result = v;
      for (std::size_t k = 0; k < by.size(); ++k)
        result[0][k] *= inverse ? 1.0 / by[k] : by[k];
      return result;
    };
    run::StiffnessActions result;
    result.motion = [this, scaled](const feti::TornVector& force) {
      ++motions;
      return std::optional<feti::TornVector>(scaled(force, reference, true));
    };
    result.reference = [this, scaled](const feti::TornVector& v) { return scaled(v, reference, false); };
    result.whole = [this, scaled](const feti::TornVector& v) {
      return scaled(scaled(v, reference, false), share, false);
    };
    result.product = [](const feti::TornVector& a, const feti::TornVector& b) {
      double sum = 0.0;
      for (std::size_t k = 0; k < a[0].size(); ++k)
        sum += a[0][k] * b[0][k];
      return sum;
    };
    return result;
  }
};

Diagonal bodies(const std::vector<double>& slender, std::size_t n) {
  Diagonal result;
  for (std::size_t k = 0; k < n; ++k) {
    result.reference.push_back(1.0 + static_cast<double>(k));
    result.share.push_back(k < slender.size() ? slender[k] : 1.0 - 0.02 / static_cast<double>(k));
  }
  return result;
}

} // namespace

// One motion below zero among fifty, beside one that stress stiffens a hundred times.
TEST(LeastStiffness, is_found_and_is_what_it_says) {
  for (const double wanted : {-2.0, -0.1, -0.01}) {
    Diagonal problem = bodies({wanted, 0.4, 100.0}, 50);
    const auto least = run::leastStiffness(problem.actions(), {std::vector<double>(50, 1.0)});
    ASSERT_TRUE(least.has_value());
    EXPECT_LT(least->value, 0.0);
    EXPECT_GE(least->value, wanted - 1e-12);
    // The value is that of the motion.
    double whole = 0.0, reference = 0.0;
    for (std::size_t k = 0; k < 50; ++k) {
      const double square = std::pow(least->motion[0][k], 2) * problem.reference[k];
      reference += square;
      whole += square * problem.share[k];
    }
    EXPECT_NEAR(reference, 1.0, 1e-12);
    EXPECT_NEAR(whole, least->value, 1e-12);
  }
}

TEST(LeastStiffness, of_what_is_stable_takes_one_motion_where_stresses_are_small) {
  Diagonal problem = bodies({0.9, 0.95}, 50);
  const auto least = run::leastStiffness(problem.actions(), {std::vector<double>(50, 1.0)});
  ASSERT_TRUE(least.has_value());
  EXPECT_GT(least->value, 0.9 - 1e-12);
  EXPECT_EQ(problem.motions, 1);
  Diagonal slender = bodies({0.05, 0.3, 100.0}, 50);
  const auto low = run::leastStiffness(slender.actions(), {std::vector<double>(50, 1.0)});
  EXPECT_NEAR(low->value, 0.05, 1e-3);
  EXPECT_GT(slender.motions, 1);
}

TEST(LeastStiffness, nothing_where_there_is_no_motion) {
  Diagonal problem = bodies({}, 5);
  run::StiffnessActions actions = problem.actions();
  actions.motion = [](const feti::TornVector&) { return std::nullopt; };
  EXPECT_FALSE(run::leastStiffness(actions, {std::vector<double>(5, 1.0)}).has_value());
}

} // namespace test_least_stiffness
