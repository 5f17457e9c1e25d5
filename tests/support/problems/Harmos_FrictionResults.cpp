// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FrictionResults.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace Harmos {
namespace {

constexpr double rounding = 1e-9; // as where rows of an answer are told apart

void expectLawAt(const run::ContactState& point, double limit, double slack, double slipTolerance) {
  const double traction = std::hypot(point.traction[0], point.traction[1], point.traction[2]);
  const double slip = std::hypot(point.slip[0], point.slip[1], point.slip[2]);
  EXPECT_LE(traction, limit + slack);
  if (point.friction == run::Friction::Sticks) {
    EXPECT_LE(slip, slipTolerance);
  } else if (point.friction == run::Friction::Slips) {
    double product = 0.0;
    for (std::size_t d = 0; d < 3; ++d)
      product -= point.traction[d] * point.slip[d];
    EXPECT_NEAR(traction, limit, slack);
    EXPECT_NEAR(product, traction * slip, traction * slipTolerance);
  }
}

} // namespace

long long countOf(const run::RunReport& report, run::Friction state) {
  return std::count_if(report.contact.begin(), report.contact.end(),
                       [state](const run::ContactState& point) { return point.friction == state; });
}

void expectTrescasLaw(const run::RunReport& report, const std::function<double(const fem::Point&)>& bound,
                      double slipTolerance) {
  for (std::size_t k = 0; k < report.contact.size(); ++k) {
    const double limit = bound(report.contactPoints[k].position);
    expectLawAt(report.contact[k], limit, rounding * limit, slipTolerance);
  }
}

void expectCoulombsLaw(const run::RunReport& report, double coefficient, double slipTolerance) {
  double largest = 0.0;
  for (const run::ContactState& point : report.contact)
    largest = std::max(largest, point.pressure);
  for (const run::ContactState& point : report.contact)
    expectLawAt(point, coefficient * point.pressure, rounding * largest, slipTolerance);
}

double largestDifference(const TestRun& a, const TestRun& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.solution.displacement.size(); ++i)
    for (std::size_t k = 0; k < a.solution.displacement[i].size(); ++k)
      most = std::max(most, std::abs(a.solution.displacement[i][k] - b.solution.displacement[i][k]));
  return globalMax(*testComm(), most);
}

} // namespace Harmos
