// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Exchange.hpp"

#include <gtest/gtest.h>

using namespace Harmos;
using namespace Harmos::contact;

namespace {

std::vector<ContactPoint> somePoints() {
  std::vector<ContactPoint> points;
  for (long long k = 0; k < 5; ++k) {
    ContactPoint point;
    point.node = k;
    point.terms = {{k, 1.0}, {10 + k, -0.25}, {11 + k, -0.75}};
    point.normal = {0.6, 0.0, -0.8};
    point.gap = 0.1 * static_cast<double>(k);
    points.push_back(point);
  }
  return points;
}

void expectNumbered(const std::vector<ConstraintRow>& rows, long long first, long long count) {
  const auto comm = testComm();
  std::vector<long long> numbers;
  for (const ConstraintRow& row : rows) {
    EXPECT_EQ((row.number - first) % comm->getSize(), comm->getRank());
    numbers.push_back(row.number);
  }
  numbers = gatherAll(*comm, numbers);
  std::sort(numbers.begin(), numbers.end());
  ASSERT_EQ(static_cast<long long>(numbers.size()), count);
  for (long long k = 0; k < count; ++k)
    EXPECT_EQ(numbers[static_cast<std::size_t>(k)], first + k);
}

} // namespace

TEST(ContactRows, inequalities_are_along_the_normal) {
  const auto rows = contactRows(*testComm(), somePoints(), 3, 7);
  expectNumbered(rows, 7, 5);
  for (const ConstraintRow& row : rows) {
    const long long k = row.number - 7;
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Inequality);
    EXPECT_EQ(row.bound, 0.1 * static_cast<double>(k));
    // Components of the normal that are zero give no term.
    const std::vector<ConstraintRow::Term> expected = {{3 * k, 0.6},          {3 * k + 2, -0.8},
                                                       {3 * (10 + k), -0.15}, {3 * (10 + k) + 2, 0.2},
                                                       {3 * (11 + k), -0.45}, {3 * (11 + k) + 2, 0.6}};
    ASSERT_EQ(row.terms.size(), expected.size());
    for (std::size_t t = 0; t < expected.size(); ++t) {
      EXPECT_EQ(row.terms[t].dof, expected[t].dof);
      EXPECT_NEAR(row.terms[t].coefficient, expected[t].coefficient, 2e-16);
    }
  }
}

TEST(ContactRows, scalar_rows_know_no_normal) {
  for (const ConstraintRow& row : contactRows(*testComm(), somePoints(), 1, 0)) {
    ASSERT_EQ(row.terms.size(), 3u);
    EXPECT_EQ(row.terms[0].dof, row.number);
    EXPECT_EQ(row.terms[0].coefficient, 1.0);
    EXPECT_EQ(row.terms[1].coefficient, -0.25);
    EXPECT_EQ(row.terms[2].coefficient, -0.75);
  }
}

TEST(ContactRows, ties_have_a_row_for_each_component) {
  const auto rows = tieRows(*testComm(), somePoints(), 2, 3).rows;
  expectNumbered(rows, 3, 10);
  for (const ConstraintRow& row : rows) {
    const long long k = (row.number - 3) / 2, c = (row.number - 3) % 2;
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Equality);
    EXPECT_EQ(row.bound, 0.0);
    ASSERT_EQ(row.terms.size(), 3u);
    EXPECT_EQ(row.terms[0].dof, 2 * k + c);
    EXPECT_EQ(row.terms[2].dof, 2 * (11 + k) + c);
    EXPECT_EQ(row.terms[2].coefficient, -0.75);
  }
}
