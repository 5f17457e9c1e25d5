// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"

#include <gtest/gtest.h>

#include <set>

namespace test_match_nodes {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

TEST(MatchNodes, opposite_nodes_are_paired_once) {
  const auto a = block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {2, 3, 1}, {2, 2, 1});
  const auto b = block(CellType::Triangle3, {1, 0, 0}, {1, 1, 0}, {1, 2, 1}, {3, 3, 1}, a.numberOfNodes());
  const Surface right = surfaceOf(a, "right"), left = surfaceOf(b, "left");
  EXPECT_TRUE(matchNodesIfAll(right, left));
  for (bool turned : {false, true}) {
    const auto points = turned ? matchNodes(left, right) : matchNodes(right, left);
    ASSERT_EQ(points.size(), 7u);
    double length = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      // Row by row: the right side of a has numbers 4, 9, 14, …, the left side of b 35, 39, 43, …
      ASSERT_EQ(points[k].terms.size(), 2u);
      EXPECT_EQ(points[k].terms[0].node, 4 + 5 * static_cast<long long>(k));
      EXPECT_EQ(points[k].terms[1].node, 35 + 4 * static_cast<long long>(k));
      EXPECT_EQ(points[k].terms[0].weight, turned ? -1.0 : 1.0);
      EXPECT_EQ(points[k].terms[1].weight, turned ? 1.0 : -1.0);
      EXPECT_EQ(points[k].node, points[k].terms[turned ? 1 : 0].node);
      EXPECT_LT(norm(difference(points[k].normal, {turned ? -1.0 : 1.0, 0, 0})), 1e-15);
      EXPECT_NEAR(points[k].gap, 0.0, 1e-15);
      EXPECT_NEAR(points[k].area, k == 0 || k == 6 ? 1.0 / 12 : 1.0 / 6, 1e-15);
      length += points[k].area;
    }
    EXPECT_NEAR(length, 1.0, 1e-14);
  }
}

TEST(MatchNodes, normals_of_both_surfaces_are_averaged) {
  const Map polar = [](const Point& x) { return Point{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), 0.0}; };
  const auto a = block(CellType::Quadrilateral4, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 4, 1}, 0, polar);
  const auto b = block(CellType::Quadrilateral4, {2, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 4, 1}, 100, polar);
  const NormalField radial = [](const Point& x) { return x; };
  const Surface outer = surfaceOf(a, "right", radial), inner = surfaceOf(b, "left");
  const auto points = matchNodes(outer, inner);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point sum = difference(outer.normals[k], inner.normals[k]);
    EXPECT_LT(norm(difference(points[k].normal, scaled(1.0 / norm(sum), sum))), 1e-14);
  }
}

TEST(MatchNodes, corners_of_triangles_of_six_nodes_have_an_area) {
  const auto a = block(CellType::Tetrahedron10, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {2, 2, 1});
  const auto b = block(CellType::Hexahedron27, {0, 0, 1}, {1, 1, 1}, {1, 1, 1}, {2, 2, 1}, a.numberOfNodes());
  const auto points = matchNodes(surfaceOf(a, "top"), surfaceOf(b, "bottom"));
  ASSERT_EQ(points.size(), 25u);
  double area = 0.0;
  for (const ContactPoint& point : points) {
    EXPECT_GT(point.area, 0.01); // a third of one of the 32 pieces of the square
    area += point.area;
  }
  EXPECT_NEAR(area, 1.0, 1e-14);
}

TEST(MatchNodes, far_from_the_origin_positions_need_not_agree_to_the_bit) {
  const auto a = block(CellType::Quadrilateral4, {1e6, 1.0 / 3, 0}, {1, 0.7, 0}, {1, 1, 1}, {1, 7, 1});
  const auto b =
      block(CellType::Quadrilateral4, {1e6 + 1 + 1e-9, 1.0 / 3, 0}, {1, 0.7, 0}, {1, 7, 1}, {1, 1, 1}, 100);
  EXPECT_TRUE(matchNodesIfAll(surfaceOf(a, "right"), surfaceOf(b, "left")));
}

TEST(MatchNodes, two_nodes_at_a_place_have_two_partners) {
  // Two bodies side by side that are not joined, against two others.
  const auto row = [](double y, long long firstNode) {
    auto meshes =
        share(block(CellType::Quadrilateral4, {0, y, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1}, firstNode));
    for (const fem::PlacedMesh& mesh :
         share(block(CellType::Quadrilateral4, {1, y, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1}, firstNode + 10)))
      meshes.push_back(mesh);
    return meshes;
  };
  const auto points = matchNodes(gather(row(0, 0), "top", "lower"), gather(row(1, 100), "bottom", "upper"));
  std::set<long long> partners;
  for (const ContactPoint& point : points)
    partners.insert(point.terms[1].node);
  EXPECT_EQ(partners, (std::set<long long>{100, 101, 110, 111}));
}

TEST(MatchNodes, surfaces_that_do_not_match_are_refused) {
  const auto text = [](const fem::StructuredBlock& a, const fem::StructuredBlock& b, const std::string& set) {
    const Surface first = surfaceOf(a, "right"), second = surfaceOf(b, set);
    const std::string message = messageOf([&] { matchNodes(first, second); });
    EXPECT_FALSE(message.empty());
    return message;
  };
  const auto a = block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1});
  const auto coarse = block(CellType::Quadrilateral4, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1}, 100);
  const auto fine = block(CellType::Quadrilateral4, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {4, 4, 1}, 100);
  const auto apart = block(CellType::Quadrilateral4, {1.001, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1}, 100);
  EXPECT_NE(text(a, coarse, "left")
                .find("body/right and body/left: the surfaces do not match: node 5 at (1.000000, 0.500000, "
                      "0.000000) of the first surface has no partner on the second one"),
            std::string::npos)
      << text(a, coarse, "left");
  EXPECT_NE(text(a, fine, "left").find("of the second surface has no partner"), std::string::npos);
  EXPECT_NE(text(a, apart, "left").find("of the first surface has no partner"), std::string::npos);
  EXPECT_NE(text(a, a, "right").find("both surfaces point the same way"), std::string::npos);
  for (const fem::StructuredBlock* other : {&coarse, &fine, &apart})
    EXPECT_FALSE(matchNodesIfAll(surfaceOf(a, "right"), surfaceOf(*other, "left")));
}

} // namespace test_match_nodes
