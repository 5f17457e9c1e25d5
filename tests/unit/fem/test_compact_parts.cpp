// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CompactParts.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_compact_parts {

using namespace Harmos;
using namespace Harmos::fem;

namespace {

BodyMesh block(CellType type, std::array<int, 3> elements, Point size) {
  StructuredBlock::Options options;
  options.cellType = type;
  options.elements = elements;
  options.size = {size[0], size[1], size[2]};
  BodyMesh body;
  body.name = "block";
  body.mesh = *StructuredBlock(options).subdomain(0).mesh;
  body.regions = {"all"};
  return body;
}

Point centreOf(const Mesh& mesh, int cell) {
  Point centre{};
  const auto corners = shapeOf(mesh.cellType).corners;
  for (int k = 0; k < static_cast<int>(corners); ++k)
    for (std::size_t d = 0; d < 3; ++d)
      centre[d] += mesh.local(mesh.cell(cell)[k])[d] / static_cast<double>(corners);
  return centre;
}

std::vector<int> sizesOf(const std::vector<int>& labels, int parts) {
  std::vector<int> sizes(static_cast<std::size_t>(parts), 0);
  for (int label : labels)
    ++sizes[static_cast<std::size_t>(label)];
  return sizes;
}

// Mean square of the distance of cells from the centroid of their part.
double spread(const Mesh& mesh, const std::vector<int>& labels, int parts) {
  const std::vector<int> sizes = sizesOf(labels, parts);
  std::vector<Point> centroids(static_cast<std::size_t>(parts), Point{});
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    for (std::size_t d = 0; d < 3; ++d) {
      const auto part = static_cast<std::size_t>(labels[static_cast<std::size_t>(c)]);
      centroids[part][d] += centreOf(mesh, c)[d] / sizes[part];
    }
  double sum = 0.0;
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    for (std::size_t d = 0; d < 3; ++d)
      sum += std::pow(centreOf(mesh, c)[d] -
                          centroids[static_cast<std::size_t>(labels[static_cast<std::size_t>(c)])][d],
                      2);
  return sum / mesh.numberOfCells();
}

// Sides between parts.
int cutSides(const CellGraph& graph, const std::vector<int>& labels) {
  int sides = 0;
  for (int c = 0; c < graph.cells(); ++c)
    for (const int* other = graph.begin(c); other != graph.end(c); ++other)
      sides += labels[static_cast<std::size_t>(*other)] != labels[static_cast<std::size_t>(c)] ? 1 : 0;
  return sides / 2;
}

} // namespace

// Quarters of a square with fingers into each other become quarters again.
TEST(CompactParts, fingers_become_blocks) {
  const BodyMesh body = block(CellType::Quadrilateral4, {32, 32, 1}, {1.0, 1.0, 1.0});
  const CellGraph graph = graphOf(body.mesh);
  // Quarters with fingers of one cell's width that reach far into the neighbour.
  std::vector<int> labels;
  for (int c = 0; c < body.mesh.numberOfCells(); ++c) {
    const Point x = centreOf(body.mesh, c);
    const int row = static_cast<int>(32.0 * x[1]);
    const double border = row % 4 == 1 ? 0.9 : row % 4 == 3 ? 0.1 : 0.5;
    labels.push_back((x[0] < border ? 0 : 1) + (x[1] < 0.5 ? 0 : 2));
  }
  ASSERT_GT(cutSides(graph, labels), 300);
  roundOff(graph, 4, labels);
  // Quarters cut 64 sides, and have a spread of 2·(1/2)²/12.
  EXPECT_LE(cutSides(graph, labels), 80);
  EXPECT_NEAR(spread(body.mesh, labels, 4), 1.0 / 24.0, 0.1 / 24.0);
}

// METIS' parts get rounder and stay balanced, in the plane and in space, also where cells are twenty times
// smaller at one end.
TEST(CompactParts, parts_are_rounder_than_those_of_METIS_and_as_large_as_wanted) {
  for (CellType type : {CellType::Triangle3, CellType::Quadrilateral9, CellType::Tetrahedron4,
                        CellType::Tetrahedron10, CellType::Hexahedron8})
    for (bool graded : {false, true}) {
      SCOPED_TRACE(shapeOf(type).name + (graded ? ", graded" : ""));
      const bool plane = shapeOf(type).dimension == 2;
      BodyMesh body =
          plane ? block(type, {40, 40, 1}, {1.0, 1.0, 1.0}) : block(type, {12, 12, 12}, {1, 1, 1});
      const auto d = static_cast<std::size_t>(shapeOf(type).dimension);
      if (graded)
        for (std::size_t k = 0; k < body.mesh.coordinates.size(); k += d)
          body.mesh.coordinates[k] = (std::exp(3.0 * body.mesh.coordinates[k]) - 1.0) / (std::exp(3.0) - 1.0);
      constexpr int wanted = 16;
      const Partition metis = partitionCells(body, wanted, {PartitionMethod::Metis}),
                      compact = partitionCells(body, wanted);
      EXPECT_EQ(compact.parts, wanted);
      EXPECT_EQ(compact.part, partitionCells(body, wanted).part) << "the same again";
      if (!graded)
        EXPECT_LE(spread(body.mesh, compact.part, wanted), spread(body.mesh, metis.part, wanted));
      const double average = static_cast<double>(body.mesh.numberOfCells()) / wanted;
      for (int size : sizesOf(compact.part, wanted)) {
        EXPECT_LT(size, 1.3 * average);
        EXPECT_GT(size, 0.7 * average);
      }
    }
}

// The arms of a U lie side by side, and are far from each other.
TEST(CompactParts, no_part_reaches_across_a_slit) {
  BodyMesh body = block(CellType::Quadrilateral4, {20, 40, 1}, {1.0, 2.0, 1.0});
  std::vector<int> cells;
  for (int c = 0; c < body.mesh.numberOfCells(); ++c) {
    const Point x = centreOf(body.mesh, c);
    if (!(x[0] > 0.45 && x[0] < 0.55 && x[1] > 0.2))
      cells.insert(cells.end(), body.mesh.cell(c), body.mesh.cell(c) + 4);
  }
  body.mesh.cells = cells;
  const Partition parts = partitionCells(body, 8);
  EXPECT_EQ(parts.parts, 8);
  EXPECT_TRUE(parts.notes.empty());
  std::vector<int> left(8, 0), right(8, 0);
  for (int c = 0; c < body.mesh.numberOfCells(); ++c) {
    const Point x = centreOf(body.mesh, c);
    if (x[1] > 0.5)
      ++(x[0] < 0.5 ? left : right)[static_cast<std::size_t>(parts.part[static_cast<std::size_t>(c)])];
  }
  for (std::size_t p = 0; p < 8; ++p)
    EXPECT_TRUE(left[p] == 0 || right[p] == 0) << p;
}

// Each cell at the end of a part hangs by one side, and looks at the next part by another one.
TEST(CompactParts, rows_of_cells_are_cut_evenly) {
  for (CellType type : {CellType::Quadrilateral4, CellType::Triangle3, CellType::Hexahedron8}) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type, {40, 1, 1}, {40.0, 1.0, 1.0});
    for (int parts : {2, 5}) {
      const Partition partition = partitionCells(body, parts);
      ASSERT_EQ(partition.parts, parts);
      for (int size : sizesOf(partition.part, parts))
        EXPECT_NEAR(size, body.mesh.numberOfCells() / parts, 0.15 * body.mesh.numberOfCells() / parts);
    }
  }
}

TEST(CompactParts, another_seed_gives_another_cut) {
  const BodyMesh body = block(CellType::Tetrahedron4, {8, 8, 8}, {1.0, 1.0, 1.0});
  EXPECT_NE(partitionCells(body, 12, {PartitionMethod::Compact, 1}).part,
            partitionCells(body, 12, {PartitionMethod::Compact, 2}).part);
}

} // namespace test_compact_parts
