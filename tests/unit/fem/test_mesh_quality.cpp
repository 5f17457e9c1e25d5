// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshQuality.hpp"

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Elasticity.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace test_mesh_quality {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

// Rounding in some dozens of operations with numbers of order one.
constexpr double roundoff = 1e-13;

const std::vector<CellType> types = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

// One cell with its nodes at the images of those of a square or brick of 2 × 2 (× 2), or of the corner of
// one.
fem::Mesh cellOf(CellType type, const std::function<Point(const Point&)>& map) {
  const fem::CellShape& shape = fem::shapeOf(type);
  fem::Mesh mesh;
  mesh.cellType = type;
  for (int i = 0; i < shape.nodes; ++i) {
    const Point x = map(shape.nodeCoordinates[static_cast<std::size_t>(i)]);
    mesh.coordinates.insert(mesh.coordinates.end(), x.begin(), x.begin() + shape.dimension);
    mesh.cells.push_back(i);
  }
  return mesh;
}

double qualityOf(CellType type, const std::function<Point(const Point&)>& map) {
  return fem::cellQualities(cellOf(type, map)).at(0);
}

double qualityOf(CellType type, const std::function<Point(const Point&)>& before,
                 const std::function<Point(const Point&)>& motion) {
  return fem::cellQualities(cellOf(type, before),
                            cellOf(type, [&](const Point& x) { return motion(before(x)); }))
      .at(0);
}

Point same(const Point& x) {
  return x;
}

fem::PlacedMesh block(CellType type) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {3, 2, 2};
  options.origin = {10.0, 20.0, 30.0};
  options.size = {3.0, 2.0, 2.0};
  fem::PlacedMesh placed = fem::StructuredBlock(options).subdomain(0);
  return placed;
}

fem::PlacedMesh moved(const fem::PlacedMesh& placed, const std::function<Point(const Point&)>& map) {
  fem::Mesh mesh = *placed.mesh;
  const auto d = static_cast<std::size_t>(mesh.dimension());
  for (int node = 0; node < mesh.numberOfNodes(); ++node) {
    const Point x = map(placed.position(node));
    for (std::size_t k = 0; k < d; ++k)
      mesh.coordinates[static_cast<std::size_t>(node) * d + k] = x[k] - placed.anchor[k];
  }
  fem::PlacedMesh result = placed;
  result.mesh = std::make_shared<const fem::Mesh>(mesh);
  return result;
}

} // namespace

// Rectangles and bricks are as good as cells get, whatever their sides; equilateral triangles, alone and as
// ends of wedges, and tetrahedra;
// the corner of a cube is a tetrahedron with the volume 1/6, and the largest product of the lengths of three
// edges that meet is 1 · √2 · √2: √2 · 6/6 / 2.
TEST(MeshQuality, of_regular_cells) {
  const auto flat = [](const Point& x) { return Point{1e3 * x[0], x[1], 0.1 * x[2]}; };
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Hexahedron8, CellType::Hexahedron27})
    EXPECT_NEAR(qualityOf(type, flat), 1.0, roundoff) << fem::shapeOf(type).name;
  const double root3 = std::sqrt(3.0);
  for (CellType type : {CellType::Triangle3, CellType::Triangle6}) {
    EXPECT_NEAR(qualityOf(type,
                          [&](const Point& x) {
                            return Point{x[0] + 0.5 * x[1], 0.5 * root3 * x[1], 0.0};
                          }),
                1.0, roundoff);
    // Right-angled: (2/√3) · 1/√2.
    EXPECT_NEAR(qualityOf(type, same), std::sqrt(2.0 / 3.0), roundoff);
  }
  for (CellType type : {CellType::Wedge6, CellType::Wedge15, CellType::Wedge18}) {
    EXPECT_NEAR(qualityOf(type,
                          [&](const Point& x) {
                            return Point{x[0] + 0.5 * x[1], 0.5 * root3 * x[1], 0.1 * x[2]};
                          }),
                1.0, roundoff);
    EXPECT_NEAR(qualityOf(type, same), std::sqrt(2.0 / 3.0), roundoff);
  }
  for (CellType type : {CellType::Tetrahedron4, CellType::Tetrahedron10}) {
    // Corners (0,0,0), (1,1,0), (0,1,1), (1,0,1), so ordered that the Jacobian is positive.
    EXPECT_NEAR(qualityOf(type,
                          [](const Point& x) {
                            return Point{x[0] + x[2], x[0] + x[1], x[1] + x[2]};
                          }),
                1.0, roundoff);
    EXPECT_NEAR(qualityOf(type, same), std::sqrt(0.5), roundoff);
  }
}

// A parallelogram has the sine of its angle; 0 where it is flat; and mirrored cells the negative of that.
TEST(MeshQuality, of_sheared_flat_and_inverted_cells) {
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Hexahedron8, CellType::Hexahedron27})
    EXPECT_NEAR(qualityOf(type,
                          [](const Point& x) {
                            return Point{x[0] + 2.0 * x[1], x[1], x[2]};
                          }),
                std::sqrt(0.2), roundoff)
        << fem::shapeOf(type).name;
  for (CellType type : types) {
    EXPECT_NEAR(qualityOf(type,
                          [](const Point& x) {
                            return Point{x[0], 0.0 * x[1], x[2]};
                          }),
                0.0, roundoff)
        << fem::shapeOf(type).name;
    EXPECT_NEAR(qualityOf(type, [](const Point&) { return Point{}; }), 0.0, roundoff)
        << fem::shapeOf(type).name;
    EXPECT_NEAR(qualityOf(type,
                          [](const Point& x) {
                            return Point{-x[0], x[1], x[2]};
                          }),
                -qualityOf(type, same), roundoff)
        << fem::shapeOf(type).name;
  }
  // One corner pushed across the diagonal of the square: det J there is (−0.5 − 0.5)/4, the mean (4 − 3)/4.
  EXPECT_LT(qualityOf(CellType::Quadrilateral4,
                      [](const Point& x) {
                        return x[0] > 0.0 && x[1] > 0.0 ? Point{-0.5, -0.5, 0.0} : x;
                      }),
            0.0);
}

// The node amid a side, moved along it to a quarter, makes det J zero at the corner, where no angle changes;
// moved inwards by h, it turns the sides at the corners.
TEST(MeshQuality, of_curved_cells) {
  for (CellType type : {CellType::Quadrilateral9, CellType::Triangle6}) {
    const bool isSquare = type == CellType::Quadrilateral9;
    const double end = isSquare ? -1.0 : 0.0, middle = isSquare ? 0.0 : 0.5;
    const auto bent = [&](double along, double inwards) {
      return qualityOf(type, [=](const Point& x) {
        return x[0] == middle && x[1] == end ? Point{x[0] + along, x[1] + inwards, 0.0} : x;
      });
    };
    const double quarter = 0.5 * (middle - end); // moved on: det J < 0
    EXPECT_GT(bent(0.9 * quarter, 0.0), 0.0);
    EXPECT_NEAR(bent(quarter, 0.0), 0.0, roundoff);
    EXPECT_LT(bent(1.1 * quarter, 0.0), 0.0);
    EXPECT_LT(bent(0.0, 0.2), bent(0.0, 0.1));
    EXPECT_GT(bent(0.0, 0.2), 0.0);
    EXPECT_LT(bent(0.0, 0.2), 0.95 * bent(0.0, 0.0));
  }
  // Its parabola −1 + h(1 − x²) has the slope 2h at the corner (−1, −1); the other side stands upright, of
  // length 1 there: the cosine of that angle, beside which det J / mean = 1 / (1 − h/3) counts nothing.
  const double h = 0.2;
  EXPECT_NEAR(qualityOf(CellType::Quadrilateral9,
                        [&](const Point& x) {
                          return Point{x[0], x[1] + h * (1.0 - x[0] * x[0]), 0.0};
                        }),
              1.0 / std::hypot(1.0, 2.0 * h), roundoff);
  // Outwards instead, y sinks by h (1 − x²)(y² − y)/2: the area grows to 4 + 4h/3, while amid the other side
  // det J is 1 − h/2 without any angle. The same of that as a motion of the square.
  const double out = 0.3;
  const auto bulge = [&](const Point& x) {
    return Point{x[0], x[1] - out * (1.0 - x[0] * x[0]) * 0.5 * (x[1] * x[1] - x[1]), 0.0};
  };
  const double left = (1.0 - out / 2.0) / (1.0 + out / 3.0);
  EXPECT_NEAR(qualityOf(CellType::Quadrilateral9, bulge), left, roundoff);
  EXPECT_NEAR(qualityOf(CellType::Quadrilateral9, same, bulge), left, roundoff);
}

// Cells with a quality above zero are such as matrices are assembled of: random cells, among them those that
// are inverted at a point of the matrices' rule alone, between the nodes.
TEST(MeshQuality, above_zero_means_that_matrices_are_assembled) {
  constexpr int cells = 20000;
  std::mt19937 generator(3);
  const auto random = [&] { return static_cast<double>(generator()) / 4294967296.0 - 0.5; };
  for (CellType type : types) {
    const fem::CellShape& shape = fem::shapeOf(type);
    fem::Mesh mesh;
    mesh.cellType = type;
    for (int c = 0; c < cells; ++c) {
      const double size = 4.0 * c / cells;
      for (const Point& x : shape.nodeCoordinates) {
        for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimension); ++d)
          mesh.coordinates.push_back(x[d] + size * random());
        mesh.cells.push_back(static_cast<int>(mesh.cells.size()));
      }
    }
    const std::vector<double> qualities = fem::cellQualities(mesh);
    const fem::ReferenceElement element(type, fem::stiffnessDegree(type));
    fem::CellIntegrator cell(mesh, element);
    int refused = 0, good = 0;
    for (int c = 0; c < cells; ++c) {
      const bool isAbove = qualities[static_cast<std::size_t>(c)] > 0.0;
      const bool isRefused = !numericalErrorOf([&] { cell.turnTo(c); }).empty();
      EXPECT_FALSE(isAbove && isRefused) << shape.name << " " << c;
      refused += isRefused;
      good += isAbove;
    }
    EXPECT_GE(refused, cells / 20) << shape.name;
    EXPECT_GE(good, cells / 20) << shape.name;
  }
}

// Similar cells are as good as before; a shear by γ leaves 1/(1 + γ²/2) in the plane and (1 + γ²/3)^(−3/2) in
// space, a share s of the height 2s/(1 + s²), and in space, with ‖F‖² = 2 + s², s (3/(2 + s²))^(3/2):
// whatever the cell was.
TEST(MeshQuality, of_motions) {
  const auto before = [](const Point& x) {
    return Point{5.0 * x[0] + 0.4 * x[1] + 0.1 * x[2], 0.3 * x[1] - 0.5 * x[0], 0.7 * x[2] + 0.1 * x[1]};
  };
  const double c = std::cos(0.7), s = std::sin(0.7), gamma = 1.5, share = 0.1;
  for (CellType type : types) {
    const std::string& name = fem::shapeOf(type).name;
    const bool isPlane = fem::shapeOf(type).dimension == 2;
    EXPECT_NEAR(
        qualityOf(
            type, before,
            [&](const Point& x) {
              return Point{3.0 * (c * x[0] - s * x[1]) + 1.0, 3.0 * (s * x[0] + c * x[1]), 3.0 * x[2] + 2.0};
            }),
        1.0, 10 * roundoff)
        << name;
    EXPECT_NEAR(qualityOf(type, before,
                          [&](const Point& x) {
                            return Point{x[0] + gamma * x[1], x[1], x[2]};
                          }),
                isPlane ? 1.0 / (1.0 + gamma * gamma / 2.0) : std::pow(1.0 + gamma * gamma / 3.0, -1.5),
                10 * roundoff)
        << name;
    const double flattened =
        isPlane ? 2.0 * share / (1.0 + share * share) : share * std::pow(3.0 / (2.0 + share * share), 1.5);
    for (double sign : {1.0, -1.0})
      EXPECT_NEAR(qualityOf(type, before,
                            [&](const Point& x) {
                              return Point{x[0], sign * share * x[1], x[2]};
                            }),
                  sign * flattened, 10 * roundoff)
          << name;
  }
  // All sides at a corner shorter by the same factor: the shape there stays, the size shrinks beside the
  // rest.
  const auto along = [](double x) { return x + 0.24 * (1.0 - x * x); }; // 1 − 0.48 … 1.48
  EXPECT_NEAR(qualityOf(CellType::Quadrilateral9, same,
                        [&](const Point& x) {
                          return Point{along(x[0]), along(x[1]), 0.0};
                        }),
              0.52 * 0.52, roundoff);
}

TEST(MeshQuality, the_worst_cell_is_named) {
  for (CellType type : {CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Hexahedron8}) {
    const fem::PlacedMesh before = block(type);
    const bool isPlane = before.mesh->dimension() == 2;
    EXPECT_NEAR(fem::worstCell(before).quality, 1.0, roundoff);
    EXPECT_EQ(fem::worstCell(before).cell, 0);
    // One node of the boundary is pushed far into the fifth cell.
    const Point from = {11.0, 22.0, isPlane ? 30.0 : 32.0}, to = {11.8, 20.7, isPlane ? 30.0 : 32.0};
    const fem::PlacedMesh after = moved(before, [&](const Point& x) { return x == from ? to : x; });
    for (const fem::CellQuality& worst : {fem::worstCell(after), fem::worstCell(before, after)}) {
      EXPECT_TRUE(worst.isTangled());
      const std::vector<double> qualities = fem::cellQualities(*after.mesh);
      EXPECT_LE(qualities.at(static_cast<std::size_t>(worst.cell)), 0.0);
      const int* nodes = after.mesh->cell(worst.cell);
      bool hasNode = false;
      for (int i = 0; i < after.mesh->nodesPerCell(); ++i)
        hasNode = hasNode || before.position(nodes[i]) == from;
      EXPECT_TRUE(hasNode) << worst.cell;
      // Absolute, and in one of the cells that have the node.
      EXPECT_GE(worst.place[0], 10.0);
      EXPECT_LE(worst.place[0], 12.0);
      EXPECT_GE(worst.place[1], 20.0);
      EXPECT_LE(worst.place[1], 22.0);
    }
    const std::vector<double> all = fem::cellQualities(*after.mesh);
    EXPECT_EQ(fem::worstCell(after).quality, *std::min_element(all.begin(), all.end()));
  }
  fem::CellQuality quality;
  quality.cell = 12;
  quality.place = {0.5, 0.25, 0.0};
  quality.quality = -0.1;
  EXPECT_EQ(fem::textOf(block(CellType::Quadrilateral4), quality),
            "cell 12 (quadrilateral of 4 nodes) at (0.500000, 0.250000, 0.000000): quality -1.00e-01");
}

// Only what has got worse counts between two meshes: a cell that was skew before is not the one.
TEST(MeshQuality, motions_are_judged_by_what_they_change) {
  const fem::PlacedMesh before =
      moved(block(CellType::Quadrilateral4), [](const Point& x) { // the cells on the right are skew
        return x[0] > 12.5 ? Point{x[0], x[1] + 3.0, x[2]} : x;
      });
  const fem::PlacedMesh after = moved(before, [](const Point& x) { // those on the left a little
    return x[0] < 10.5 ? Point{x[0], x[1] + 0.5, x[2]} : x;
  });
  EXPECT_EQ(fem::worstCell(after).cell % 3, 2);
  const fem::CellQuality harmed = fem::worstCell(before, after);
  EXPECT_EQ(harmed.cell % 3, 0);
  EXPECT_NEAR(harmed.quality, 1.0 / (1.0 + 0.25 / 2.0), 100 * roundoff);
  const std::vector<double> all = fem::cellQualities(*before.mesh, *after.mesh);
  EXPECT_NEAR(all[1], 1.0, 100 * roundoff);
  EXPECT_NEAR(all[2], 1.0, 100 * roundoff);
}

TEST(MeshQuality, of_none_and_of_what_is_no_number) {
  fem::PlacedMesh empty = block(CellType::Triangle3);
  fem::Mesh mesh = *empty.mesh;
  mesh.cells.clear();
  empty.mesh = std::make_shared<const fem::Mesh>(mesh);
  EXPECT_EQ(fem::worstCell(empty).cell, -1);
  EXPECT_FALSE(fem::worstCell(empty).isTangled());
  const fem::PlacedMesh good = block(CellType::Triangle3);
  for (double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const fem::PlacedMesh bad = moved(good, [&](const Point& x) {
      return x[0] > 12.5 && x[1] > 21.5 ? Point{value, 0.0, 0.0} : x;
    });
    for (const fem::CellQuality& worst : {fem::worstCell(bad), fem::worstCell(good, bad)}) {
      EXPECT_TRUE(worst.isTangled());
      EXPECT_EQ(worst.quality, -std::numeric_limits<double>::infinity());
      EXPECT_GE(worst.cell, 10); // those of the last square
    }
  }
  EXPECT_THROW(fem::cellQualities(*good.mesh, mesh), InternalError);
  const fem::PlacedMesh mirrored = moved(good, [](const Point& x) { return Point{-x[0], x[1], x[2]}; });
  EXPECT_THROW(fem::worstCell(mirrored, good), InternalError);
}

} // namespace test_mesh_quality
