// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace test_partition {

using namespace Harmos;
using fem::BodyMesh;
using fem::CellType;
using fem::Partition;
using fem::partitionCells;

namespace {

BodyMesh block(CellType type, int n) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {n, n, n};
  BodyMesh body;
  body.name = "block";
  body.mesh = *fem::StructuredBlock(options).subdomain(0).mesh;
  body.regions = {"all"};
  return body;
}

/// Bodies of quadrilaterals or hexahedra from unit squares or cubes at places of a grid, which share the
/// grid's nodes.
BodyMesh onGrid(CellType type, const std::vector<std::array<int, 3>>& places) {
  const fem::CellShape& shape = fem::shapeOf(type);
  BodyMesh body;
  body.name = "grid";
  body.mesh.cellType = type;
  std::map<std::array<int, 3>, int> numbers;
  for (const std::array<int, 3>& place : places)
    for (const fem::Point& corner : shape.nodeCoordinates) {
      std::array<int, 3> node{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimension); ++d)
        node[d] = place[d] + (corner[d] > 0.0 ? 1 : 0);
      const auto [found, isNew] = numbers.emplace(node, static_cast<int>(numbers.size()));
      if (isNew)
        for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimension); ++d)
          body.mesh.coordinates.push_back(node[d]);
      body.mesh.cells.push_back(found->second);
    }
  return body;
}

std::vector<int> sizes(const Partition& partition) {
  std::vector<int> result(static_cast<std::size_t>(partition.parts), 0);
  for (int p : partition.part)
    ++result[static_cast<std::size_t>(p)];
  return result;
}

/// Whether the cells of a part reach each other through corners that make up a side.
bool hangsTogether(const BodyMesh& body, const Partition& partition, int part) {
  std::vector<int> cells;
  for (std::size_t c = 0; c < partition.part.size(); ++c)
    if (partition.part[c] == part)
      cells.push_back(static_cast<int>(c));
  const fem::CellShape& shape = fem::shapeOf(body.mesh.cellType);
  const auto needed = static_cast<std::size_t>(fem::shapeOf(shape.sideTypes.front()).corners);
  const auto corners = [&](int c) {
    return std::set<int>(body.mesh.cell(c), body.mesh.cell(c) + shape.corners);
  };
  std::vector<int> reached = {cells.front()};
  std::set<int> left(cells.begin() + 1, cells.end());
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const std::set<int> mine = corners(reached[k]);
    for (auto other = left.begin(); other != left.end();) {
      std::size_t common = 0;
      for (int node : corners(*other))
        common += mine.count(node);
      if (common == needed) {
        reached.push_back(*other);
        other = left.erase(other);
      } else {
        ++other;
      }
    }
  }
  return left.empty();
}

void expectSound(const BodyMesh& body, const Partition& partition) {
  ASSERT_EQ(static_cast<int>(partition.part.size()), body.mesh.numberOfCells());
  int seen = 0;
  for (int p : partition.part) {
    EXPECT_LE(p, seen) << "parts are numbered by their lowest cells";
    seen = std::max(seen, p + 1);
  }
  EXPECT_EQ(seen, partition.parts) << "no part is empty";
  for (int p = 0; p < partition.parts; ++p)
    EXPECT_TRUE(hangsTogether(body, partition, p)) << "part " << p;
}

} // namespace

TEST(Partition, parts_hang_together_and_are_balanced) {
  for (CellType type : {CellType::Triangle3, CellType::Quadrilateral9, CellType::Tetrahedron4,
                        CellType::Tetrahedron10, CellType::Hexahedron8}) {
    const BodyMesh body = block(type, fem::shapeOf(type).dimension == 2 ? 24 : 6);
    SCOPED_TRACE(fem::shapeOf(type).name);
    for (int wanted : {1, 2, 7, 12}) {
      const Partition partition = partitionCells(body, wanted, {fem::PartitionMethod::Metis});
      SCOPED_TRACE(wanted);
      expectSound(body, partition);
      expectSound(body, partitionCells(body, wanted));
      EXPECT_EQ(partition.parts, wanted);
      EXPECT_TRUE(partition.notes.empty());
      const double average = static_cast<double>(body.mesh.numberOfCells()) / wanted;
      for (int size : sizes(partition)) { // METIS allows three per cent beyond the average
        EXPECT_LT(size, 1.05 * average + 1);
        EXPECT_GT(size, 0.75 * average);
      }
      EXPECT_EQ(partition.part, partitionCells(body, wanted, {fem::PartitionMethod::Metis}).part)
          << "the same again";
    }
  }
}

TEST(Partition, squares_that_meet_in_a_node_are_two_parts) {
  const BodyMesh body = onGrid(CellType::Quadrilateral4, {{0, 0, 0}, {1, 1, 0}});
  ASSERT_EQ(body.mesh.numberOfNodes(), 7);
  const Partition partition = partitionCells(body, 1);
  EXPECT_EQ(partition.parts, 2);
  EXPECT_EQ(partition.part, (std::vector<int>{0, 1}));
  ASSERT_EQ(partition.notes.size(), 2u);
  EXPECT_EQ(partition.notes[0],
            "Body \"grid\" consists of 2 components without common sides; each is partitioned separately.");
  EXPECT_EQ(partition.notes[1], "Body \"grid\" is partitioned into 2 parts instead of 1.");
}

TEST(Partition, cubes_that_meet_in_an_edge_or_a_node_are_parts_of_their_own) {
  const BodyMesh body = onGrid(CellType::Hexahedron8, {{0, 0, 0}, {1, 1, 0}, {2, 2, 1}, {2, 2, 2}});
  const Partition partition = partitionCells(body, 1);
  EXPECT_EQ(partition.part, (std::vector<int>{0, 1, 2, 2}));
  expectSound(body, partition);
}

TEST(Partition, components_are_cut_in_proportion) {
  std::vector<std::array<int, 3>> places;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 31; ++i)
      if (i != 10) // 100 cells, a gap, 200 cells
        places.push_back({i, j, 0});
  const BodyMesh body = onGrid(CellType::Quadrilateral4, places);
  const Partition partition = partitionCells(body, 6);
  expectSound(body, partition);
  EXPECT_EQ(partition.parts, 6);
  EXPECT_EQ(partition.notes.size(), 1u);
  std::set<int> left;
  for (std::size_t c = 0; c < places.size(); ++c)
    if (places[c][0] < 10)
      left.insert(partition.part[c]);
  EXPECT_EQ(left.size(), 2u);
  EXPECT_EQ(partitionCells(body, 1).parts, 2);
}

TEST(Partition, down_to_single_cells) {
  const BodyMesh body = block(CellType::Quadrilateral4, 4);
  for (int wanted = 1; wanted <= 16; ++wanted) {
    const Partition partition = partitionCells(body, wanted);
    SCOPED_TRACE(wanted);
    expectSound(body, partition);
    EXPECT_EQ(partition.parts == wanted, partition.notes.empty());
  }
}

TEST(Partition, pieces_of_a_part_are_split_off_or_join_a_neighbour) {
  std::vector<std::array<int, 3>> places;
  std::vector<int> part;
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 40; ++i) {
      places.push_back({i, j, 0});
      part.push_back(i < 20 ? 7 : i < 30 ? 3 : 7); // the second piece of 7 is large
    }
  part[5 * 40 + 25] = 7; // tiny, inside 3
  part[0] = 3;           // tiny, in a corner of 7
  const BodyMesh body = onGrid(CellType::Quadrilateral4, places);
  const Partition mended = mendParts(body, part);
  expectSound(body, mended);
  EXPECT_EQ(mended.parts, 3);
  EXPECT_EQ(sizes(mended), (std::vector<int>{200, 100, 100}));
  ASSERT_EQ(mended.notes.size(), 1u);
  EXPECT_EQ(mended.notes[0], "Parts in pieces without common sides: 1 pieces became separate parts, "
                             "2 tiny pieces joined a neighbour.");
}

TEST(Partition, a_hinge_within_a_part_is_cut) {
  // A board of 2 × 2 fields of 4 × 4 cells, as a chess board: each colour hangs together in the middle node.
  std::vector<std::array<int, 3>> places;
  std::vector<int> part;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      places.push_back({i, j, 0});
      part.push_back((i / 4 + j / 4) % 2);
    }
  const BodyMesh body = onGrid(CellType::Quadrilateral4, places);
  const Partition mended = mendParts(body, part);
  expectSound(body, mended);
  EXPECT_EQ(sizes(mended), (std::vector<int>{16, 16, 16, 16}));
}

TEST(Partition, tiny_neighbours_join_without_falling_apart) {
  // Every other cell of a column in the middle, then of another: chains of tiny pieces side by side.
  std::vector<std::array<int, 3>> places;
  std::vector<int> part;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) {
      places.push_back({i, j, 0});
      const bool isMiddle = i >= 8 && i < 12;
      part.push_back(isMiddle ? (i + j) % 4 : i < 10 ? 0 : 1);
    }
  const BodyMesh body = onGrid(CellType::Quadrilateral4, places);
  expectSound(body, mendParts(body, part));
}

TEST(Partition, refuses_more_parts_than_cells) {
  const BodyMesh body = block(CellType::Triangle3, 2);
  EXPECT_EQ(
      inputErrorOf([&] { partitionCells(body, 9); }),
      "body \"block\" cannot be partitioned into 9 parts: it has 8 cells. Choose between 1 and that many "
      "parts");
  EXPECT_THROW(partitionCells(body, 0), InputError);
}

} // namespace test_partition
