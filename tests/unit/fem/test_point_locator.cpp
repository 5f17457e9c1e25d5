// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellBasis.hpp"
#include "Harmos_ErrorNorms.hpp"
#include "Harmos_ReferenceElement.hpp"
#include "Harmos_SizeField.hpp"
#include "Harmos_TestBodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace test_point_locator {

using namespace Harmos;
using namespace Harmos::fem;

namespace {

const std::vector<CellType> volumes = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

std::vector<Point> positions(const Mesh& mesh) {
  std::vector<Point> nodes;
  for (int node = 0; node < mesh.numberOfNodes(); ++node)
    nodes.push_back(mesh.local(node));
  return nodes;
}

PointLocator locatorOf(const Mesh& mesh) {
  return {mesh.cellType, positions(mesh), mesh.cells};
}

using Field = std::function<Point(const Point&)>;

std::vector<double> nodal(const Mesh& mesh, const Field& field) {
  std::vector<double> values;
  for (const Point& x : positions(mesh))
    for (int d = 0; d < mesh.dimension(); ++d)
      values.push_back(field(x)[static_cast<std::size_t>(d)]);
  return values;
}

// Of a field on one mesh against a field on another, by the rule of the first.
SquaredErrors difference(const Mesh& mesh, const std::vector<double>& u, const Mesh& other,
                         const std::vector<double>& v, const Elasticity& elasticity) {
  const PointLocator locator = locatorOf(other);
  int hint = -1;
  return squaredErrors(mesh, {}, errorDegree(mesh.cellType), mesh.dimension(), u, elasticEnergy(elasticity),
                       [&](int, int, const Point& x) {
                         const PointLocator::Place place = locator.nearest(x, hint);
                         hint = place.cell;
                         return locator.valueAndGradient(place, v, mesh.dimension());
                       });
}

Elasticity twoMaterials(int dimension) {
  Elasticity elasticity;
  elasticity.kinematics = dimension == 2 ? Kinematics::PlaneStrain : Kinematics::Solid;
  elasticity.materials = {Material::isotropic(2.0, 0.3), Material::isotropic(5.0, 0.2)};
  return elasticity;
}

Mesh square(CellType type, int n) {
  StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {n, n, n};
  return *StructuredBlock(options).subdomain(0).mesh;
}

} // namespace

TEST(BoxTree, finds_what_comparing_all_boxes_finds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  std::vector<Box> boxes;
  for (int k = 0; k < 300; ++k) {
    const Point low = {number(random), number(random), k % 3 == 0 ? 0.5 : number(random)};
    const double size = k % 50 == 0 ? 0.5 : 0.05;
    boxes.push_back({low, {low[0] + size * number(random), low[1] + size, low[2]}});
  }
  const BoxTree tree(boxes);
  for (const Box& box : boxes) {
    std::vector<int> expected;
    for (std::size_t k = 0; k < boxes.size(); ++k)
      if (boxes[k].touches(widened(box, 0.01)))
        expected.push_back(static_cast<int>(k));
    EXPECT_EQ(tree.touching(widened(box, 0.01)), expected);
  }
  EXPECT_TRUE(BoxTree({}).touching({{0, 0, 0}, {1, 1, 1}}).empty());
}

TEST(CellBasis, is_that_of_the_elements) {
  const std::vector<Point> places = {{0.1, 0.2, 0.3}, {-0.4, 0.15, 0.9}, {0.0, 1.0, 0.0}};
  for (CellType type : volumes) {
    const auto values = basisValues(type, places);
    const auto gradients = basisGradients(type, places);
    for (std::size_t q = 0; q < places.size(); ++q) {
      CellBasis basis;
      cellBasis(shapeOf(type), places[q], basis);
      for (std::size_t i = 0; i < values[q].size(); ++i) {
        EXPECT_NEAR(basis.values[i], values[q][i], 1e-14) << shapeOf(type).name;
        for (std::size_t d = 0; d < static_cast<std::size_t>(shapeOf(type).dimension); ++d)
          EXPECT_NEAR(basis.gradients[i][d], gradients[q][i][d], 1e-14) << shapeOf(type).name;
      }
    }
  }
}

TEST(PointLocator, finds_points_of_every_cell_again) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  for (CellType type : volumes) {
    const Mesh mesh = testBody(type, 3).mesh; // bent
    const PointLocator locator = locatorOf(mesh);
    for (int c = 0; c < mesh.numberOfCells(); c += 2) {
      PointLocator::Place place;
      place.cell = c;
      for (std::size_t d = 0; d < static_cast<std::size_t>(mesh.dimension()); ++d)
        place.reference[d] = shapeOf(type).isSimplex || (shapeOf(type).isWedge && d < 2)
                                 ? number(random) / 3
                                 : 2 * number(random) - 1;
      const Point x = locator.position(place);
      for (int hint : {-1, c, 0}) {
        const PointLocator::Place found = locator.nearest(x, hint);
        EXPECT_EQ(found.cell, c) << shapeOf(type).name;
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(found.reference[d], place.reference[d], 1e-11) << shapeOf(type).name;
        EXPECT_LE(found.distance, 1e-12);
      }
    }
  }
}

TEST(PointLocator, point_outside_gets_the_nearest_place) {
  for (CellType type : {CellType::Triangle3, CellType::Quadrilateral4, CellType::Quadrilateral9}) {
    const PointLocator locator = locatorOf(square(type, 5));
    // Beyond a side, beyond a corner, far away.
    for (const auto& [x, nearest] :
         std::vector<std::pair<Point, Point>>{{{0.37, 1.2, 0.0}, {0.37, 1.0, 0.0}},
                                              {{-0.1, -0.2, 0.0}, {0.0, 0.0, 0.0}},
                                              {{7.0, 0.51, 0.0}, {1.0, 0.51, 0.0}}}) {
      const PointLocator::Place place = locator.nearest(x);
      const Point found = locator.position(place);
      for (std::size_t d = 0; d < 2; ++d)
        EXPECT_NEAR(found[d], nearest[d], 1e-12) << shapeOf(type).name;
      EXPECT_NEAR(place.distance, std::hypot(x[0] - nearest[0], x[1] - nearest[1]), 1e-12);
    }
  }
}

TEST(PointLocator, surfaces_in_space_and_lines_in_the_plane) {
  // A square of side two at z = 1 in two triangles; a parabola of one line of three nodes.
  const PointLocator facets(CellType::Triangle3, {{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}},
                            {0, 1, 2, 0, 2, 3});
  const PointLocator::Place above = facets.nearest({0.5, 1.5, 3.0});
  EXPECT_EQ(above.cell, 1);
  EXPECT_NEAR(above.distance, 2.0, 1e-12);
  EXPECT_NEAR(facets.value(above, {0, 2, 4, 2}, 1)[0], 2.0, 1e-12); // x + y
  const PointLocator line(CellType::Line3, {{-1, 1, 0}, {1, 1, 0}, {0, 0, 0}}, {0, 1, 2});
  for (const Point& x : {Point{0.1, -0.1, 0.0}, Point{0.9, 0.75, 0.0}, Point{-1.2, 1.0, 0.0}}) {
    double least = 10.0;
    for (int k = -10000; k <= 10000; ++k)
      least = std::min(least, std::hypot(x[0] - 1e-4 * k, x[1] - 1e-8 * k * k));
    EXPECT_NEAR(line.nearest(x).distance, least, 1e-7); // of second order in the step of the search
  }
}

TEST(ErrorNorms, linear_fields_agree_on_any_two_meshes) {
  for (CellType type : volumes) {
    const int dimension = shapeOf(type).dimension;
    const Field linear = [](const Point& x) {
      return Point{1.0 + x[0] - 2.0 * x[1], 0.3 * x[1] + x[2], x[0] - x[2]};
    };
    const Mesh first = square(type, 3);
    const Mesh second = square(type, 4);
    Elasticity elasticity = twoMaterials(dimension);
    const SquaredErrors errors =
        difference(first, nodal(first, linear), second, nodal(second, linear), elasticity);
    // Rounding of gradients: eps times values of order one, over h = 1/4; squared.
    EXPECT_LE(errors.energy, 1e-24) << shapeOf(type).name;
    EXPECT_LE(errors.l2, 1e-26) << shapeOf(type).name;
    // Against nothing the norm itself: constant strains.
    const SquaredErrors whole = difference(first, nodal(first, linear), second,
                                           nodal(second, [](const Point&) { return Point{}; }), elasticity);
    std::array<Point, 3> g = {{{1.0, -2.0, 0.0}, {0.0, 0.3, 1.0}, {1.0, 0.0, -1.0}}};
    if (dimension == 2)
      g = {{{1.0, -2.0, 0.0}, {0.0, 0.3, 0.0}, {}}};
    EXPECT_NEAR(whole.energy, elasticEnergy(elasticity)(0, g), 1e-12 * whole.energy);
  }
}

TEST(ErrorNorms, quadratic_field_against_its_linear_interpolant) {
  // u = x², interpolated with spacing h: u' − u_h' is 2 times the distance from the middle of the cell,
  // ∫(u' − u_h')² = h²/3 and ∫(u − u_h)² = h⁴/30 over the unit square (or cube).
  for (int n : {4, 8}) {
    const double h = 1.0 / n;
    const Field quadratic = [](const Point& x) { return Point{x[0] * x[0], 0.0, 0.0}; };
    for (bool space : {false, true}) {
      const CellType fine = space ? CellType::Hexahedron27 : CellType::Quadrilateral9;
      const CellType coarse = space ? CellType::Hexahedron8 : CellType::Quadrilateral4;
      // Cells of the quadratic mesh lie within those of the linear one: quadrature is exact.
      const Mesh reference = square(fine, 2 * n), linear = square(coarse, n);
      const Elasticity elasticity = twoMaterials(space ? 3 : 2);
      const SquaredErrors errors =
          difference(reference, nodal(reference, quadratic), linear, nodal(linear, quadratic), elasticity);
      const double modulus = elasticity.materials[0].stiffness(elasticity.kinematics)[0][0];
      EXPECT_NEAR(errors.energy, modulus * h * h / 3.0, 1e-10 * h * h);
      EXPECT_NEAR(errors.l2, std::pow(h, 4) / 30.0, 1e-12);
    }
  }
}

TEST(ErrorNorms, membranes) {
  const Mesh reference = square(CellType::Quadrilateral4, 8), coarse = square(CellType::Quadrilateral4, 4);
  const auto values = [](const Mesh& mesh) {
    std::vector<double> u;
    for (const Point& x : positions(mesh))
      u.push_back(x[0] * x[0]);
    return u;
  };
  const PointLocator locator = locatorOf(coarse);
  const SquaredErrors errors =
      squaredErrors(reference, {}, errorDegree(reference.cellType), 1, values(reference), membraneEnergy(),
                    [&](int, int, const Point& x) {
                      return locator.valueAndGradient(locator.nearest(x), values(coarse), 1);
                    });
  // The interpolants on 8 and on 4 cells differ by hats of height (1/8)² at the middles: slope ±1/8.
  EXPECT_NEAR(errors.energy, 1.0 / 64.0, 1e-13);
  EXPECT_NEAR(errors.l2, std::pow(1.0 / 64.0, 2) / 3.0, 1e-15);
}

// Against a look at all places, in space, in a plane and on a line, with places that are equal.
TEST(SizeField, nearest_place_and_growth) {
  std::minstd_rand random(7);
  const auto number = [&random] { return static_cast<double>(random()) / std::minstd_rand::max(); };
  const auto distance = [](const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  };
  for (std::size_t dimension = 1; dimension <= 3; ++dimension) {
    std::vector<Point> places;
    std::vector<double> sizes;
    for (int k = 0; k < 300; ++k) {
      Point place{};
      for (std::size_t d = 0; d < dimension; ++d)
        place[d] = number() * number();
      places.push_back(k % 10 == 9 ? places.back() : place);
      sizes.push_back(std::pow(10.0, -3.0 * number()));
    }
    const fem::SizeField field(places, sizes);
    for (std::size_t i = 0; i < places.size(); ++i) {
      double grown = std::numeric_limits<double>::max();
      for (std::size_t j = 0; j < places.size(); ++j)
        grown = std::min(grown, std::max(sizes[j], 0.75 * sizes[j] + 0.5 * distance(places[i], places[j])));
      // Rounded before and after to half a step of 2^(1/8).
      EXPECT_GE(field(places[i]), grown * std::pow(2.0, -0.126));
      EXPECT_LE(field(places[i]), grown / 0.9 * std::pow(2.0, 0.126));
      EXPECT_NEAR(std::remainder(8.0 * std::log2(field(places[i])), 1.0), 0.0, 1e-12);
    }
    for (int k = 0; k < 200; ++k) {
      const Point at = {2.0 * number() - 0.5, 2.0 * number() - 0.5, number()};
      double least = std::numeric_limits<double>::max();
      for (const Point& place : places)
        least = std::min(least, distance(at, place));
      EXPECT_DOUBLE_EQ(distance(at, places[field.nearest(at)]), least);
      EXPECT_EQ(field(at), field(places[field.nearest(at)]));
    }
  }
}

} // namespace test_point_locator
