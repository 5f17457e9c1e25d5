// SPDX-License-Identifier: BSD-3-Clause

/// Pieces of surfaces on several ranks against whole ones on each: the same points, to the last bit.

#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

namespace test_pieces {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

Surface pieceOf(const fem::StructuredBlock& body, const std::string& set,
                const NormalField& field = nullptr) {
  const auto comm = testComm();
  return gather(share(body, comm->getRank(), comm->getSize()), set, "body/" + set, field, *comm);
}

std::vector<ContactPoint> byNode(std::vector<ContactPoint> points) {
  std::sort(points.begin(), points.end(),
            [](const ContactPoint& a, const ContactPoint& b) { return a.node < b.node; });
  return points;
}

void expectSame(const std::vector<ContactPoint>& pieces, const std::vector<ContactPoint>& whole,
                const std::string& what) {
  const std::vector<ContactPoint> all = byNode(gatherPoints(*testComm(), pieces));
  ASSERT_EQ(all.size(), whole.size()) << what;
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(all[k].node, whole[k].node) << what;
    EXPECT_EQ(all[k].position, whole[k].position) << what;
    EXPECT_EQ(all[k].normal, whole[k].normal) << what;
    EXPECT_EQ(all[k].gap, whole[k].gap) << what;
    EXPECT_EQ(all[k].area, whole[k].area) << what;
    ASSERT_EQ(all[k].terms.size(), whole[k].terms.size()) << what;
    for (std::size_t t = 0; t < all[k].terms.size(); ++t) {
      EXPECT_EQ(all[k].terms[t].node, whole[k].terms[t].node) << what;
      EXPECT_EQ(all[k].terms[t].weight, whole[k].terms[t].weight) << what;
    }
  }
}

// Bent, so that no two normals and gaps are alike.
Point bent(const Point& x) {
  return {x[0] + 0.02 * x[1] * x[2], x[1], x[2] + 0.03 * x[0] * x[0] - 0.02 * x[1]};
}
Point bentInPlane(const Point& x) {
  return {x[0] + 0.05 * x[1], x[1] + 0.04 * x[0] * x[0], 0.0};
}

fem::StructuredBlock lower(CellType type, const std::array<int, 3>& subdomains,
                           const std::array<int, 3>& elements) {
  const bool isPlane = fem::shapeOf(type).dimension == 2;
  return isPlane ? block(type, {0, -1, 0}, {1, 1, 0}, {subdomains[0], 1, 1}, elements, 0, bentInPlane)
                 : block(type, {0, 0, -1}, {1, 1.1, 1}, subdomains, elements, 0, bent);
}
// Moved, so that facets of both surfaces are covered in part.
fem::StructuredBlock upper(CellType type, const std::array<int, 3>& subdomains,
                           const std::array<int, 3>& elements) {
  const bool isPlane = fem::shapeOf(type).dimension == 2;
  return isPlane
             ? block(type, {0.13, 0.001, 0}, {1.2, 1, 0}, {subdomains[0], 1, 1}, elements, 10000, bentInPlane)
             : block(type, {0.13, -0.21, 0.001}, {1.2, 0.9, 1}, subdomains, elements, 10000, bent);
}

} // namespace

TEST(Pieces, surfaces_are_pieces_of_the_whole) {
  const auto comm = testComm();
  // In the last one copies of a node differ by rounding.
  for (const auto& body :
       {block(CellType::Hexahedron8, {0.1, 0.2, 0.3}, {1, 1, 1}, {3, 2, 1}, {2, 2, 1}, 0, bent),
        block(CellType::Tetrahedron10, {0.1, 0.2, 0.3}, {1, 1, 1}, {3, 2, 1}, {2, 2, 1}, 0, bent),
        block(CellType::Hexahedron8, {0.1, 0.2, 0.3}, {1.1, 1.3, 1}, {7, 5, 1}, {3, 3, 1})}) {
    const Surface piece = pieceOf(body, "top"), whole = surfaceOf(body, "top");
    long long facets = 0, nodes = 0;
    for (char isOwn : piece.isOwnFacet)
      facets += isOwn;
    for (char isOwn : piece.isOwnNode)
      nodes += isOwn;
    EXPECT_EQ(globalSum(*comm, facets), whole.numberOfFacets());
    EXPECT_EQ(globalSum(*comm, nodes), whole.numberOfNodes());
    EXPECT_EQ(piece.wholeNodes, whole.numberOfNodes());
    EXPECT_EQ(piece.wholeBox.low, whole.wholeBox.low);
    EXPECT_EQ(piece.wholeBox.high, whole.wholeBox.high);
    if (comm->getSize() == 4 && comm->getRank() == 3 && body.numberOfSubdomains() == 6) // it has one
      EXPECT_LT(piece.numberOfFacets(), whole.numberOfFacets());
    for (std::size_t i = 0; i < piece.numbers.size(); ++i) {
      const auto at = static_cast<std::size_t>(
          std::lower_bound(whole.numbers.begin(), whole.numbers.end(), piece.numbers[i]) -
          whole.numbers.begin());
      ASSERT_EQ(whole.numbers[at], piece.numbers[i]);
      EXPECT_EQ(piece.positions[i], whole.positions[at]);
      EXPECT_EQ(piece.normals[i], whole.normals[at]);
      EXPECT_EQ(piece.areas[i], whole.areas[at]);
    }
  }
}

TEST(Pieces, facets_near_boxes_are_found_on_any_rank) {
  const auto comm = testComm();
  const auto body = block(CellType::Hexahedron8, {0, 0, 0}, {1, 1, 1}, {4, 2, 1}, {2, 3, 1});
  const Surface piece = pieceOf(body, "top"), whole = surfaceOf(body, "top");
  const double x = 0.25 * comm->getRank();
  const std::vector<fem::Box> boxes = {{{x + 0.01, 0.1, 0.9}, {x + 0.3, 0.2, 1.1}},
                                       {{x, 0.0, 2.0}, {x + 1.0, 1.0, 3.0}}}; // the second one is nowhere
  const Surface near = facetsTouching(piece, boxes), all = facetsTouching(whole, boxes);
  EXPECT_GT(all.numberOfFacets(), 0);
  EXPECT_LT(all.numberOfFacets(), whole.numberOfFacets());
  EXPECT_EQ(near.facets, all.facets);
  EXPECT_EQ(near.numbers, all.numbers);
  EXPECT_EQ(near.normals, all.normals);
  EXPECT_EQ(facetsTouching(piece, {}).numberOfFacets(), 0);
}

TEST(Pieces, mortar_points_are_those_of_whole_surfaces) {
  for (const auto& [first, second] : {std::pair(CellType::Quadrilateral4, CellType::Quadrilateral9),
                                      std::pair(CellType::Triangle6, CellType::Quadrilateral4),
                                      std::pair(CellType::Hexahedron8, CellType::Tetrahedron4),
                                      std::pair(CellType::Tetrahedron10, CellType::Tetrahedron10),
                                      std::pair(CellType::Hexahedron27, CellType::Hexahedron8),
                                      std::pair(CellType::Hexahedron20, CellType::Hexahedron20)}) {
    const auto below = lower(first, {3, 2, 1}, {2, 3, 1}), above = upper(second, {2, 3, 1}, {3, 2, 1});
    const std::string what = fem::shapeOf(first).name + " on " + fem::shapeOf(second).name;
    const bool isPlane = fem::shapeOf(first).dimension == 2;
    const std::string top = "top", bottom = "bottom";
    expectSame(mortarPoints(pieceOf(below, top), pieceOf(above, bottom)),
               mortarPoints(surfaceOf(below, top), surfaceOf(above, bottom)),
               what + (isPlane ? " in the plane" : ""));
    expectSame(mortarPoints(pieceOf(above, bottom), pieceOf(below, top), 0.3),
               mortarPoints(surfaceOf(above, bottom), surfaceOf(below, top), 0.3), what + ", exchanged");
  }
}

TEST(Pieces, matched_nodes_are_those_of_whole_surfaces) {
  for (const CellType type : {CellType::Hexahedron8, CellType::Tetrahedron10}) {
    // The same nodes, cut otherwise.
    const auto below = block(type, {0, 0, -1}, {1, 1, 1}, {3, 2, 1}, {2, 2, 1}, 0, bent);
    const auto above = block(type, {0, 0, 0}, {1, 1, 1}, {2, 4, 1}, {3, 1, 1}, 10000, bent);
    const Surface first = pieceOf(below, "top"), second = pieceOf(above, "bottom");
    const auto all = matchNodesIfAll(first, second);
    ASSERT_TRUE(all);
    expectSame(*all, matchNodes(surfaceOf(below, "top"), surfaceOf(above, "bottom")), "if all match");
    expectSame(matchNodes(first, second), matchNodes(surfaceOf(below, "top"), surfaceOf(above, "bottom")),
               fem::shapeOf(type).name);
    const NormalField up = [](const Point& x) { return Point{0.1 * x[0], 0, 1}; };
    expectSame(matchNodes(pieceOf(below, "top", up), second),
               matchNodes(surfaceOf(below, "top", up), surfaceOf(above, "bottom")), "given normals");
  }
}

// Two nodes at each place, on subdomains of different ranks.
TEST(Pieces, nodes_at_one_place_have_a_partner_each) {
  const auto comm = testComm();
  const auto meshes = [&](double y, long long firstNode, int rank, int ranks) {
    std::vector<fem::PlacedMesh> mine;
    for (int k = 0; k < 4; ++k)
      if (k % ranks == rank)
        for (const fem::PlacedMesh& mesh : share(block(CellType::Quadrilateral4, {1.0 * k, y, 0}, {1, 1, 0},
                                                       {1, 1, 1}, {2, 1, 1}, firstNode + 10 * k)))
          mine.push_back(mesh);
    return mine;
  };
  const int rank = comm->getRank(), ranks = comm->getSize();
  const Surface first = gather(meshes(0, 0, rank, ranks), "top", "lower", nullptr, *comm),
                second = gather(meshes(1, 100, ranks - 1 - rank, ranks), "bottom", "upper", nullptr, *comm);
  EXPECT_TRUE(matchNodesIfAll(first, second));
  const auto whole =
      matchNodes(gather(meshes(0, 0, 0, 1), "top", "lower"), gather(meshes(1, 100, 0, 1), "bottom", "upper"));
  EXPECT_EQ(whole.size(), 12u);
  expectSame(matchNodes(first, second), whole, "blocks side by side");
}

TEST(Pieces, obstacle_points_are_those_of_whole_surfaces) {
  const auto body = block(CellType::Tetrahedron10, {0, 0, 1}, {1, 1, 1}, {3, 2, 1}, {2, 2, 1}, 0, bent);
  Obstacle ball;
  ball.shape = Obstacle::Shape::Sphere;
  ball.point = {0.4, 0.3, -2.0};
  ball.radius = 2.5;
  expectSame(obstaclePoints(pieceOf(body, "bottom"), ball), obstaclePoints(surfaceOf(body, "bottom"), ball),
             "ball");
}

// What is wrong on one rank alone is told on all, with the same words as of a whole surface.
TEST(Pieces, faults_are_told_on_all_ranks) {
  const auto comm = testComm();
  const int rank = comm->getRank(), ranks = comm->getSize();
  const auto body = block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {4, 1, 1}, {2, 2, 1});
  const auto other =
      block(CellType::Quadrilateral4, {0, 1, 0}, {1, 1, 0}, {4, 1, 1}, {2, 2, 1}, 1000, [](const Point& x) {
        return Point{x[0], x[1], 0};
      });
  auto inner = share(body, rank, ranks);
  for (fem::PlacedMesh& mesh : inner)
    for (const fem::Side& side : fem::boundarySides(*mesh.mesh))
      mesh.sides["all"].push_back(side);
  const std::string crossing = messageOf([&] { gather(inner, "all", "body/all", nullptr, *comm); });
  EXPECT_TRUE(contains(crossing, "4 facets meet at the node at")) << crossing;
  const std::string empty = messageOf([&] { pieceOf(body, "lid"); });
  EXPECT_TRUE(contains(empty, "the part \"lid\" has no sides of cells")) << empty;

  // A partner is missing at one end: the node of the lowest number is named.
  const auto moved =
      block(CellType::Quadrilateral4, {0, 1, 0}, {1, 1, 0}, {4, 1, 1}, {2, 2, 1}, 1000, [](const Point& x) {
        return Point{x[0] > 0.8 ? x[0] + 0.1 : x[0], x[1], 0};
      });
  const Surface top = pieceOf(body, "top");
  EXPECT_TRUE(matchNodesIfAll(top, pieceOf(other, "bottom")));
  EXPECT_FALSE(matchNodesIfAll(top, pieceOf(moved, "bottom")));
  const std::string alone = messageOf([&] { matchNodes(top, pieceOf(moved, "bottom")); });
  EXPECT_TRUE(
      contains(alone, "node 25 at (0.875000, 1.000000, 0.000000) of the first surface has no partner"))
      << alone;
  const std::string far = messageOf([&] {
    mortarPoints(
        top,
        pieceOf(block(CellType::Quadrilateral4, {9, 1, 0}, {1, 1, 0}, {4, 1, 1}, {2, 2, 1}, 1000), "bottom"));
  });
  EXPECT_TRUE(contains(far, "the surfaces never meet")) << far;
  const NormalField down = [](const Point& x) { return Point{0, x[0] > 0.9 ? -1.0 : 1.0, 0}; };
  const std::string inward = messageOf([&] { pieceOf(body, "top", down); });
  EXPECT_TRUE(contains(inward, "does not point outward")) << inward;
}

} // namespace test_pieces
