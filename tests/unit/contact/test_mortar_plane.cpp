// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_MortarSamples.hpp"

#include <gtest/gtest.h>

namespace test_mortar_plane {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

constexpr long long upperFirst = 10000;

// A lower body with its top at y = 0 over [0, 3], an upper one with its bottom at y = gap over [begin, end],
// both turned about the origin.
struct Pair {
  Surface lower, upper;
};
Pair pairOf(CellType lowerType, int lowerElements, CellType upperType, int upperElements, double begin,
            double end, double gap = 0.0, double angle = 0.4) {
  const Map turn = [angle](const Point& x) { return rotated(x, angle); };
  return {
      surfaceOf(block(lowerType, {0, -1, 0}, {3, 1, 0}, {2, 1, 1}, {lowerElements, 2, 1}, 0, turn), "top"),
      surfaceOf(block(upperType, {begin, gap, 0}, {end - begin, 1, 0}, {3, 1, 1}, {upperElements, 2, 1},
                      upperFirst, turn),
                "bottom")};
}

const std::vector<CellType> plane = {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4,
                                     CellType::Quadrilateral9};

double one(const Point&) {
  return 1.0;
}
double slope(const Point& x) {
  return 1.0 + 2.0 * x[0] - 3.0 * x[1];
}

} // namespace

TEST(MortarPlane, rigid_and_linear_displacements_do_not_open_or_close) {
  // Aligned ends; the upper surface within the lower one; beyond both of its ends; across one of them.
  const std::vector<std::pair<double, double>> ranges = {{0, 3}, {0.37, 2.21}, {-0.4, 3.7}, {1.13, 4.2}};
  for (CellType lower : plane)
    for (CellType upper : plane)
      for (const auto& [begin, end] : ranges) {
        const Pair pair = pairOf(lower, 3, upper, 3, begin, end);
        const std::vector<std::pair<const Surface*, const Surface*>> both = {{&pair.lower, &pair.upper},
                                                                             {&pair.upper, &pair.lower}};
        for (const auto& [first, second] : both) {
          const auto points = mortarPoints(*first, *second);
          EXPECT_GE(points.size(), 4u);
          EXPECT_LT(rowError(points, *first, *second, one), rounding);
          EXPECT_LT(rowError(points, *first, *second, slope), rounding);
          for (const ContactPoint& point : points) {
            EXPECT_GT(point.area, 0.0);
            EXPECT_NEAR(point.gap, 0.0, rounding);
            EXPECT_TRUE(std::is_sorted(point.terms.begin(), point.terms.end(),
                                       [](const auto& a, const auto& b) { return a.node < b.node; }));
          }
        }
      }
}

TEST(MortarPlane, a_constant_pressure_has_the_same_resultant_on_both_sides) {
  for (CellType lower : plane)
    for (CellType upper : plane)
      for (const auto& [begin, end] : {std::make_pair(0.31, 2.21), std::make_pair(1.13, 4.2)}) {
        const Pair pair = pairOf(lower, 4, upper, 3, begin, end);
        const auto points = mortarPoints(pair.lower, pair.upper);
        const double length = std::min(end, 3.0) - begin;
        const Resultant own = resultantOf(points, pair.lower);
        const Resultant other = resultantOf(points, pair.upper);
        // ∫ x over the common part, whose middle is known.
        const Point moment = scaled(length, rotated({0.5 * (begin + std::min(end, 3.0)), 0, 0}, 0.4));
        EXPECT_NEAR(own.force, length, rounding);
        EXPECT_NEAR(other.force, -length, rounding);
        EXPECT_LT(norm(difference(own.moment, moment)), 10 * rounding);
        EXPECT_LT(norm(sum(other.moment, moment)), 10 * rounding);
      }
}

TEST(MortarPlane, matching_surfaces_are_coupled_one_to_one) {
  for (CellType type : plane) {
    const Pair pair = pairOf(type, 3, type, 2, 0.0, 3.0);
    expectMatched(mortarPoints(pair.lower, pair.upper), matchNodes(pair.lower, pair.upper), pair.lower);
  }
}

TEST(MortarPlane, gap_is_the_distance_and_negative_for_penetration) {
  for (double gap : {0.05, -0.05})
    for (CellType lower : plane)
      for (const ContactPoint& point :
           mortarPoints(pairOf(lower, 2, CellType::Quadrilateral4, 3, 0.2, 2.9, gap).lower,
                        pairOf(lower, 2, CellType::Quadrilateral4, 3, 0.2, 2.9, gap).upper)) {
        EXPECT_NEAR(point.gap, gap, rounding);
        EXPECT_LT(norm(difference(point.normal, rotated({0, 1, 0}, 0.4))), rounding);
      }
}

TEST(MortarPlane, a_wedge_has_its_gap_at_the_nodes) {
  // The upper surface y = 0.05 x: the projection of the gap, linear in x, on the dual functions is its value.
  const Map lift = [](const Point& x) { return Point{x[0], x[1] + 0.05 * x[0], 0.0}; };
  const Surface lower =
      surfaceOf(block(CellType::Quadrilateral4, {0, -1, 0}, {3, 1, 0}, {1, 1, 1}, {5, 1, 1}), "top");
  const Surface upper = surfaceOf(
      block(CellType::Quadrilateral4, {-0.5, 0, 0}, {4, 1, 0}, {1, 1, 1}, {3, 1, 1}, upperFirst, lift),
      "bottom");
  const auto points = mortarPoints(lower, upper);
  ASSERT_EQ(points.size(), 6u);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(points[i].gap, 0.05 * lower.positions[i][0], rounding);
}

TEST(MortarPlane, nodes_without_a_counterpart_give_no_point) {
  // Facets of length 1/2; the first three are covered, the third by less and less.
  for (double covered : {0.5, 0.1, 1e-3, 1e-5, 1e-7}) {
    const Pair pair = pairOf(CellType::Quadrilateral4, 3, CellType::Quadrilateral4, 3, -1.0, 1.0 + covered);
    const auto points = mortarPoints(pair.lower, pair.upper);
    double area = 0.0;
    for (const ContactPoint& point : points) {
      area += point.area;
      for (const ContactPoint::Term& term : point.terms)
        EXPECT_LT(std::abs(term.weight), 1e4);
    }
    // The area of the far node is h/2 t² at a coverage of t h, its weights grow as 1/t: below 1e-4 it is
    // left out, and an area of 1e-8 h at most with it.
    EXPECT_EQ(points.size(), covered < 1e-4 ? 3u : 4u);
    EXPECT_NEAR(area, 1.0 + covered, 1e-8);
    // Its weights are as large as 2e3 for 1e-3, its rounding by that times the condition.
    EXPECT_LT(rowError(points, pair.lower, pair.upper, slope), 1e-11);
  }
}

TEST(MortarPlane, every_area_is_positive_on_facets_of_second_order) {
  // ∫φ of the far node of a parabola is negative where less than three quarters of the facet are covered;
  // that of Bernstein's polynomial is not.
  for (double covered : {0.05, 0.3, 0.45}) {
    const Pair pair = pairOf(CellType::Quadrilateral9, 3, CellType::Quadrilateral4, 3, -1.0, 1.0 + covered);
    const auto points = mortarPoints(pair.lower, pair.upper);
    EXPECT_EQ(points.size(), 7u); // on three facets
    for (const ContactPoint& point : points)
      EXPECT_GT(point.area, 0.0);
    EXPECT_NEAR(resultantOf(points, pair.lower).force, 1.0 + covered, rounding);
    EXPECT_LT(rowError(points, pair.lower, pair.upper, slope), 1e-10);
  }
}

TEST(MortarPlane, a_touch_of_rounding_width_gives_no_point) {
  // The last node's area is that of the overlap; half a facet has 1/4.
  const auto touching = [](double width) {
    return pairOf(CellType::Quadrilateral4, 3, CellType::Quadrilateral4, 3, 3.0 - width, 6.0, 0.0, 0.0);
  };
  const Pair thin = touching(1e-6), rounding = touching(1e-9);
  const auto points = mortarPoints(thin.lower, thin.upper);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].node, thin.lower.numbers.back());
  EXPECT_NEAR(points[0].area, 1e-6, 2e-12);
  EXPECT_NE(messageOf([&] { mortarPoints(rounding.lower, rounding.upper); }).find("never meet"),
            std::string::npos);
}

TEST(MortarPlane, only_surfaces_that_face_each_other_within_reach_count) {
  const Pair pair = pairOf(CellType::Quadrilateral4, 3, CellType::Quadrilateral4, 3, 0.0, 3.0, 0.5, 0.0);
  // A tenth of the extent of 3 is 0.3.
  const std::string far = messageOf([&] { mortarPoints(pair.lower, pair.upper); });
  EXPECT_NE(far.find("body/top and body/bottom: the surfaces never meet: no facet of the first faces a facet "
                     "of the second within 3.00e-01"),
            std::string::npos)
      << far;
  EXPECT_EQ(mortarPoints(pair.lower, pair.upper, 0.6).size(), 7u);
  const Pair turned = pairOf(CellType::Quadrilateral4, 3, CellType::Quadrilateral4, 3, 0.0, 3.0, 0.31, 0.7);
  EXPECT_NE(messageOf([&] { mortarPoints(turned.lower, turned.upper, 0.3); }).find("never meet"),
            std::string::npos);
  EXPECT_EQ(mortarPoints(turned.lower, turned.upper, 0.32).size(), 7u);
  // The top of the upper body is as near as its bottom, but looks the other way.
  const Surface away = surfaceOf(
      block(CellType::Quadrilateral4, {0, -0.9, 0}, {3, 1, 0}, {1, 1, 1}, {3, 1, 1}, upperFirst), "top");
  EXPECT_NE(messageOf([&] { mortarPoints(pair.lower, away); }).find("never meet"), std::string::npos);
  EXPECT_NE(messageOf([&] { mortarPoints(pair.lower, pair.upper, -1.0); }).find("invalid reach -1"),
            std::string::npos);
  const Surface space =
      surfaceOf(block(CellType::Hexahedron8, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}), "bottom");
  EXPECT_NE(messageOf([&] { mortarPoints(pair.lower, space); }).find("in the plane and the other in space"),
            std::string::npos);
}

TEST(MortarPlane, of_surfaces_behind_each_other_the_nearest_counts) {
  // A second layer 0.2 above the bottom of the first, named with it.
  const auto lower = block(CellType::Quadrilateral4, {0, -1, 0}, {3, 1, 0}, {1, 1, 1}, {4, 1, 1});
  const auto near = block(CellType::Quadrilateral4, {0, 0.01, 0}, {3, 0.1, 0}, {1, 1, 1}, {3, 1, 1}, 100);
  const auto behind = block(CellType::Quadrilateral4, {0, 0.2, 0}, {3, 1, 0}, {1, 1, 1}, {5, 1, 1}, 200);
  auto meshes = share(near);
  for (const fem::PlacedMesh& mesh : share(behind))
    meshes.push_back(mesh);
  const Surface top = surfaceOf(lower, "top");
  const auto points = mortarPoints(top, gather(meshes, "bottom", "layers"));
  double length = 0.0;
  for (const ContactPoint& point : points) {
    EXPECT_NEAR(point.gap, 0.01, rounding);
    length += point.area;
  }
  EXPECT_NEAR(length, 3.0, rounding);
}

namespace {

// Largest error of the gap between arcs of radius 2 and 2.05, of n and n + 3 facets, over an angle of 1.2.
double arcGapError(CellType type, int n, bool outerFirst = false) {
  const Map polar = [](const Point& x) { return Point{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), 0.0}; };
  const NormalField outward = [](const Point& x) { return x; };
  const NormalField inward = [](const Point& x) { return scaled(-1.0, x); };
  const Surface inner =
      surfaceOf(block(type, {1, 0, 0}, {1, 1.2, 0}, {1, 1, 1}, {1, n, 1}, 0, polar), "right", outward);
  const Surface outer = surfaceOf(
      block(type, {2.05, 0, 0}, {1, 1.2, 0}, {1, 1, 1}, {1, n + 3, 1}, upperFirst, polar), "left", inward);
  const Surface& first = outerFirst ? outer : inner;
  const auto points = mortarPoints(first, outerFirst ? inner : outer);
  EXPECT_EQ(points.size(), first.numbers.size());
  double error = 0.0, length = 0.0, whole = 0.0;
  for (const ContactPoint& point : points) {
    error = std::max(error, std::abs(point.gap - 0.05));
    length += point.area;
  }
  for (double area : first.areas)
    whole += area;
  // The arcs end on the same rays: everything is covered, up to the rounding of a root.
  EXPECT_NEAR(length, whole, 1e-11);
  return error;
}

} // namespace

TEST(MortarPlane, gap_between_arcs_converges) {
  // Sagittas of chords are h²/8r; parabolas leave the arc by O(h⁴) at most.
  EXPECT_LT(arcGapError(CellType::Quadrilateral4, 8), 0.15 * 0.15 * 2.0);
  EXPECT_GT(arcGapError(CellType::Quadrilateral4, 8) / arcGapError(CellType::Quadrilateral4, 32), 10.0);
  EXPECT_GT(arcGapError(CellType::Quadrilateral9, 8) / arcGapError(CellType::Quadrilateral9, 32), 64.0);
  EXPECT_LT(arcGapError(CellType::Quadrilateral9, 32), 1e-6);
  EXPECT_GT(arcGapError(CellType::Quadrilateral4, 8, true) / arcGapError(CellType::Quadrilateral4, 32, true),
            10.0);
  EXPECT_GT(arcGapError(CellType::Quadrilateral9, 8, true) / arcGapError(CellType::Quadrilateral9, 32, true),
            64.0);
}

TEST(MortarPlane, rays_follow_the_interpolated_normals) {
  // One facet of angle 1.2 about the x axis, its normals radial: so are those between, and their rays reach
  // parts of the arc behind it that lie aside of the facet.
  const Map polar = [](const Point& x) { return Point{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), 0.0}; };
  const NormalField outward = [](const Point& x) { return x; };
  const Surface inner =
      surfaceOf(block(CellType::Quadrilateral4, {1, -0.6, 0}, {1, 1.2, 0}, {1, 1, 1}, {1, 1, 1}, 0, polar),
                "right", outward);
  const Surface outer = surfaceOf(
      block(CellType::Quadrilateral4, {3, -1, 0}, {1, 2, 0}, {1, 1, 1}, {1, 40, 1}, upperFirst, polar),
      "left");
  double length = 0.0, gap = 0.0;
  for (const ContactPoint& point : mortarPoints(inner, outer, 1.5)) {
    length += point.area;
    gap += point.area * point.gap;
  }
  EXPECT_NEAR(length, 4.0 * std::sin(0.6), 1e-11);
  // ∫ 3 − |x| along the chord x = (c, s), −e < s < e; the sagitta of the outer facets is 1e-3.
  const double c = 2.0 * std::cos(0.6), e = 2.0 * std::sin(0.6);
  EXPECT_NEAR(gap, 6.0 * e - (2.0 * e + c * c * std::asinh(e / c)), 1e-3 * length);
}

TEST(MortarPlane, a_ring_is_not_met_through_its_hole) {
  // The rest of the hole looks at the back of the disk, from beyond the centre where the normals meet.
  const Map polar = [](const Point& x) { return Point{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), 0.0}; };
  const Surface disk = surfaceOf(
      block(CellType::Quadrilateral4, {0.5, -0.5, 0}, {0.5, 1, 0}, {1, 1, 1}, {1, 4, 1}, 0, polar), "right");
  const auto hole = [&](double from, double to) {
    return surfaceOf(block(CellType::Quadrilateral4, {1.2, from, 0}, {1, to - from, 0}, {1, 1, 1}, {1, 3, 1},
                           upperFirst, polar),
                     "left");
  };
  EXPECT_EQ(mortarPoints(disk, hole(-0.5, 0.5), 3.0).size(), 5u);
  for (double angle : {1.7, 2.2, 2.7}) {
    const Surface far = hole(angle, 6.2831853071795865 - angle);
    EXPECT_NE(messageOf([&] { mortarPoints(disk, far, 5.0); }).find("never meet"), std::string::npos)
        << angle;
  }
}

TEST(MortarPlane, a_facet_beyond_the_crossing_of_the_normals_is_no_counterpart) {
  // The normals of the first facet meet at the origin. Behind it the order of the projections says nothing:
  // that of these two nodes is the right one, but their facet looks the same way.
  Surface first, second;
  first.dimension = second.dimension = 2;
  first.facetType = second.facetType = CellType::Line2;
  first.facets = second.facets = {0, 1};
  first.positions = {{1, -0.5, 0}, {1, 0.5, 0}};
  for (const Point& x : first.positions)
    first.normals.push_back(scaled(1.0 / norm(x), x));
  second.positions = {{-1, 1, 0}, {-3, 1.5, 0}};
  EXPECT_TRUE(planeSamples(first, 0, second, {0}, 10.0).empty());
  second.positions = {{2, 2, 0}, {2, -2, 0}};
  EXPECT_FALSE(planeSamples(first, 0, second, {0}, 10.0).empty());
}

TEST(MortarPlane, does_not_depend_on_the_decomposition_and_is_the_same_on_every_rank) {
  const auto make = [](std::array<int, 3> subdomains, std::array<int, 3> elements) {
    const Map bend = [](const Point& x) { return Point{x[0], x[1] + 0.1 * x[0] * x[0], 0.0}; };
    return mortarPoints(
        surfaceOf(block(CellType::Triangle6, {0, -1, 0}, {3, 1, 0}, subdomains, elements, 0, bend), "top"),
        surfaceOf(
            block(CellType::Quadrilateral4, {-1, 0, 0}, {3.3, 1, 0}, subdomains, elements, upperFirst, bend),
            "bottom"));
  };
  const auto whole = make({1, 1, 1}, {12, 2, 1}), parts = make({4, 2, 1}, {3, 1, 1});
  ASSERT_EQ(whole.size(), parts.size());
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(whole[k].node, parts[k].node);
    EXPECT_NEAR(whole[k].gap, parts[k].gap, 1e-11);
    EXPECT_NEAR(whole[k].area, parts[k].area, 1e-12);
    ASSERT_EQ(whole[k].terms.size(), parts[k].terms.size());
    for (std::size_t t = 0; t < whole[k].terms.size(); ++t) {
      EXPECT_EQ(whole[k].terms[t].node, parts[k].terms[t].node);
      EXPECT_NEAR(whole[k].terms[t].weight, parts[k].terms[t].weight, 1e-10);
    }
  }
}

} // namespace test_mortar_plane
