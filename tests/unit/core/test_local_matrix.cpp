// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <gtest/gtest.h>

namespace test_local_matrix {

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

TEST(LocalMatrix, sum_has_the_entries_of_both) {
  const LocalMatrix a = makeLocalMatrix(3, {{0, 0, 1.0}, {0, 2, 2.0}, {2, 2, 3.0}});
  const LocalMatrix b = makeLocalMatrix(3, {{0, 1, 10.0}, {0, 2, 20.0}, {1, 0, 30.0}, {2, 0, 40.0}});
  const LocalMatrix both = sum(a, b);
  const LocalMatrix expected =
      makeLocalMatrix(3, {{0, 0, 1.0}, {0, 1, 10.0}, {0, 2, 22.0}, {1, 0, 30.0}, {2, 0, 40.0}, {2, 2, 3.0}});
  EXPECT_EQ(both.offsets, expected.offsets);
  EXPECT_EQ(both.columns, expected.columns);
  EXPECT_EQ(both.values, expected.values);
  EXPECT_THROW(sum(a, makeLocalMatrix(2, {})), InternalError);
}

TEST(LocalMatrix, refuses_entries_outside) {
  EXPECT_THROW(makeLocalMatrix(2, {{0, 2, 1.0}}), InternalError);
  EXPECT_THROW(makeLocalMatrix(2, {{-1, 0, 1.0}}), InternalError);
}

// Soft parts are compared as sharply as stiff ones: 5e-4 of a part 1e9 times softer is a difference.
TEST(LocalMatrix, same_content_is_relative_to_each_entry) {
  const LocalMatrix a = makeLocalMatrix(2, {{0, 0, 1e9}, {0, 1, -1.0}, {1, 0, -1.0}, {1, 1, 1.0}});
  LocalMatrix b = a;
  EXPECT_TRUE(sameContent(a, b, 1e-12));
  b.values[0] *= 1.0 + 1e-14;
  b.values[3] *= 1.0 + 1e-14;
  EXPECT_TRUE(sameContent(a, b, 1e-12));
  b.values[3] *= 1.0005;
  EXPECT_FALSE(sameContent(a, b, 1e-12));
  EXPECT_FALSE(sameContent(a, makeLocalMatrix(2, {{0, 0, 1e9}, {1, 1, 1.0}}), 1e-12));
  EXPECT_EQ(patternHash(a), patternHash(b));
}

} // namespace test_local_matrix
