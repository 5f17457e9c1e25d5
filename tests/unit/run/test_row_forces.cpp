// SPDX-License-Identifier: BSD-3-Clause

/// The force of a constraint row that nearly cancels is beyond all that bodies feel: the audit objects.

#include "Harmos_RunReport.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

namespace test_row_forces {

using namespace Harmos;

namespace {

run::RunReport reportOf(double rowForce, double forces) {
  run::RunReport report;
  report.tolerance = 1e-4;
  report.audit.forces = forces;
  report.audit.unitForce = 1.0;
  report.audit.largestRowForce = rowForce;
  return report;
}

} // namespace

TEST(RowForces, beyond_what_bodies_feel) {
  EXPECT_TRUE(feti::auditAgrees(reportOf(100.0, 2.0)));
  const run::RunReport wrong = reportOf(1e15, 2.0);
  EXPECT_FALSE(feti::auditAgrees(wrong));
  EXPECT_TRUE(contains(feti::rowForceText(wrong), "1.00e+15")) << feti::rowForceText(wrong);
}

// Rounding errors of bodies at rest say nothing.
TEST(RowForces, at_rest) {
  run::RunReport report = reportOf(1e-9, 1e-18);
  report.gapRounding = 1e-16;
  EXPECT_EQ(feti::rowForceText(report), "");
}

} // namespace test_row_forces
