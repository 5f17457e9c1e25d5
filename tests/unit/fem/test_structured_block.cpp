// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace test_structured_block {

using namespace Harmos;
using fem::makeRectangle;
using fem::StructuredBlock;

TEST(StructuredBlock, copies_have_equal_numbers_and_places) {
  const StructuredBlock rectangle = makeRectangle({1.0, 2.0, 0.0}, {3.0, 1.0}, {3, 2}, {2, 4}, 100);
  EXPECT_EQ(rectangle.numberOfSubdomains(), 6);
  EXPECT_EQ(rectangle.numberOfNodes(), 7 * 9);
  std::map<long long, fem::Point> places;
  std::size_t copies = 0;
  for (int s = 0; s < 6; ++s) {
    const fem::PlacedMesh mesh = rectangle.subdomain(s);
    for (int node : mesh.mesh->boundary) {
      const fem::Point x = mesh.position(node);
      const auto [place, isNew] = places.emplace(mesh.number(node), x);
      ++copies;
      if (!isNew)
        for (std::size_t d = 0; d < 2; ++d)
          EXPECT_NEAR(place->second[d], x[d], 1e-14);
    }
  }
  EXPECT_EQ(copies, 6u * 12u);             // of the fifteen nodes three lie inside
  EXPECT_EQ(places.size(), 63u - 6u * 3u); // no inner node is numbered
  EXPECT_EQ(places.begin()->first, 100);
  EXPECT_EQ(places.rbegin()->first, 162);
}

TEST(StructuredBlock, congruent_subdomains_share_one_mesh) {
  const StructuredBlock rectangle = makeRectangle({0, 0, 0}, {1, 1}, {4, 4}, {3, 3}, 0);
  EXPECT_EQ(rectangle.subdomain(0).mesh.get(), rectangle.subdomain(15).mesh.get());
}

TEST(StructuredBlock, boundary_parts_lie_where_their_names_say) {
  const StructuredBlock rectangle = makeRectangle({0, 0, 0}, {2, 1}, {2, 2}, {3, 3}, 0);
  std::map<std::string, std::set<long long>> nodes;
  for (int s = 0; s < 4; ++s) {
    const fem::PlacedMesh mesh = rectangle.subdomain(s);
    EXPECT_EQ(mesh.mesh->boundary.size(), 12u);
    for (const auto& [name, set] : mesh.sets)
      for (int node : set) {
        nodes[name].insert(mesh.number(node));
        const fem::Point x = mesh.position(node);
        const std::size_t axis = name == "left" || name == "right" ? 0 : 1;
        const double expected = name == "right" ? 2.0 : name == "top" ? 1.0 : 0.0;
        EXPECT_NEAR(x[axis], expected, 1e-14) << name;
      }
  }
  for (const char* name : {"left", "right", "bottom", "top"})
    EXPECT_EQ(nodes[name].size(), 7u) << name;
}

TEST(StructuredBlock, refuses_empty_ones) {
  EXPECT_THROW(makeRectangle({0, 0, 0}, {0, 1}, {1, 1}, {1, 1}, 0), InputError);
  EXPECT_THROW(makeRectangle({0, 0, 0}, {1, 1}, {0, 1}, {1, 1}, 0), InputError);
}

// Every cell type, bent: copies of a node agree in number and place, the named sides make up the surface, and
// every subdomain's share of a number range is what the lattice says.
TEST(StructuredBlock, subdomains_of_every_cell_type_fit_together) {
  for (int t = static_cast<int>(fem::CellType::Triangle3); t <= static_cast<int>(fem::CellType::Wedge18);
       ++t) {
    fem::StructuredBlock::Options options;
    options.cellType = static_cast<fem::CellType>(t);
    const fem::CellShape& shape = fem::shapeOf(options.cellType);
    options.subdomains = {2, 3, 2};
    options.elements = {2, 1, 2};
    const double lean = shape.dimension == 3 ? 0.1 : 0.0;
    options.map = [lean](const fem::Point& x) {
      return fem::Point{x[0] + 0.1 * x[1] * x[1], x[1], x[2] - lean * x[0]};
    };
    const StructuredBlock block(options);
    EXPECT_EQ(block.numberOfSubdomains(), shape.dimension == 2 ? 6 : 12) << shape.name;
    const int p = shape.order;
    EXPECT_EQ(block.numberOfNodes(), (4LL * p + 1) * (3 * p + 1) * (shape.dimension == 2 ? 1 : 4 * p + 1));
    std::map<long long, fem::Point> places;
    std::map<std::string, int> sides;
    for (int s = 0; s < block.numberOfSubdomains(); ++s) {
      const fem::PlacedMesh mesh = block.subdomain(s);
      EXPECT_EQ(fem::nodesOf(*mesh.mesh, fem::boundarySides(*mesh.mesh)), mesh.mesh->boundary) << shape.name;
      for (int node : mesh.mesh->boundary) {
        const fem::Point x = mesh.position(node);
        const fem::Point known = places.emplace(mesh.number(node), x).first->second;
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(known[d], x[d], 1e-14) << shape.name;
      }
      for (const auto& [name, part] : mesh.sides) {
        sides[name] += static_cast<int>(part.size());
        EXPECT_EQ(fem::nodesOf(*mesh.mesh, part), mesh.sets.at(name)) << shape.name << " " << name;
      }
    }
    std::set<fem::Point> distinct; // equal numbers, equal places; different numbers, different ones
    for (const auto& item : places)
      distinct.insert({std::round(1e9 * item.second[0]), std::round(1e9 * item.second[1]),
                       std::round(1e9 * item.second[2])});
    EXPECT_EQ(distinct.size(), places.size()) << shape.name;
    const int cut = shape.isSimplex && shape.dimension == 3 ? 2 : 1; // triangles on a square
    EXPECT_EQ(sides["left"], shape.dimension == 2 ? 3 : 3 * 4 * cut) << shape.name;
    EXPECT_EQ(sides["top"], shape.dimension == 2 ? 4 : 4 * 3 * (shape.isWedge ? 2 : cut)) << shape.name;
  }
}

} // namespace test_structured_block
