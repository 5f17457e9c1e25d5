// SPDX-License-Identifier: BSD-3-Clause

/// Curvatures that are tiny beside the largest and yet numbers of their own, as where entries are measured in
/// units far apart: no direction is unbounded because of that. Those that rounding leaves of others are.

#include "Harmos_CurvatureTerms.hpp"
#include "Harmos_RandomQp.hpp"
#include "Harmos_SolvedQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_tiny_curvatures {

using namespace Harmos;
using namespace Harmos::qp;

namespace {} // namespace

// min ½·10⁶x₁² + ½·10⁻⁸x₂² − x₂: 14 orders, x₂ = 10⁸.
TEST(TinyCurvatures, two_units) {
  for (bool bounds : {false, true}) {
    SmallQp qp{Dense(2, 2), {0.0, 1.0}, {}, {}, Dense(0, 2), {}};
    qp.a(0, 0) = 1e6;
    qp.a(1, 1) = 1e-8;
    if (bounds)
      qp.lower.assign(2, 0.0);
    for (const std::string& name : solversFor(qp)) {
      const SolvedQp answer = solvedBy(name, qp, 1e-10);
      ASSERT_TRUE(answer.result.converged()) << name << ": " << answer.result.explanation;
      EXPECT_NEAR(qp.cost(answer.x), -5e7, 1e-8 * 5e7) << name;
    }
  }
}

// x = Π(b/a), an entry at a time, of curvatures from 1 down to 10⁻¹⁸.
TEST(TinyCurvatures, separable_problems) {
  std::mt19937 random(1818);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int converged = 0, solved = 0;
  for (int k = 0; k < 200; ++k) {
    const int n = 2 + k % 5;
    SmallQp qp{Dense(n, n), {}, {}, {}, Dense(0, n), {}};
    std::vector<double> expected;
    for (int i = 0; i < n; ++i) {
      qp.a(i, i) = std::pow(10.0, i == 0 ? 0.0 : -18.0 * (k % 10 + 1) / 10.0 * i / (n - 1));
      qp.b.push_back(unit(random));
      const double free = qp.b.back() / qp.a(i, i);
      qp.lower.push_back(k % 3 == 0 ? -infinity : k % 3 == 1 ? 0.0 : -0.5 * std::abs(free));
      qp.upper.push_back(k % 2 == 0 ? infinity : 2.0 * std::abs(free));
      expected.push_back(std::min(std::max(free, qp.lower.back()), qp.upper.back()));
    }
    for (const std::string& name : solversFor(qp)) {
      const SolvedQp answer = solvedBy(name, qp, 1e-8);
      ++solved;
      ASSERT_NE(answer.result.reason, Reason::Unbounded) << k << " " << name << answer.result.explanation;
      ASSERT_NE(answer.result.reason, Reason::Breakdown) << k << " " << name << answer.result.explanation;
      if (!answer.result.converged()) {
        if (std::getenv("HARMOS_PRINT_TABLE") != nullptr)
          std::cout << k << " " << name << ": " << answer.result.explanation << "\n";
        continue;
      }
      ++converged;
      const double cost = qp.cost(answer.x), best = qp.cost(expected);
      EXPECT_NEAR(cost, best, 1e-6 * std::abs(best)) << k << " " << name;
    }
  }
  EXPECT_GT(2 * converged, solved); // others end at the rounding errors that ‖A‖‖x‖ has
}

// The same in coordinates that mix: entries measured in two units.
TEST(TinyCurvatures, two_units_that_mix) {
  std::mt19937 random(1414);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int converged = 0, solved = 0;
  for (int k = 0; k < 100; ++k) {
    const int n = 3 + k % 4;
    const double small = std::pow(10.0, -(k % 10)); // curvatures go with its square
    SmallQp in = randomQp(random, n, 0, false, 10.0), out = in;
    in.lower.assign(static_cast<std::size_t>(n), -infinity);
    std::vector<double> scale;
    for (int i = 0; i < n; ++i) {
      scale.push_back(i < n / 2 ? small : 1.0);
      in.lower[static_cast<std::size_t>(i)] = k % 2 == 0 ? -1.0 : -infinity;
    }
    out.lower = in.lower;
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      out.b[at] *= scale[at];
      out.lower[at] /= scale[at];
      for (int j = 0; j < n; ++j)
        out.a(i, j) *= scale[at] * scale[static_cast<std::size_t>(j)];
    }
    const double best = in.cost(bruteForce(in));
    for (const std::string& name : solversFor(out)) {
      const SolvedQp answer = solvedBy(name, out, 1e-12 * small);
      ++solved;
      ASSERT_NE(answer.result.reason, Reason::Unbounded) << k << " " << name << answer.result.explanation;
      ASSERT_NE(answer.result.reason, Reason::Breakdown) << k << " " << name << answer.result.explanation;
      if (!answer.result.converged()) {
        if (std::getenv("HARMOS_PRINT_TABLE") != nullptr)
          std::cout << k << " " << name << ": " << answer.result.explanation << "\n";
        continue;
      }
      ++converged;
      EXPECT_NEAR(out.cost(answer.x), best, 1e-7 * std::abs(best)) << k << " " << name << " " << small;
    }
  }
  EXPECT_GT(4 * converged, solved); // of 300 some 116
}

// A dense matrix' kernel is one to rounding errors, and a load along it has no end.
TEST(TinyCurvatures, kernels_are_told) {
  std::mt19937 random(99);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = unboundedQp(random, 3 + k % 5, 0, k % 2 == 0);
    for (const std::string& name : solversFor(qp)) {
      const SolvedQp answer = solvedBy(name, qp, 1e-8);
      EXPECT_EQ(answer.result.reason, Reason::Unbounded) << k << " " << name << answer.result.explanation;
    }
  }
}

} // namespace test_tiny_curvatures
