// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Exchange.hpp"

#include <gtest/gtest.h>

namespace test_mortar_space {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

constexpr long long upperFirst = 100000;

// Turned out of all planes of coordinates.
Point turned(const Point& x) {
  const Point y = rotated(x, 0.3);
  const Point z = rotated({y[1], y[2], 0.0}, 0.5);
  return {y[0], z[0], z[1]};
}

// Moves nodes in the planes z = const, but not those on the boundary of the unit square: no parallelograms.
Point distorted(const Point& x) {
  const double bump = x[0] * (1.0 - x[0]) * x[1] * (1.0 - x[1]);
  return turned({x[0] + 1.1 * bump, x[1] - 0.7 * bump, x[2]});
}

struct Pair {
  Surface lower, upper;
};

// A lower body with its top on the unit square at z = 0, an upper one whose bottom is a rectangle at z = gap.
Pair pairOf(CellType lowerType, CellType upperType, const Point& origin, const Point& size, double gap = 0.0,
            const Map& map = turned) {
  return {surfaceOf(block(lowerType, {0, 0, -1}, {1, 1, 1}, {2, 1, 1}, {2, 3, 1}, 0, map), "top"),
          surfaceOf(block(upperType, {origin[0], origin[1], gap}, {size[0], size[1], 1}, {1, 2, 1}, {3, 1, 1},
                          upperFirst, map == nullptr ? turned : Map(turned)),
                    "bottom")};
}

double one(const Point&) {
  return 1.0;
}
double slope(const Point& x) {
  return 1.0 + 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[2];
}

const std::vector<CellType> all = {CellType::Tetrahedron4, CellType::Tetrahedron10, CellType::Hexahedron8,
                                   CellType::Hexahedron27};
// Origin and size of the other surface: the same square; within; beyond; across a corner.
const std::vector<std::pair<Point, Point>> ranges = {{{0, 0, 0}, {1, 1, 0}},
                                                     {{0.17, 0.13, 0}, {0.67, 0.74, 0}},
                                                     {{-0.3, -0.2, 0}, {1.7, 1.6, 0}},
                                                     {{0.41, 0.37, 0}, {1, 1, 0}}};

} // namespace

// Far from the origin coordinates have rounding errors that are large beside facets: rows are the same but
// for these, and no row has terms of rounding alone.
TEST(MortarSpace, rows_far_from_the_origin_are_those_at_it) {
  constexpr double offset = 4096.0;
  const Map far = [](const Point& x) { return Point{x[0] + offset, x[1] - offset, x[2] + offset}; };
  const auto pointsOf = [](const Map& map) {
    return mortarPoints(
        surfaceOf(block(CellType::Hexahedron8, {0, 0, -1}, {1, 1, 1}, {1, 1, 1}, {6, 6, 1}, 0, map), "top"),
        surfaceOf(block(CellType::Tetrahedron4, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {6, 4, 1}, upperFirst, map),
                  "bottom"));
  };
  const auto near = pointsOf([](const Point&x) { return x; }), moved = pointsOf(far);
  ASSERT_EQ(near.size(), moved.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    EXPECT_EQ(near[i].node, moved[i].node);
    ASSERT_EQ(near[i].terms.size(), moved[i].terms.size()) << i;
    for (std::size_t k = 0; k < near[i].terms.size(); ++k) {
      EXPECT_EQ(near[i].terms[k].node, moved[i].terms[k].node);
      EXPECT_NEAR(near[i].terms[k].weight, moved[i].terms[k].weight, 1e2 * offset * rounding);
    }
  }
}

TEST(MortarSpace, rigid_and_linear_displacements_do_not_open_or_close) {
  for (CellType lower : all)
    for (CellType upper : all)
      for (const auto& [origin, size] : ranges) {
        const Pair pair = pairOf(lower, upper, origin, size);
        const auto points = mortarPoints(pair.lower, pair.upper);
        EXPECT_GE(points.size(), 8u);
        // Two directions of partial coverage: the condition is squared.
        EXPECT_LT(rowError(points, pair.lower, pair.upper, one), 10 * rounding);
        EXPECT_LT(rowError(points, pair.lower, pair.upper, slope), 10 * rounding);
        for (const ContactPoint& point : points) {
          EXPECT_GT(point.area, 0.0);
          EXPECT_NEAR(point.gap, 0.0, 10 * rounding);
        }
      }
}

TEST(MortarSpace, linear_displacements_are_exact_on_distorted_facets) {
  for (CellType lower : all) {
    const Pair pair = pairOf(lower, CellType::Hexahedron8, {0.41, 0.37, 0}, {1, 1, 0}, 0.0, distorted);
    const auto points = mortarPoints(pair.lower, pair.upper);
    const auto back = messageOf([&] {
      EXPECT_LT(rowError(mortarPoints(pair.upper, pair.lower), pair.lower, pair.upper, slope), 10 * rounding);
    });
    EXPECT_EQ(back, "");
    EXPECT_LT(rowError(points, pair.lower, pair.upper, slope), 10 * rounding);
  }
}

// Sides of facets of second order are taken as straight: what they cover is exact where they are.
TEST(MortarSpace, a_constant_pressure_has_the_same_resultant_on_both_sides) {
  for (CellType lower : all)
    for (CellType upper : all)
      for (const bool isDistorted : {false, true})
        for (const auto& [origin, size] : ranges) {
          const Pair pair =
              pairOf(lower, upper, origin, size, 0.0, isDistorted ? Map(distorted) : Map(turned));
          const auto points = mortarPoints(pair.lower, pair.upper);
          const Point low = {std::max(0.0, origin[0]), std::max(0.0, origin[1]), 0.0};
          const Point high = {std::min(1.0, origin[0] + size[0]), std::min(1.0, origin[1] + size[1]), 0.0};
          const double area = (high[0] - low[0]) * (high[1] - low[1]);
          const Point moment = scaled(area, turned(scaled(0.5, sum(low, high))));
          const Resultant own = resultantOf(points, pair.lower);
          const Resultant other = resultantOf(points, pair.upper);
          EXPECT_NEAR(own.force, -other.force, 10 * rounding);
          EXPECT_LT(norm(sum(own.moment, other.moment)), 10 * rounding);
          if (fem::shapeOf(lower).order == 2 && isDistorted)
            continue;
          EXPECT_NEAR(own.force, area, 10 * rounding);
          EXPECT_LT(norm(difference(own.moment, moment)), 10 * rounding);
        }
}

TEST(MortarSpace, matching_surfaces_are_coupled_one_to_one) {
  for (CellType type : all) {
    const auto a = block(type, {0, 0, 0}, {1, 1, 1}, {2, 1, 1}, {2, 3, 1}, 0, turned);
    const auto b = block(type, {0, 0, 1}, {1, 1, 1}, {1, 3, 1}, {4, 1, 1}, upperFirst, turned);
    const Surface first = surfaceOf(a, "top"), second = surfaceOf(b, "bottom");
    expectMatched(mortarPoints(first, second), matchNodes(first, second), first);
  }
}

TEST(MortarSpace, gap_is_the_distance_and_negative_for_penetration) {
  const Point up = difference(turned({0, 0, 1}), turned({0, 0, 0}));
  for (double gap : {0.05, -0.05})
    for (CellType lower : all) {
      const Pair pair = pairOf(lower, CellType::Tetrahedron4, {0.41, 0.37, 0}, {1, 1, 0}, gap);
      for (const ContactPoint& point : mortarPoints(pair.lower, pair.upper)) {
        EXPECT_NEAR(point.gap, gap, 10 * rounding);
        EXPECT_LT(norm(difference(point.normal, up)), rounding);
      }
    }
}

TEST(MortarSpace, a_steep_flank_is_no_counterpart) {
  // The bottom of the upper body rises at 87 degrees from x = 0.5 on, and would cover 0.03 more.
  const Map flank = [](const Point& x) {
    const double beyond = std::max(0.0, x[0] - 0.5);
    return Point{x[0] - 0.94 * beyond, x[1], x[2] + 1.2 * beyond};
  };
  const Surface lower =
      surfaceOf(block(CellType::Hexahedron8, {0, 0, -1}, {1, 1, 1}, {1, 1, 1}, {3, 2, 1}), "top");
  const Surface upper = surfaceOf(
      block(CellType::Hexahedron8, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {4, 3, 1}, upperFirst, flank), "bottom");
  EXPECT_NEAR(resultantOf(mortarPoints(lower, upper), lower).force, 0.5, 10 * rounding);
}

TEST(MortarSpace, slivers_of_coverage_give_no_wild_rows) {
  for (double sliver : {1e-3, 1e-5, 1e-8, 1e-12}) {
    // Facets of a quarter by a third; the third column is covered by a sliver.
    const Pair pair =
        pairOf(CellType::Hexahedron8, CellType::Hexahedron8, {-0.5, -0.5, 0}, {1.0 + sliver, 2, 0});
    const auto points = mortarPoints(pair.lower, pair.upper);
    double area = 0.0;
    for (const ContactPoint& point : points) {
      area += point.area;
      for (const ContactPoint::Term& term : point.terms)
        EXPECT_LT(std::abs(term.weight), 1e4);
    }
    EXPECT_EQ(points.size(), sliver > 1e-4 ? 16u : 12u);
    // What is left out weighs less than the sliver.
    EXPECT_NEAR(area, 0.5, 1.1 * sliver + rounding);
    EXPECT_LT(rowError(points, pair.lower, pair.upper, slope), 1e-10);
  }
}

TEST(MortarSpace, surfaces_that_never_meet_are_refused) {
  const Pair pair = pairOf(CellType::Hexahedron8, CellType::Hexahedron8, {0, 0, 0}, {1, 1, 0}, 0.2);
  EXPECT_NE(messageOf([&] { mortarPoints(pair.lower, pair.upper); }).find("within 1."), std::string::npos);
  EXPECT_EQ(mortarPoints(pair.lower, pair.upper, 0.25).size(), 20u);
  EXPECT_NE(messageOf([&] { mortarPoints(pair.lower, pair.lower); }).find("never meet"), std::string::npos);
}

namespace {

struct Gap {
  double error, area;
};

// Between a cylinder of radius 2 and a hollow one of 2.05, of n facets over an angle of 1.2 and 11 n / 8 over
// one of 1.6 around it: the places of facets to each other are the same for all n.
Gap cylinderGap(CellType type, int n) {
  const Map polar = [](const Point& x) { return Point{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), x[2]}; };
  const NormalField outward = [](const Point& x) { return Point{x[0], x[1], 0.0}; };
  const Surface inner =
      surfaceOf(block(type, {1, 0, 0}, {1, 1.2, 0.5}, {1, 1, 1}, {1, n, 2}, 0, polar), "right", outward);
  const Surface outer = surfaceOf(
      block(type, {2.05, -0.2, 0}, {1, 1.6, 0.5}, {1, 1, 1}, {1, 11 * n / 8, 3}, upperFirst, polar), "left");
  Gap gap{0.0, 0.0};
  for (const ContactPoint& point : mortarPoints(inner, outer)) {
    gap.error = std::max(gap.error, std::abs(point.gap - 0.05));
    gap.area += point.area;
  }
  return gap;
}

} // namespace

TEST(MortarSpace, gap_between_cylinders_converges) {
  for (CellType type : {CellType::Tetrahedron4, CellType::Hexahedron8}) {
    const Gap coarse = cylinderGap(type, 8), fine = cylinderGap(type, 32);
    // The sagitta of a chord of angle h is r h²/8, that of both surfaces together twice as much.
    EXPECT_LT(coarse.error, 2.0 * 2.0 * 0.15 * 0.15 / 8.0);
    EXPECT_GT(coarse.error / fine.error, 12.0) << coarse.error << " " << fine.error;
    // All is covered; chords are shorter than the arc by h²/24.
    EXPECT_NEAR(fine.area, 1.2 * (1.0 - 0.0375 * 0.0375 / 24.0), 1e-7);
  }
  for (int n : {8, 32}) {
    // Parabolas leave the circle by O(h⁴) only. What is left: facets are projected along one normal each,
    // which differs from the one at the node by h/2, so that the point met lies t = gap · h/2 aside, and
    // t²/2R below.
    const Gap gap = cylinderGap(CellType::Hexahedron27, n);
    const double aside = 0.05 * 0.5 * 1.2 / n;
    EXPECT_LT(gap.error, 1.1 * aside * aside / (2.0 * 2.05)) << n;
    EXPECT_NEAR(gap.area, 1.2, 1e-4 / n);
  }
}

namespace {

// Between patches of spheres of radius 2 and 2.05, over angles of 0.8, the outer one larger. Facets are
// warped.
Gap sphereGap(CellType type, int n) {
  const Map sphere = [](const Point& x) {
    return Point{x[2] * std::sin(x[0]) * std::cos(x[1]), x[2] * std::sin(x[1]),
                 x[2] * std::cos(x[0]) * std::cos(x[1])};
  };
  const NormalField outward = [](const Point& x) { return x; };
  const Surface inner =
      surfaceOf(block(type, {-0.4, -0.4, 1}, {0.8, 0.8, 1}, {1, 1, 1}, {n, n, 1}, 0, sphere), "top", outward);
  const int m = 11 * n / 8;
  const Surface outer = surfaceOf(
      block(type, {-0.5, -0.5, 2.05}, {1, 1, 1}, {1, 1, 1}, {m, m, 1}, upperFirst, sphere), "bottom");
  Gap gap{0.0, 0.0};
  const auto points = mortarPoints(inner, outer);
  EXPECT_EQ(points.size(), inner.numbers.size());
  EXPECT_LT(rowError(points, inner, outer, one), 10 * rounding);
  for (const ContactPoint& point : points) {
    gap.error = std::max(gap.error, std::abs(point.gap - 0.05));
    gap.area += point.area;
  }
  return gap;
}

} // namespace

TEST(MortarSpace, gap_between_spheres_converges) {
  const double area = 4.0 * 0.8 * 2.0 * std::sin(0.4);
  for (CellType type : all) {
    const Gap coarse = sphereGap(type, 8), fine = sphereGap(type, 32);
    // Sagittas in two directions, of both surfaces. O(h²) makes 16; the largest error has its whims.
    EXPECT_LT(coarse.error, 4.0 * 2.0 * 0.1 * 0.1 / 8.0);
    EXPECT_GT(coarse.error / fine.error, 10.0) << coarse.error << " " << fine.error;
    // For second order too: sides are taken as straight where the surface ends.
    EXPECT_GT(std::abs(coarse.area - area) / std::abs(fine.area - area), 12.0);
  }
}

TEST(MortarSpace, does_not_depend_on_the_decomposition_and_is_the_same_on_every_rank) {
  const auto make = [](CellType type, std::array<int, 3> subdomains, std::array<int, 3> elements) {
    const Map bend = [](const Point& x) { return Point{x[0], x[1], x[2] + 0.1 * x[0] * x[0]}; };
    return mortarPoints(surfaceOf(block(type, {0, 0, -1}, {1, 1, 1}, subdomains, elements, 0, bend), "top"),
                        surfaceOf(block(CellType::Tetrahedron10, {-0.4, -0.3, 0}, {1.3, 1.2, 1}, subdomains,
                                        elements, upperFirst, bend),
                                  "bottom"));
  };
  for (CellType type : all) {
    const auto whole = make(type, {1, 1, 1}, {6, 4, 2}), parts = make(type, {3, 2, 1}, {2, 2, 2});
    ASSERT_EQ(whole.size(), parts.size());
    for (std::size_t k = 0; k < whole.size(); ++k) {
      EXPECT_EQ(whole[k].node, parts[k].node);
      EXPECT_NEAR(whole[k].gap, parts[k].gap, 1e-10);
      EXPECT_NEAR(whole[k].area, parts[k].area, 1e-11);
      ASSERT_EQ(whole[k].terms.size(), parts[k].terms.size());
      for (std::size_t t = 0; t < whole[k].terms.size(); ++t) {
        EXPECT_EQ(whole[k].terms[t].node, parts[k].terms[t].node);
        EXPECT_NEAR(whole[k].terms[t].weight, parts[k].terms[t].weight, 1e-9);
      }
    }
  }
}

} // namespace test_mortar_space
