// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces deep in other bodies, against what is known of blocks; on any number of ranks.

#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Overlap.hpp"

#include <gtest/gtest.h>

namespace test_overlap {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

// Whether the upper of two blocks of this rank's share has a surface in the lower one, or the other way
// round.
struct Pair {
  fem::StructuredBlock upper, lower;

  bool overlap(const std::string& part, double depth, bool isLower = false) const {
    const auto comm = testComm();
    const std::vector<fem::PlacedMesh> above = share(upper, comm->getRank(), comm->getSize()),
                                       below = share(lower, comm->getRank(), comm->getSize());
    std::vector<const fem::PlacedMesh*> body;
    for (const fem::PlacedMesh& mesh : isLower ? above : below)
      body.push_back(&mesh);
    return deepOverlap(gather(isLower ? below : above, part, "surface", nullptr, *comm), body, depth)
        .has_value();
  }
};

// The lower one is [0, 2] × [0, 1] (× [0, 1]), the upper one a cube.
Pair pairOf(CellType type, const Point& origin, int cells) {
  const bool isPlane = fem::shapeOf(type).dimension == 2;
  const std::array<int, 3> two = isPlane ? std::array<int, 3>{2, 2, 1} : std::array<int, 3>{2, 1, 2};
  const std::array<int, 3> elements = {cells, cells, isPlane ? 1 : cells};
  return {block(type, origin, {1, 1, isPlane ? 0.0 : 1.0}, {1, 1, 1}, elements, 10000),
          block(type, {0, 0, 0}, {2, 1, isPlane ? 0.0 : 1.0}, two, elements)};
}

constexpr std::array<CellType, 6> types = {CellType::Triangle3,   CellType::Quadrilateral4,
                                           CellType::Triangle6,   CellType::Quadrilateral8,
                                           CellType::Hexahedron8, CellType::Tetrahedron10};

std::string lowerSide(CellType type) {
  return fem::shapeOf(type).dimension == 2 ? "bottom" : "front"; // towards −y
}
std::string upperSide(CellType type) {
  return fem::shapeOf(type).dimension == 2 ? "top" : "back";
}

} // namespace

TEST(Overlap, is_found_beyond_the_depth_alone) {
  for (const CellType type : types)
    for (int cells : {1, 3})
      for (const auto& [height, depth, isDeep] : {std::tuple{0.7, 0.1, true},
                                                  {0.7, 0.29, true},
                                                  {0.7, 0.31, false},
                                                  {0.95, 0.1, false},
                                                  {1.0, 0.01, false},
                                                  {1.2, 0.1, false}}) {
        const Pair pair = pairOf(type, {0.5, height, 0.0}, cells);
        SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)) + " height " + std::to_string(height) +
                     " depth " + std::to_string(depth));
        EXPECT_EQ(pair.overlap(lowerSide(type), depth), isDeep);
        EXPECT_EQ(pair.overlap(upperSide(type), depth, true), isDeep);
      }
}

// Neighbours, and what stands in a slot, touch by rounding errors and have the other body on both sides.
TEST(Overlap, is_not_what_touches) {
  for (const CellType type : types) {
    EXPECT_FALSE(pairOf(type, {2.0, 0.3, 0.0}, 2).overlap(lowerSide(type), 0.1));
    EXPECT_FALSE(pairOf(type, {2.0 - 1e-12, 0.3, 0.0}, 2).overlap("left", 0.1));
    EXPECT_TRUE(pairOf(type, {1.5, 0.3, 0.0}, 2).overlap("left", 0.1));
  }
  const auto comm = testComm();
  const fem::StructuredBlock low = block(CellType::Quadrilateral4, {0, 0, 0}, {2, 0.5, 0}, {2, 1, 1},
                                         {3, 2, 1}),
                             high = block(CellType::Quadrilateral4, {0, 0.54, 0}, {2, 0.5, 0}, {2, 1, 1},
                                          {3, 2, 1}, 1000),
                             plate = block(CellType::Quadrilateral4, {0.5, 0.5 - 1e-13, 0}, {1, 0.04, 0},
                                           {1, 1, 1}, {4, 1, 1}, 2000);
  std::vector<fem::PlacedMesh> slot = share(low, comm->getRank(), comm->getSize());
  for (const fem::PlacedMesh& mesh : share(high, comm->getRank(), comm->getSize()))
    slot.push_back(mesh);
  std::vector<const fem::PlacedMesh*> body;
  for (const fem::PlacedMesh& mesh : slot)
    body.push_back(&mesh);
  const Surface bottom =
      gather(share(plate, comm->getRank(), comm->getSize()), "bottom", "plate", nullptr, *comm);
  EXPECT_FALSE(deepOverlap(bottom, body, 0.1).has_value());
}

} // namespace test_overlap
