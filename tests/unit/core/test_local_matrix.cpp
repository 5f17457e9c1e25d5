// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <gtest/gtest.h>

using namespace Harmos;

TEST(LocalMatrix, sums_entries_at_equal_places_and_sorts_them) {
  const LocalMatrix a = makeLocalMatrix(3, {{2, 0, 5.0}, {0, 1, 1.0}, {0, 0, 2.0}, {0, 1, 3.0}});
  EXPECT_EQ(a.rows(), 3);
  ASSERT_EQ(a.entries(), 3u);
  const double x[] = {1.0, 10.0, 100.0};
  double y[3];
  a.multiply(x, y);
  EXPECT_EQ(y[0], 42.0);
  EXPECT_EQ(y[1], 0.0);
  EXPECT_EQ(y[2], 5.0);
  EXPECT_EQ(a.diagonal(), (std::vector<double>{2.0, 0.0, 0.0}));
  EXPECT_EQ(a.maxNorm(), 5.0);
  EXPECT_EQ(a.infinityNorm(), 6.0);
}

TEST(LocalMatrix, refuses_entries_outside) {
  EXPECT_THROW(makeLocalMatrix(2, {{0, 2, 1.0}}), InternalError);
  EXPECT_THROW(makeLocalMatrix(2, {{-1, 0, 1.0}}), InternalError);
}
