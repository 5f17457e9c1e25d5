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

// A square of nodes 0 1 2 3 around, and a triangle 1 4 2 beside it.
std::vector<BodyMesh> squareAndTriangle() {
  BodyMesh square = block(CellType::Quadrilateral4, {0, 1, 2, 3}, {0, 1, 2, 3});
  BodyMesh triangle = block(CellType::Triangle3, {0, 2, 1}, {1, 2, 4});
  square.mesh.coordinates = {0, 0, 1, 0, 1, 1, 0, 1};
  triangle.mesh.coordinates = {1, 0, 1, 1, 2, 0.5};
  for (BodyMesh* block : {&square, &triangle})
    block->matched = std::make_shared<const fem::MatchedSides>(matchSides(block->mesh));
  return {square, triangle};
}

TEST(BodyBlocks, sides_between_blocks_leave_parts_and_copies_of_nodes_join_them) {
  std::vector<BodyMesh> blocks = squareAndTriangle();
  blocks[0].sides["bottom"] = {{0, 0}}; // 0 1
  blocks[0].sides["seam"] = {{0, 1}};   // 1 2
  blocks[1].sides["seam"] = {{0, 2}};   // the same
  blocks[1].sides["outside"] = {{0, 0}, {0, 1}};
  blocks[0].fields = {{"both", {0, 0, 0, 0}}, {"one", {0, 0, 0, 0}}};
  blocks[1].fields = {{"both", {0, 0, 0}}};
  joinBlocks(blocks, "here");
  EXPECT_EQ(blocks[0].sides.count("seam") + blocks[1].sides.count("seam"), 0u);
  EXPECT_EQ(blocks[0].nodes.at("seam"), (std::vector<int>{1, 2}));
  EXPECT_EQ(blocks[1].nodes.at("seam"), (std::vector<int>{0, 1}));
  EXPECT_EQ(blocks[0].sides.at("bottom").size(), 1u);
  EXPECT_EQ(blocks[1].nodes.at("bottom"), (std::vector<int>{0}));
  EXPECT_EQ(blocks[0].nodes.at("outside"), (std::vector<int>{1, 2}));
  EXPECT_EQ(blocks[1].sides.at("outside").size(), 2u);
  EXPECT_EQ(blocks[0].nodes.count("bottom"), 0u); // its own sides say so
  EXPECT_EQ(blocks[0].fields.size(), 1u);
  EXPECT_EQ(blocks[0].mesh.boundary, (std::vector<int>{0, 1, 2, 3}));
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
