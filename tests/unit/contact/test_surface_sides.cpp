// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces with sharp edges: each smooth side has its own normals, areas and points; sides that meet nothing
/// do not turn the normals of those that do.

#include "Harmos_ContactTestSupport.hpp"

#include <gtest/gtest.h>

namespace test_surface_sides {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

// All outer sides of a block as one part.
Surface skinOf(const fem::StructuredBlock& body, int rank = 0, int ranks = 1,
               const Teuchos::Comm<int>& comm = aloneComm()) {
  std::vector<fem::PlacedMesh> meshes = share(body, rank, ranks);
  for (fem::PlacedMesh& mesh : meshes) {
    std::vector<fem::Side>& skin = mesh.sides["skin"];
    for (const char* name : {"left", "right", "bottom", "top", "front", "back"})
      if (const auto found = mesh.sides.find(name); found != mesh.sides.end())
        skin.insert(skin.end(), found->second.begin(), found->second.end());
  }
  return gather(meshes, "skin", "body/skin", nullptr, comm);
}

const std::vector<CellType> allTypes = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20};

bool isSpace(CellType type) {
  return fem::shapeOf(type).dimension == 3;
}

} // namespace

TEST(SurfaceSides, a_block_has_as_many_as_it_has_faces) {
  for (CellType type : allTypes) {
    const fem::StructuredBlock body = block(type, {0, 0, 0}, {1, 1, 1}, {2, 1, 1}, {1, 2, 2});
    const Surface skin = skinOf(body), sides = splitAtEdges(skin);
    std::map<long long, int> copies;
    for (std::size_t i = 0; i < sides.numbers.size(); ++i) {
      ++copies[sides.numbers[i]];
      // One component alone, and its size one: outward of a face.
      const Point& x = sides.positions[i];
      for (std::size_t d = 0; d < 3; ++d)
        if (std::abs(sides.normals[i][d]) > 0.5) {
          EXPECT_NEAR(std::abs(sides.normals[i][d]), 1.0, 1e-15);
          EXPECT_NEAR(x[d], sides.normals[i][d] > 0.0 ? 1.0 : 0.0, 1e-15);
        }
    }
    double area = 0.0;
    for (double a : sides.areas)
      area += a;
    EXPECT_NEAR(area, isSpace(type) ? 6.0 : 4.0, 1e-13) << fem::shapeOf(type).name;
    for (std::size_t i = 0; i < skin.numbers.size(); ++i) {
      int faces = 0;
      for (std::size_t d = 0; d < (isSpace(type) ? 3u : 2u); ++d)
        faces += std::abs(skin.positions[i][d] - 0.5) > 0.499 ? 1 : 0;
      EXPECT_EQ(copies.at(skin.numbers[i]), faces) << fem::shapeOf(type).name;
    }
  }
}

// A smooth surface is left as it is, to the last bit.
TEST(SurfaceSides, round_surfaces_have_one) {
  const Map bend = [](const Point& x) { return Point{x[0], x[1] + 0.2 * x[0] * x[0], x[2]}; };
  const Surface round =
      surfaceOf(block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {3, 2, 1}, 0, bend), "top");
  EXPECT_TRUE(round.sideNormals.empty());
  EXPECT_EQ(splitAtEdges(round).normals, round.normals);
}

// Of a skin above a body, the points of mortar coupling, of matching nodes and of an obstacle are those of
// the face that meets it.
TEST(SurfaceSides, a_skin_touches_like_the_face) {
  for (CellType type : allTypes) {
    const Point above = isSpace(type) ? Point{0, 0, 1} : Point{0, 1, 0};
    const fem::StructuredBlock lower = block(type, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {3, 3, 2});
    const fem::StructuredBlock upper =
        block(type, above, {1, 1, 1}, {1, 1, 1}, {2, 2, 2}, lower.numberOfNodes());
    const Surface top = surfaceOf(lower, "top"), bottom = surfaceOf(upper, "bottom");
    for (const auto& [skin, face] :
         {std::pair{mortarPoints(skinOf(upper), top), mortarPoints(bottom, top)},
          std::pair{mortarPoints(top, skinOf(upper)), mortarPoints(top, bottom)}}) {
      ASSERT_EQ(skin.size(), face.size()) << fem::shapeOf(type).name;
      for (std::size_t k = 0; k < skin.size(); ++k) {
        EXPECT_EQ(skin[k].node, face[k].node);
        EXPECT_LT(norm(difference(skin[k].normal, face[k].normal)), 1e-15);
        EXPECT_NEAR(skin[k].area, face[k].area, rounding);
        ASSERT_EQ(skin[k].terms.size(), face[k].terms.size());
        for (std::size_t t = 0; t < skin[k].terms.size(); ++t)
          EXPECT_NEAR(skin[k].terms[t].weight, face[k].terms[t].weight, rounding);
      }
    }
    Obstacle ground;
    ground.point = above;
    ground.direction = above;
    std::map<long long, double> areas;
    for (const ContactPoint& point : obstaclePoints(bottom, ground))
      areas[point.node] = point.area;
    for (const ContactPoint& point : obstaclePoints(skinOf(upper), ground))
      if (const auto found = areas.find(point.node); found != areas.end())
        EXPECT_NEAR(point.area, found->second, rounding) << fem::shapeOf(type).name;
  }
}

// A block in a hole of its shape: at a corner a point for each of its sides.
TEST(SurfaceSides, matching_corners) {
  const fem::StructuredBlock inner =
      block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {2, 2, 1});
  const Surface skin = skinOf(inner);
  // The same nodes, seen from the other side.
  Surface hole = skin;
  for (long long& number : hole.numbers)
    number += inner.numberOfNodes();
  for (std::size_t k = 0; k < hole.facets.size(); k += 2)
    std::swap(hole.facets[k], hole.facets[k + 1]);
  for (std::size_t k = 0; k < hole.sideNormals.size(); k += 2)
    std::swap(hole.sideNormals[k], hole.sideNormals[k + 1]);
  for (auto* normals : {&hole.normals, &hole.sideNormals})
    for (Point& normal : *normals)
      normal = scaled(-1.0, normal);
  const std::vector<ContactPoint> points = matchNodes(skin, hole);
  EXPECT_EQ(points.size(), 12u); // 4 corners twice, 4 between them
  for (const ContactPoint& point : points)
    EXPECT_NEAR(std::abs(point.normal[0]) + std::abs(point.normal[1]), 1.0, 1e-15);
  EXPECT_EQ(matchNodes(skin, hole, samePlace, true).size(), 8u);
}

// The same on any number of ranks, to the last bit.
TEST(SurfaceSides, pieces) {
  const Teuchos::Comm<int>& comm = *testComm();
  for (CellType type : allTypes) {
    const fem::StructuredBlock body = block(type, {0, 0, 0}, {1, 1, 1}, {3, 2, 2}, {1, 1, 1});
    const Surface whole = splitAtEdges(skinOf(body));
    const Surface piece = splitAtEdges(skinOf(body, comm.getRank(), comm.getSize(), comm));
    const auto keyOf = [](const Surface& surface, std::size_t i) {
      return std::make_tuple(surface.numbers[i], surface.normals[i]);
    };
    std::map<std::tuple<long long, Point>, double> areas;
    for (std::size_t i = 0; i < whole.numbers.size(); ++i)
      areas[keyOf(whole, i)] = whole.areas[i];
    for (std::size_t i = 0; i < piece.numbers.size(); ++i) {
      const auto found = areas.find(keyOf(piece, i));
      ASSERT_NE(found, areas.end()) << fem::shapeOf(type).name;
      if (piece.isOwnNode[i] != 0)
        EXPECT_EQ(piece.areas[i], found->second);
    }
  }
}

} // namespace test_surface_sides
