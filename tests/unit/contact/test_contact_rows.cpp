// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_contact_rows {

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
    point.number = 7 + k;
    points.push_back(point);
  }
  return points;
}

ContactPoint pointWith(const fem::Point& normal) {
  ContactPoint point;
  point.node = 7;
  point.terms = {{7, 1.0}, {20, -1.0}};
  point.normal = normal;
  return point;
}

} // namespace

TEST(ContactRows, inequalities_are_along_the_normal) {
  const auto rows = contactRows(somePoints(), 3, 2.0);
  ASSERT_EQ(rows.size(), 5u);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const ConstraintRow& row = rows[r];
    const auto k = static_cast<long long>(r);
    EXPECT_EQ(row.number, 7 + k);
    EXPECT_EQ(row.rounding, 2e-12);
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
  for (const ConstraintRow& row : contactRows(somePoints(), 1, 1.0)) {
    ASSERT_EQ(row.terms.size(), 3u);
    EXPECT_EQ(row.terms[0].dof, row.number - 7);
    EXPECT_EQ(row.terms[0].coefficient, 1.0);
    EXPECT_EQ(row.terms[1].coefficient, -0.25);
    EXPECT_EQ(row.terms[2].coefficient, -0.75);
  }
}

TEST(ContactRows, ties_have_a_row_for_each_component) {
  const auto points = somePoints();
  for (long long k = 0; k < 5; ++k) {
    const ContactPoint& point = points[static_cast<std::size_t>(k)];
    EXPECT_EQ(tiedComponents(point, 2), (std::vector<int>{0, 1}));
    const int c = static_cast<int>(k % 2);
    const ConstraintRow row = tieRow(point, c, 2, 3 + k);
    EXPECT_EQ(row.number, 3 + k);
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Equality);
    EXPECT_EQ(row.bound, 0.0);
    ASSERT_EQ(row.terms.size(), 3u);
    EXPECT_EQ(row.terms[0].dof, 2 * k + c);
    EXPECT_EQ(row.terms[2].dof, 2 * (11 + k) + c);
    EXPECT_EQ(row.terms[2].coefficient, -0.75);
  }
}

// At an edge whose nodes 7, 20 and 21 are held, mortar coupling of second order beside nodes of another
// effect has terms of nodes further inside, of both signs: more than the weight one, but nothing in sum.
const std::vector<ContactPoint::Term> heldByWeightsOfBothSigns = {
    {7, 1.0}, {20, -0.4}, {21, -0.6}, {30, 0.4}, {31, -0.35}, {40, -0.3}, {41, 0.25}};

TEST(ContactRows, ties_leave_out_what_compares_prescribed_values) {
  ContactPoint point = pointWith({0.0, 0.0, 1.0});
  point.terms = heldByWeightsOfBothSigns;
  const auto y = [](long long node) { return 3 * node + 1; };
  EXPECT_EQ(tiedComponents(point, 3, {{y(7), 0.0}, {y(20), 0.0}, {y(21), 0.0}}), (std::vector<int>{0, 2}));
  EXPECT_EQ(tiedComponents(point, 3, {{y(20), 0.0}, {y(21), 0.0}}), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(tiedComponents(point, 3, {{y(7), 0.0}}), (std::vector<int>{0, 1, 2}))
      << "one side follows the other";
  // The middle of an edge with one end held.
  point.terms = {{7, 1.0}, {20, -0.5}, {21, -0.5}};
  EXPECT_EQ(tiedComponents(point, 3, {{y(7), 0.0}, {y(20), 0.0}}), (std::vector<int>{0, 2}));
  EXPECT_THROW(tiedComponents(point, 3, {{y(7), 0.0}, {y(20), 1.0}, {y(21), 0.0}}), InputError);
}

// Orthonormal to the normal and each other, whichever way that looks.
TEST(ContactRows, tangents) {
  for (const fem::Point& n :
       std::vector<fem::Point>{{1, 0, 0},
                               {0, -1, 0},
                               {0, 0, 1},
                               {0.6, 0, -0.8},
                               {1 / std::sqrt(3), 1 / std::sqrt(3), -1 / std::sqrt(3)}}) {
    const auto t = slipDirections(pointWith(n), 3, {});
    ASSERT_EQ(t.size(), 2u);
    const auto product = [](const fem::Point& a, const fem::Point& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    for (int k : {0, 1}) {
      EXPECT_NEAR(product(n, t[static_cast<std::size_t>(k)]), 0.0, 1e-15);
      EXPECT_NEAR(product(t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>(k)]), 1.0, 1e-15);
    }
    EXPECT_NEAR(product(t[0], t[1]), 0.0, 1e-15);
  }
  EXPECT_EQ(slipDirections(pointWith({0.6, 0.8, 0.0}), 2, {}), (std::vector<fem::Point>{{-0.8, 0.6, 0.0}}));
}

// At a plane of symmetry y = 0 there is one direction along it, and none where two such planes meet.
TEST(ContactRows, nothing_slips_across_a_plane_of_symmetry) {
  const fem::Point n = {0.6, 0.0, -0.8};
  ContactPoint point = pointWith(n);
  point.terms = {{7, 1.0}, {20, -0.3}, {21, -0.9}, {22, 0.2}};
  const auto y = [](long long node) { return 3 * node + 1; };
  using Held = std::map<double, HeldDofs>;
  const Held both = {{1.0, {{y(7), 0.0}, {y(20), 0.0}}}};
  const auto along = [&](const Held& held) { return slipDirections(point, 3, held); };
  EXPECT_EQ(along(both).size(), 2u) << "most of the weight of the counterparts is free";
  const Held most = {{1.0, {{y(7), 0.0}, {y(20), 0.0}, {y(21), 0.0}}}};
  ASSERT_EQ(along(most).size(), 1u);
  EXPECT_NEAR(std::abs(along(most)[0][0]), 0.8, 1e-15);
  EXPECT_EQ(along(most)[0][1], 0.0);
  EXPECT_NEAR(std::abs(along(most)[0][2]), 0.6, 1e-15);
  point.terms = heldByWeightsOfBothSigns;
  EXPECT_EQ(along(most).size(), 1u);
  point.terms = {{7, 1.0}, {20, -0.3}, {21, -0.9}, {22, 0.2}};
  // At all times, on both sides, by one value, and along the surface.
  Held later = most;
  later[2.0] = {{y(7), 0.1}, {y(20), 0.0}, {y(21), 0.0}};
  EXPECT_EQ(along(later).size(), 2u);
  later[2.0] = {{y(7), 0.1}, {y(20), 0.1}, {y(21), 0.1}};
  EXPECT_EQ(along(later).size(), 1u);
  EXPECT_EQ(along({{1.0, {{y(20), 0.0}, {y(21), 0.0}}}}).size(), 2u);
  EXPECT_EQ(along({{1.0, {{3 * 7, 0.0}, {3 * 20, 0.0}, {3 * 21, 0.0}}}}).size(), 2u) << "x is no tangent";
  // On an obstacle, which is at rest.
  point.terms = {{7, 1.0}};
  EXPECT_EQ(along({{1.0, {{y(7), 0.0}}}}).size(), 1u);
  EXPECT_EQ(along({{1.0, {{y(7), 0.1}}}}).size(), 2u);
  point.normal = {0.0, 0.0, -1.0};
  EXPECT_EQ(along({{1.0, {{y(7), 0.0}, {3 * 7, 0.0}}}}).size(), 0u);
  point.normal = {0.0, -1.0, 0.0};
  EXPECT_EQ(slipDirections(point, 2, {{1.0, {{2 * 7, 0.0}}}}).size(), 0u);
  EXPECT_EQ(slipDirections(point, 2, {{1.0, {{2 * 7 + 1, 0.0}}}}).size(), 1u);
}

// Of some points; in space the two rows of a point have one disc and stand together. What slips along one
// direction alone has a row without a disc.
TEST(ContactRows, slips_have_a_row_for_each_tangent) {
  const auto points = somePoints();
  std::vector<SlipPoint> slips;
  for (std::size_t k : {1u, 3u, 4u})
    slips.push_back({k, slipDirections(points[k], 3, {}), 10 + 2 * static_cast<long long>(slips.size()),
                     2 * slips.size(), 0.5 + static_cast<double>(k)});
  const auto rows = slipRows(points, slips, 3, 1.0);
  std::vector<long long> numbers;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const ConstraintRow& row = rows[r];
    numbers.push_back(row.number);
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Limited);
    const SlipPoint& slip = slips[r / 2];
    EXPECT_EQ(row.disc, slip.firstRow); // of both rows of a point, and of no other
    EXPECT_EQ(row.limit, slip.limit);
    EXPECT_EQ(row.bound, 0.0);
    // Σ weight · t·u is zero for a motion of all alike, and t·u of the first surface else.
    const fem::Point& t = slip.tangents[static_cast<std::size_t>(row.number % 2)];
    double together = 0.0, alone = 0.0;
    for (const ConstraintRow::Term& term : row.terms) {
      const double along = term.coefficient * t[static_cast<std::size_t>(term.dof % 3)];
      together += along;
      alone += term.dof / 3 < 10 ? along : 0.0;
    }
    EXPECT_NEAR(together, 0.0, 1e-15);
    EXPECT_NEAR(alone, 1.0, 1e-15);
  }
  EXPECT_EQ(numbers, (std::vector<long long>{10, 11, 12, 13, 14, 15}));
}

} // namespace test_contact_rows
