// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PartShape.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace test_part_shape {

using namespace Harmos;
using namespace Harmos::fem;

namespace {

const std::vector<CellType> types = {CellType::Triangle3,     CellType::Triangle6,   CellType::Quadrilateral4,
                                     CellType::Tetrahedron4,  CellType::Hexahedron8, CellType::Tetrahedron10,
                                     CellType::Quadrilateral9};

bool isPlane(CellType type) {
  return shapeOf(type).dimension == 2;
}

// 60 x 30 or 24 x 12 x 12 cells or pieces of cells, in [0, 2] x [0, 1] (x [0, 1]).
BodyMesh block(CellType type) {
  StructuredBlock::Options options;
  options.cellType = type;
  options.elements = isPlane(type) ? std::array<int, 3>{60, 30, 1} : std::array<int, 3>{24, 12, 12};
  options.size = {2.0, 1.0, 1.0};
  BodyMesh body;
  body.name = "block";
  body.mesh = *StructuredBlock(options).subdomain(0).mesh;
  body.regions = {"all"};
  return body;
}

std::vector<int> labelled(const BodyMesh& body, const std::function<int(const Point&)>& labelAt) {
  std::vector<int> labels;
  const CellGraph graph = graphOf(body.mesh);
  for (const Point& centre : graph.centres)
    labels.push_back(labelAt(centre));
  return labels;
}

// How far a point is from the middle of a block's cross-section, in the maximum norm.
double aside(CellType type, const Point& x) {
  return std::max(std::abs(x[1] - 0.5), isPlane(type) ? 0.0 : std::abs(x[2] - 0.5));
}

// Part 0: both ends of the block, held together by a bar; part 1: the ring about the bar.
std::vector<int> dumbbell(const BodyMesh& body, double left, double right) {
  const CellType type = body.mesh.cellType;
  return labelled(body, [=](const Point& x) {
    return x[0] > left && x[0] < right && aside(type, x) > 1.0 / 12.0 ? 1 : 0;
  });
}

} // namespace

TEST(PartShape, a_dumbbell_is_ragged_and_its_neck_is_where_it_is_thin) {
  for (CellType type : types) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type);
    const CellGraph graph = graphOf(body.mesh);
    const std::vector<Point>& centres = graph.centres;
    // The smaller end is to the right.
    const std::vector<int> cells = cellsOf(dumbbell(body, 1.0, 1.4), 2)[0];
    const Neck neck = PartShapes(graph).neckOf(cells);
    EXPECT_LT(neck.width, raggedNeck);
    EXPECT_TRUE(std::is_sorted(neck.cells.begin(), neck.cells.end()));
    // Up to the bar's cells, which may lie on either side.
    int right = 0, wrong = 0;
    for (int cell : cells)
      right += centres[static_cast<std::size_t>(cell)][0] > 1.4 ? 1 : 0;
    for (int cell : neck.cells)
      wrong += centres[static_cast<std::size_t>(cell)][0] < 1.0 ? 1 : 0;
    EXPECT_EQ(wrong, 0);
    EXPECT_GE(static_cast<int>(neck.cells.size()), right);
  }
}

// Neither the order of x nor any straight cut finds the bridge between them.
TEST(PartShape, a_ball_in_a_shell_is_ragged) {
  for (CellType type : types) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type);
    const CellGraph graph = graphOf(body.mesh);
    const auto radius = [type](const Point& x) {
      return std::hypot(x[0] - 1.0, x[1] - 0.5, isPlane(type) ? 0.0 : x[2] - 0.5);
    };
    const std::vector<int> labels = labelled(body, [&](const Point& x) {
      const bool bridge = x[0] > 1.0 && radius(x) < 0.5 && aside(type, x) < 0.05;
      return bridge || radius(x) < 0.25 || (radius(x) > 0.34 && radius(x) < 0.5) ? 0 : 1;
    });
    const Neck neck = PartShapes(graph).neckOf(cellsOf(labels, 2)[0]);
    EXPECT_LT(neck.width, raggedNeck);
    const std::vector<Point>& centres = graph.centres;
    int inside = 0, outside = 0;
    for (const Point& centre : centres)
      inside += radius(centre) < 0.25 ? 1 : 0;
    for (int cell : neck.cells)
      outside += radius(centres[static_cast<std::size_t>(cell)]) > 0.36 ? 1 : 0;
    EXPECT_EQ(outside, 0);
    EXPECT_GE(static_cast<int>(neck.cells.size()), inside);
  }
}

// No straight cut and no circle separates them: what varies slowest is to be found, whatever one begins with.
TEST(PartShape, a_block_in_a_bay_is_ragged) {
  for (CellType type : types) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type);
    const CellGraph graph = graphOf(body.mesh);
    const auto isInBay = [](const Point& x) { return x[0] > 0.58 && x[0] < 1.42 && x[1] > 0.41; };
    const std::vector<int> labels = labelled(body, [&](const Point& x) {
      const bool bridge =
          x[0] > 0.58 && x[0] < 0.7 && x[1] < 0.5 && (isPlane(type) || std::abs(x[2] - 0.5) < 1.0 / 12.0);
      return bridge || isInBay(x) || x[0] < 0.41 || x[0] > 1.59 || x[1] < 0.25 ? 0 : 1;
    });
    const Neck neck = PartShapes(graph).neckOf(cellsOf(labels, 2)[0]);
    EXPECT_LT(neck.width, raggedNeck);
    const std::vector<Point>& centres = graph.centres;
    const auto inBay = std::count_if(centres.begin(), centres.end(), isInBay);
    const auto found = std::count_if(neck.cells.begin(), neck.cells.end(), [&](int cell) {
      return isInBay(centres[static_cast<std::size_t>(cell)]);
    });
    EXPECT_EQ(found, inBay);
    EXPECT_LE(static_cast<int>(neck.cells.size()), 1.1 * static_cast<double>(inBay));
  }
}

TEST(PartShape, blocks_and_balls_are_not_ragged) {
  for (CellType type : types) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type);
    const CellGraph graph = graphOf(body.mesh);
    // Two squares or cubes; a disc or a ball in what is left of the block; slices half as thick as wide.
    const std::vector<int> halves = labelled(body, [](const Point& x) { return x[0] < 1.0 ? 0 : 1; });
    const std::vector<int> ball = labelled(body, [type](const Point& x) {
      return std::hypot(x[0] - 1.0, x[1] - 0.5, isPlane(type) ? 0.0 : x[2] - 0.5) < 0.5 ? 0 : 1;
    });
    const std::vector<int> slices =
        labelled(body, [](const Point& x) { return static_cast<int>(2.0 * x[0]); });
    for (double width : neckWidths(graph, halves, 2))
      EXPECT_GT(width, 2.0 * raggedNeck);
    EXPECT_GT(neckWidths(graph, ball, 2)[0], 1.5 * raggedNeck);
    for (double width : neckWidths(graph, slices, 4))
      EXPECT_GT(width, 1.5 * raggedNeck);
  }
}

// Squares of 30 x 30 cells, cut in the middle: 30 sides and 450 cells.
TEST(PartShape, width_is_sides_across_over_the_root_of_the_smaller_side) {
  const BodyMesh body = block(CellType::Quadrilateral4);
  const CellGraph graph = graphOf(body.mesh);
  const std::vector<int> halves = labelled(body, [](const Point& x) { return x[0] < 1.0 ? 0 : 1; });
  for (double width : neckWidths(graph, halves, 2)) {
    EXPECT_GE(width, 0.95 * 30.0 / std::sqrt(450.0));
    EXPECT_LE(width, 1.15 * 30.0 / std::sqrt(450.0));
  }
}

TEST(PartShape, what_has_no_neck_and_what_is_in_pieces) {
  const BodyMesh body = block(CellType::Triangle3);
  const CellGraph graph = graphOf(body.mesh);
  PartShapes shapes(graph);
  EXPECT_TRUE(std::isinf(shapes.neckOf({3}).width));
  EXPECT_TRUE(std::isinf(shapes.neckOf({0, 1, 2, 3, 4, 5}).width));
  // The only part of a body has the shape of the body.
  const std::vector<int> one(static_cast<std::size_t>(body.mesh.numberOfCells()), 0);
  EXPECT_TRUE(std::isinf(neckWidths(graph, one, 1)[0]));
  const std::vector<int> ends =
      cellsOf(labelled(body, [](const Point& x) { return x[0] < 0.5 || x[0] > 1.7 ? 0 : 1; }), 2)[0];
  const Neck neck = shapes.neckOf(ends);
  EXPECT_EQ(neck.width, 0.0);
  EXPECT_LT(neck.cells.size(), ends.size() / 2);
}

// A row of quadrilaterals: the coordinate across does not vary.
TEST(PartShape, a_row_of_cells) {
  StructuredBlock::Options options;
  options.elements = {40, 1, 1};
  const Mesh mesh = *StructuredBlock(options).subdomain(0).mesh;
  std::vector<int> cells(40);
  std::iota(cells.begin(), cells.end(), 0);
  const CellGraph graph = graphOf(mesh);
  EXPECT_NEAR(PartShapes(graph).neckOf(cells).width, 1.0 / std::sqrt(20.0), 1e-12);
}

TEST(PartShape, a_planted_dumbbell_is_mended) {
  for (CellType type : types) {
    SCOPED_TRACE(shapeOf(type).name);
    const BodyMesh body = block(type);
    const CellGraph graph = graphOf(body.mesh);
    // Parts one beside the other, the second with a lump of its cells behind a bar through the third.
    const std::vector<int> planted = labelled(body, [type](const Point& x) {
      const bool bar = x[0] > 0.8 && x[0] < 1.2 && aside(type, x) < 1.0 / 12.0;
      const bool lump = x[0] > 1.2 && x[0] < 1.5 && aside(type, x) < 0.25;
      return bar || lump ? 1 : x[0] < 0.4 ? 0 : x[0] < 0.8 ? 1 : x[0] < 1.4 ? 2 : 3;
    });
    std::vector<int> labels = planted;
    std::vector<double> necks = neckWidths(graph, labels, 4);
    ASSERT_LT(necks[1], raggedNeck);
    EXPECT_EQ(mendNecks(graph, labels, necks), 1);
    for (double width : necks)
      EXPECT_GE(width, raggedNeck);
    EXPECT_EQ(necks, neckWidths(graph, labels, 4)) << "necks are those of the labels";
    EXPECT_EQ(componentsOf(graph, labels).cells.size(), 4u);
    // Nothing else is changed.
    const std::vector<Point>& centres = graph.centres;
    for (std::size_t cell = 0; cell < labels.size(); ++cell)
      if (labels[cell] != planted[cell]) {
        EXPECT_EQ(planted[cell], 1);
        EXPECT_GT(centres[cell][0], 0.8);
      }
    std::vector<int> again = planted;
    std::vector<double> widths = neckWidths(graph, again, 4);
    mendNecks(graph, again, widths);
    EXPECT_EQ(labels, again) << "the same again";
    EXPECT_EQ(necks, widths);
  }
}

// The second part has a lump of its cells within the first, which with it has 0.6 of all cells: much among
// three.
TEST(PartShape, no_part_gets_larger_than_is_reasonable) {
  const BodyMesh body = block(CellType::Quadrilateral4);
  const CellGraph graph = graphOf(body.mesh);
  for (const int parts : {2, 3}) {
    const std::vector<int> planted = labelled(body, [=](const Point& x) {
      const bool bar = x[0] > 0.9 && std::abs(x[1] - 0.5) < 1.0 / 12.0;
      const bool lump = x[0] > 0.5 && x[0] < 0.9 && std::abs(x[1] - 0.5) < 0.3;
      return lump || bar || x[0] > 1.3 ? 1 : x[0] < 0.1 && parts == 3 ? 2 : 0;
    });
    std::vector<int> labels = planted;
    std::vector<double> necks = neckWidths(graph, labels, parts);
    ASSERT_LT(necks[1], raggedNeck);
    const std::vector<double> before = necks;
    EXPECT_EQ(mendNecks(graph, labels, necks) == 0, parts == 3);
    EXPECT_EQ(labels == planted, parts == 3);
    EXPECT_EQ(necks == before, parts == 3);
  }
}

} // namespace test_part_shape
