// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <gtest/gtest.h>

namespace test_surface {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Point polar(const Point& x) {
  return {x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), x[2]};
}

double total(const std::vector<double>& values) {
  double sum = 0.0;
  for (double value : values)
    sum += value;
  return sum;
}

} // namespace

TEST(Facet, basis_is_that_of_the_elements) {
  for (CellType type : {CellType::Line2, CellType::Line3, CellType::Triangle3, CellType::Triangle6,
                        CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Quadrilateral8}) {
    const std::vector<Point> places = {{0.1, 0.2, 0.0}, {0.7, 0.15, 0.0}, {0.0, 1.0, 0.0}};
    const auto values = fem::basisValues(type, places);
    const auto gradients = fem::basisGradients(type, places);
    for (std::size_t q = 0; q < places.size(); ++q) {
      const FacetBasis basis = facetBasis(type, {places[q][0], places[q][1]});
      for (std::size_t k = 0; k < values[q].size(); ++k) {
        EXPECT_NEAR(basis.values[k], values[q][k], 1e-15);
        EXPECT_NEAR(basis.gradients[k][0], gradients[q][k][0], 1e-14);
        EXPECT_NEAR(basis.gradients[k][1], gradients[q][k][1], 1e-14);
      }
    }
  }
}

// The carriers reproduce what the basis does, from their coefficients; on facets that are covered in part
// they are not negative, on whole triangles of six nodes all have areas.
TEST(Facet, carriers_span_what_the_basis_spans) {
  for (CellType type : {CellType::Line2, CellType::Line3, CellType::Triangle3, CellType::Triangle6,
                        CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Quadrilateral8})
    for (const bool isPartial : {false, true}) {
      std::array<double, 4> shares{};
      if (fem::shapeOf(type).order == 2)
        shares = {0.1, 0.25, 0.0, 0.2}; // whole, beside others that are not
      if (isPartial && fem::shapeOf(type).order == 2)
        shares.fill(Carriers::partialShare(type));
      const Carriers carriers(type, shares, isPartial && fem::shapeOf(type).order == 2);
      const auto size = static_cast<std::size_t>(fem::shapeOf(type).nodes);
      for (const FacetPlace& place : {FacetPlace{0.1, 0.2}, FacetPlace{0.7, 0.15}, FacetPlace{0.0, 1.0}}) {
        const FacetBasis basis = facetBasis(type, place);
        const auto values = carriers.values(basis.values);
        std::array<double, maxFacetNodes> again{};
        double sum = 0.0;
        for (std::size_t k = 0; k < size; ++k) {
          if (isPartial)
            EXPECT_GE(values[k], -1e-16);
          sum += values[k];
          for (const auto& [i, weight] : carriers.coefficient(k))
            again[i] += weight * values[k];
        }
        EXPECT_NEAR(sum, 1.0, 1e-15);
        for (std::size_t k = 0; k < size; ++k)
          EXPECT_NEAR(again[k], basis.values[k], 1e-15) << fem::shapeOf(type).name << " " << k;
      }
    }
  // Corners have 2/3 of the share of a third of the area.
  std::array<double, 4> shares{};
  shares.fill(Carriers::usualShare(CellType::Triangle6));
  const Carriers carriers(CellType::Triangle6, shares, false);
  const fem::Quadrature rule = fem::quadratureOn(CellType::Triangle6, 2);
  std::array<double, maxFacetNodes> areas{};
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const auto values =
        carriers.values(facetBasis(CellType::Triangle6, {rule.points[q][0], rule.points[q][1]}).values);
    for (std::size_t k = 0; k < 6; ++k)
      areas[k] += rule.weights[q] * values[k];
  }
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(areas[k], 0.5 * (k < 3 ? 2.0 * shares[0] : 1.0 - 2.0 * shares[0]) / 3.0, 1e-15);
}

TEST(Surface, sides_of_a_rectangle_look_outward) {
  const std::map<std::string, Point> outward = {
      {"left", {-1, 0, 0}}, {"right", {1, 0, 0}}, {"bottom", {0, -1, 0}}, {"top", {0, 1, 0}}};
  for (CellType type :
       {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4, CellType::Quadrilateral9}) {
    const auto body = block(type, {1, 2, 0}, {3, 2, 0}, {2, 2, 1}, {3, 1, 1}, 7);
    for (const auto& [set, normal] : outward) {
      const Surface surface = surfaceOf(body, set);
      EXPECT_EQ(surface.dimension, 2);
      EXPECT_NEAR(total(surface.areas), normal[0] == 0.0 ? 3.0 : 2.0, 1e-14);
      for (std::size_t i = 0; i < surface.numbers.size(); ++i)
        EXPECT_LT(norm(difference(surface.normals[i], normal)), 1e-15) << set;
    }
  }
}

TEST(Surface, sides_of_a_brick_look_outward) {
  const std::map<std::string, Point> outward = {{"left", {-1, 0, 0}},   {"right", {1, 0, 0}},
                                                {"front", {0, -1, 0}},  {"back", {0, 1, 0}},
                                                {"bottom", {0, 0, -1}}, {"top", {0, 0, 1}}};
  for (CellType type : {CellType::Tetrahedron4, CellType::Tetrahedron10, CellType::Hexahedron8,
                        CellType::Hexahedron27, CellType::Hexahedron20, CellType::Wedge15}) {
    const auto body = block(type, {1, 2, 0}, {3, 2, 1}, {2, 1, 2}, {1, 2, 1}, 7);
    for (const auto& [set, normal] : outward) {
      const Surface surface = surfaceOf(body, set);
      EXPECT_EQ(surface.dimension, 3);
      EXPECT_NEAR(total(surface.areas), 6.0 / std::abs(normal[0] * 3 + normal[1] * 2 + normal[2]), 1e-13);
      for (std::size_t i = 0; i < surface.numbers.size(); ++i)
        EXPECT_LT(norm(difference(surface.normals[i], normal)), 1e-15) << set;
    }
  }
}

TEST(Surface, areas_are_integrals_of_the_basis_functions) {
  // Of lines of three nodes 1/6, 4/6, 1/6 of the length; of triangles of six nodes 0 and a third of the area.
  const Surface line =
      surfaceOf(block(CellType::Quadrilateral9, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}), "top");
  const std::vector<double> expected = {1.0 / 12, 4.0 / 12, 2.0 / 12, 4.0 / 12, 1.0 / 12};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(line.areas[i], expected[i], 1e-15);
  const Surface six =
      surfaceOf(block(CellType::Tetrahedron10, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}), "top");
  const std::vector<double> tributary = tributaryAreas(six);
  EXPECT_NEAR(total(six.areas), 1.0, 1e-14);
  EXPECT_NEAR(total(tributary), 1.0, 1e-14);
  for (std::size_t i = 0; i < six.areas.size(); ++i) {
    const Point& x = six.positions[i];
    const bool isCorner = std::abs(x[0] - 0.5) > 0.1 && std::abs(x[1] - 0.5) > 0.1;
    if (isCorner)
      EXPECT_NEAR(six.areas[i], 0.0, 1e-15);
    EXPECT_GT(tributary[i], 0.04); // at least the third of one of the eight pieces of the square
  }
}

// What chords leave out of an arc, R(1 − cos(θ/2)), to the next order; nothing in the plane or with three
// nodes.
TEST(Surface, sagitta_is_that_of_arcs) {
  const double radius = 2.0, angle = 1.0;
  const Map bend = [&](const Point& x) { return polar({1.0 + x[1], angle * x[0], 0.0}); };
  for (int edges : {4, 8, 16}) {
    const auto body =
        block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {edges, 1, 1}, 0, bend);
    const double exact = radius * (1.0 - std::cos(0.5 * angle / edges));
    EXPECT_NEAR(sagitta(surfaceOf(body, "top")), exact, 0.02 * exact);
    EXPECT_EQ(sagitta(surfaceOf(body, "left")), 0.0);
  }
  EXPECT_EQ(sagitta(surfaceOf(
                block(CellType::Quadrilateral9, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {4, 1, 1}, 0, bend), "top")),
            0.0);
}

TEST(Surface, does_not_depend_on_the_decomposition) {
  const Map bend = [](const Point& x) {
    return Point{x[0] + 0.1 * x[1] * x[1], x[1], x[2] + 0.2 * x[0] * x[1]};
  };
  for (CellType type :
       {CellType::Hexahedron8, CellType::Tetrahedron10, CellType::Hexahedron27, CellType::Hexahedron20}) {
    const Surface whole = surfaceOf(block(type, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {6, 4, 2}, 5, bend), "top");
    const Surface parts = surfaceOf(block(type, {0, 0, 0}, {1, 1, 1}, {3, 2, 1}, {2, 2, 2}, 5, bend), "top");
    ASSERT_EQ(whole.numbers, parts.numbers);
    ASSERT_EQ(whole.facets.size(), parts.facets.size());
    EXPECT_EQ(whole.facets, parts.facets);
    for (std::size_t i = 0; i < whole.numbers.size(); ++i) {
      // Positions differ by the rounding of another anchor.
      EXPECT_LT(norm(difference(whole.positions[i], parts.positions[i])), 1e-15);
      EXPECT_LT(norm(difference(whole.normals[i], parts.normals[i])), 1e-13);
      EXPECT_NEAR(whole.areas[i], parts.areas[i], 1e-15);
    }
  }
}

TEST(Surface, normals_are_weighted_by_the_area_of_facets) {
  // Facets from (0, 1) to (1, 1) and on to (4, 5): lengths 1 and 5.
  const Map bend = [](const Point& x) {
    const double beyond = std::max(0.0, x[0] - 1.0);
    return Point{x[0] + 2.0 * beyond, x[1] + 4.0 * beyond, 0.0};
  };
  const Surface top =
      surfaceOf(block(CellType::Quadrilateral4, {0, 0, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}, 0, bend), "top");
  EXPECT_LT(norm(difference(top.normals[0], {0, 1, 0})), 1e-15);
  EXPECT_LT(norm(difference(top.normals[1], {-std::sqrt(0.5), std::sqrt(0.5), 0})),
            1e-15); // (0, 1) + (−4, 3)
  EXPECT_LT(norm(difference(top.normals[2], {-0.8, 0.6, 0})), 1e-15);
}

TEST(Surface, does_not_depend_on_the_order_of_the_subdomains) {
  // Thirds and odd anchors: copies of a node differ by rounding.
  const auto body = block(CellType::Hexahedron8, {0.1, 0.2, 0.3}, {1.1, 1.3, 1}, {7, 5, 1}, {3, 3, 1});
  auto meshes = share(body);
  const Surface one = gather(meshes, "top", "top");
  std::reverse(meshes.begin(), meshes.end());
  const Surface other = gather(meshes, "top", "top");
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.normals, other.normals);
  EXPECT_EQ(one.areas, other.areas);
}

TEST(Surface, normals_of_an_arc_are_radial_where_facets_lie_to_both_sides) {
  const auto ring = block(CellType::Quadrilateral9, {1, 0, 0}, {1, 1.5, 0}, {1, 2, 1}, {1, 4, 1}, 0, polar);
  const Surface inner = surfaceOf(ring, "left");
  // A parabola through three points of an arc of angle h = 1.5/8 has the length of the arc but for O(h⁵).
  EXPECT_NEAR(total(inner.areas), 1.5, 1e-5);
  for (std::size_t i = 1; i + 1 < inner.numbers.size(); ++i)
    EXPECT_LT(norm(sum(inner.normals[i], inner.positions[i])), 1e-12); // by symmetry
  const NormalField field = [](const Point& x) { return scaled(-3.0, x); };
  const Surface given = surfaceOf(ring, "left", field);
  for (std::size_t i = 0; i < given.numbers.size(); ++i)
    EXPECT_LT(norm(sum(given.normals[i], given.positions[i])), 1e-14);
}

TEST(Surface, an_edge_between_two_parts_has_a_normal_in_each) {
  const auto body = block(CellType::Hexahedron8, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {2, 2, 2});
  const Surface top = surfaceOf(body, "top"), right = surfaceOf(body, "right");
  const long long shared = 2 + 3 * 1 + 9 * 2; // at (1, 0.5, 1)
  const auto normalIn = [&](const Surface& surface) {
    const auto place = std::find(surface.numbers.begin(), surface.numbers.end(), shared);
    return surface.normals[static_cast<std::size_t>(place - surface.numbers.begin())];
  };
  EXPECT_LT(norm(difference(normalIn(top), {0, 0, 1})), 1e-15);
  EXPECT_LT(norm(difference(normalIn(right), {1, 0, 0})), 1e-15);
}

TEST(Surface, what_is_no_surface_is_refused_on_all_ranks) {
  const auto body = block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {2, 1, 1}, {2, 2, 1});
  const std::string empty = messageOf([&] { surfaceOf(body, "lid"); });
  EXPECT_TRUE(contains(empty, "surface body/lid: the part \"lid\" has no sides of cells")) << empty;

  // Either subdomain brings its side of the interface between them.
  auto both = share(body);
  for (fem::PlacedMesh& mesh : both)
    for (const fem::Side& side : fem::boundarySides(*mesh.mesh))
      mesh.sides["all"].push_back(side);
  const std::string crossing = messageOf([&] { gather(both, "all", "body/all"); });
  EXPECT_TRUE(contains(crossing, "body/all: not a manifold: 4 facets meet at the node at (0.500000, "
                                 "0.000000, 0.000000), more than two"))
      << crossing;

  auto twice = share(body);
  for (fem::PlacedMesh& mesh : twice)
    if (mesh.sides.count("right"))
      mesh.sides["right"].push_back(mesh.sides["right"].back());
  const std::string repeated = messageOf([&] { gather(twice, "right", "body/right"); });
  EXPECT_TRUE(contains(repeated, "not a manifold")) << repeated;

  const auto brick = block(CellType::Hexahedron8, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  auto same = share(brick);
  for (fem::PlacedMesh& mesh : same)
    mesh.sides["top"].push_back(mesh.sides["top"].front());
  const std::string again = messageOf([&] { gather(same, "top", "brick/top"); });
  EXPECT_TRUE(contains(again, "2 facets meet at the edge at")) << again;
  EXPECT_TRUE(contains(again, "as duplicates")) << again;

  auto mixed = share(body);
  for (const fem::PlacedMesh& mesh :
       share(block(CellType::Quadrilateral9, {2, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1}, 100)))
    mixed.push_back(mesh);
  const std::string types = messageOf([&] { gather(mixed, "top", "body/top"); });
  EXPECT_TRUE(contains(types, "line of 2 nodes and line of 3 nodes")) << types;
}

TEST(Surface, degenerate_geometry_is_refused_on_all_ranks) {
  const Map collapse = [](const Point& x) { return Point{x[0] * (1.0 - x[1]), x[1], 0.0}; };
  const std::string flat = messageOf([&] {
    surfaceOf(block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1}, 0, collapse),
              "top");
  });
  EXPECT_TRUE(contains(flat, "body/top: the facet at (0.000000, 1.000000, 0.000000) has zero area")) << flat;

  const Map fold = [](const Point& x) { return Point{std::abs(x[0]), x[1], 0.0}; };
  const std::string folded = messageOf([&] {
    surfaceOf(block(CellType::Quadrilateral4, {-1, 0, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}, 0, fold), "top");
  });
  EXPECT_TRUE(contains(folded, "folded at node 4 at (0.000000, 1.000000, 0.000000)")) << folded;

  const auto body = block(CellType::Quadrilateral4, {0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 1, 1});
  const std::string inward = messageOf([&] {
    surfaceOf(body, "top", [](const Point&) { return Point{0, -1, 0}; });
  });
  EXPECT_TRUE(contains(inward, "does not point outward")) << inward;
  const std::string zero = messageOf([&] { surfaceOf(body, "top", [](const Point&) { return Point{}; }); });
  EXPECT_TRUE(contains(zero, "does not point outward")) << zero;
}

} // namespace test_surface
