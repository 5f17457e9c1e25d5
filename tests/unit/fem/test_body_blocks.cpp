// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BodyBlocks.hpp"

#include <gtest/gtest.h>

namespace test_body_blocks {

using namespace Harmos;
using fem::BodyMesh;
using fem::CellType;

namespace {

/// Of a plane body: cells of its nodes, which are at (number, 0).
BodyMesh block(CellType type, const std::vector<int>& cells, const std::vector<int>& numbers) {
  BodyMesh block;
  block.mesh.cellType = type;
  block.mesh.cells = cells;
  for (int number : numbers)
    block.mesh.coordinates.insert(block.mesh.coordinates.end(), {static_cast<double>(number), 0.0});
  block.numbers = numbers;
  return block;
}

} // namespace

TEST(BodyBlocks, parts_go_by_cells_and_sum_to_what_is_wanted) {
  const std::vector<int> numbers(40, 0);
  const auto triangles = [&](int count) {
    return block(CellType::Triangle3, std::vector<int>(static_cast<std::size_t>(3 * count), 0), numbers);
  };
  const std::vector<BodyMesh> blocks = {triangles(10), triangles(3), triangles(27)};
  EXPECT_EQ(fem::partsOfBlocks(blocks, 40), (std::vector<int>{10, 3, 27}));
  EXPECT_EQ(fem::partsOfBlocks(blocks, 8), (std::vector<int>{2, 1, 5}));
  EXPECT_EQ(fem::partsOfBlocks(blocks, 1), (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(fem::partsOfBlocks({triangles(7)}, 5), (std::vector<int>{5}));
  for (int wanted = 9; wanted <= 40; ++wanted) {
    const std::vector<int> parts = fem::partsOfBlocks(blocks, wanted);
    EXPECT_EQ(parts[0] + parts[1] + parts[2], wanted);
    for (std::size_t k = 0; k < parts.size(); ++k)
      EXPECT_LE(parts[k], blocks[k].mesh.numberOfCells()) << wanted;
  }
}

TEST(BodyBlocks, pieces_hang_together_across_blocks) {
  // Triangles 0 1 2 and 3 4 5, and a quadrilateral.
  const BodyMesh triangles = block(CellType::Triangle3, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5});
  const BodyMesh between = block(CellType::Quadrilateral4, {0, 1, 2, 3}, {2, 3, 6, 7});
  const BodyMesh beside = block(CellType::Quadrilateral4, {0, 1, 2, 3}, {2, 6, 7, 8});
  EXPECT_EQ(fem::numberOfNodes({triangles, between}), 8);
  EXPECT_EQ(fem::numberOfPieces({triangles, between}), 1);
  EXPECT_EQ(fem::numberOfPieces({triangles, beside}), 2);
}

TEST(BodyBlocks, bodies_are_put_together_by_name) {
  BodyMesh a, b;
  a.name = "a";
  b.name = "b";
  const std::vector<std::vector<BodyMesh>> bodies = fem::groupedByBody({a, a, b, a});
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(bodies[0].size(), 2u);
  EXPECT_EQ(bodies[1].front().name, "b");
}

} // namespace test_body_blocks
