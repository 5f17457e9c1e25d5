// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

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
