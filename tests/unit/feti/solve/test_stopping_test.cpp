// SPDX-License-Identifier: BSD-3-Clause

/// When a gradient is as small as it gets.

#include "Harmos_StoppingTest.hpp"
#include "Harmos_TestComm.hpp"

#include "Harmos_Qp.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

namespace test_stopping_test {

using namespace Harmos;
using namespace Harmos::feti;
using feti::Details::GradientTest;

namespace {

qp::Status statusOf(GradientTest& test, double gradient) {
  const auto map = Teuchos::rcp(new Map(3, 0, testComm()));
  MultiVector x(map, 1);
  x.putScalar(2.0);
  qp::IterationState<MultiVector> state;
  state.x = &x;
  state.projectedGradient = gradient;
  return test.checkStatus(state);
}

double largest(const MultiVector& x) {
  std::vector<double> result(1);
  x.normInf(Teuchos::arrayViewFromVector(result));
  return result[0];
}

} // namespace

TEST(GradientTest, asks_for_rounding_errors_where_the_rest_fails) {
  int asked = 0;
  GradientTest test(1e-2, 10.0, [&asked](const MultiVector& x) {
    ++asked;
    return 0.25 * largest(x); // 0.5
  });
  EXPECT_EQ(statusOf(test, 0.1), qp::Status::Passed);
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(test.rounding(), 0.0);
  EXPECT_EQ(statusOf(test, 0.6), qp::Status::Failed);
  EXPECT_EQ(statusOf(test, 0.4), qp::Status::Passed);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(test.rounding(), 0.5);
  EXPECT_EQ(test.limit(), 0.5);
  EXPECT_EQ(statusOf(test, 0.1), qp::Status::Passed); // by the tolerance again
  EXPECT_EQ(test.rounding(), 0.0);
  EXPECT_EQ(test.limit(), 0.1);
}

TEST(GradientTest, smaller_rounding_errors_change_nothing) {
  GradientTest test(1e-2, 10.0, [](const MultiVector&) { return 1e-3; });
  EXPECT_EQ(statusOf(test, 0.11), qp::Status::Failed);
  EXPECT_EQ(test.limit(), 0.1);
  GradientTest plain(1e-2, 10.0, nullptr);
  EXPECT_EQ(statusOf(plain, 0.11), qp::Status::Failed);
  EXPECT_EQ(statusOf(plain, 0.1), qp::Status::Passed);
}

} // namespace test_stopping_test
