// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestBodies.hpp"
#include "Harmos_TornBody.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace test_torn_body {

using namespace Harmos;
using fem::BodyMesh;
using fem::CellType;
using fem::PlacedMesh;

namespace {

double sizeOf(const fem::Mesh& mesh) {
  constexpr int degree = 4;
  const fem::ReferenceElement element(mesh.cellType, degree);
  fem::CellIntegrator integrator(mesh, element);
  double sum = 0.0;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    integrator.turnTo(c);
    sum += integrator.size();
  }
  return sum;
}

fem::Point bodyPlace(const BodyMesh& body, long long number, long long firstNode) {
  return body.mesh.local(static_cast<int>(number - firstNode));
}

} // namespace

TEST(TornBody, copies_agree_and_the_parts_are_the_body) {
  constexpr long long firstNode = 1000;
  for (CellType type :
       {CellType::Triangle6, CellType::Quadrilateral4, CellType::Tetrahedron4, CellType::Tetrahedron10,
        CellType::Hexahedron27, CellType::Hexahedron20, CellType::Wedge15}) {
    SCOPED_TRACE(fem::shapeOf(type).name);
    const BodyMesh body = testBody(type, 4);
    const fem::Partition partition = partitionCells(body, 5);
    const std::vector<PlacedMesh> torn = tear(body, partition.part, partition.parts, firstNode);
    ASSERT_EQ(static_cast<int>(torn.size()), partition.parts);
    std::vector<int> next(torn.size(), 0); // cell of each subdomain
    double size = 0.0;
    std::multiset<long long> copies;
    for (const PlacedMesh& placed : torn) {
      const fem::Mesh& mesh = *placed.mesh;
      EXPECT_EQ(mesh.local(0), (fem::Point{0.0, 0.0, 0.0}));
      size += sizeOf(mesh);
      EXPECT_TRUE(std::is_sorted(mesh.boundary.begin(), mesh.boundary.end()));
      ASSERT_EQ(placed.boundaryNumbers.size(), mesh.boundary.size());
      for (int node : mesh.boundary) {
        const fem::Point x = placed.position(node), y = bodyPlace(body, placed.number(node), firstNode);
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(x[d], y[d], 1e-14);
        copies.insert(placed.number(node));
      }
    }
    EXPECT_NEAR(size, sizeOf(body.mesh), 1e-12);
    // Cell by cell, node by node; and a node is a boundary node of all parts that have it or of none.
    std::map<long long, std::size_t> users;
    for (int c = 0; c < body.mesh.numberOfCells(); ++c) {
      const auto p = static_cast<std::size_t>(partition.part[static_cast<std::size_t>(c)]);
      const int local = next[p]++;
      EXPECT_EQ(torn[p].mesh->region(local), body.mesh.region(c));
      for (int i = 0; i < body.mesh.nodesPerCell(); ++i) {
        const fem::Point x = torn[p].position(torn[p].mesh->cell(local)[i]);
        const fem::Point y = body.mesh.local(body.mesh.cell(c)[i]);
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(x[d], y[d], 1e-14);
      }
    }
    for (int node = 0; node < body.mesh.numberOfNodes(); ++node) {
      std::set<int> parts;
      for (int c = 0; c < body.mesh.numberOfCells(); ++c)
        for (int i = 0; i < body.mesh.nodesPerCell(); ++i)
          if (body.mesh.cell(c)[i] == node)
            parts.insert(partition.part[static_cast<std::size_t>(c)]);
      const bool isOuter = std::binary_search(body.mesh.boundary.begin(), body.mesh.boundary.end(), node) ||
                           body.nodes.at("centre").front() == node;
      EXPECT_EQ(copies.count(firstNode + node), parts.size() > 1 || isOuter ? parts.size() : 0u);
    }
  }
}

TEST(TornBody, named_parts_are_those_of_the_body) {
  const BodyMesh body = testBody(CellType::Quadrilateral9, 6);
  const fem::Partition partition = partitionCells(body, 7);
  const std::vector<PlacedMesh> torn = tear(body, partition.part, partition.parts, 0);
  for (const auto& [name, sides] : body.sides) {
    std::size_t count = 0;
    for (const PlacedMesh& placed : torn) {
      const auto found = placed.sides.find(name);
      if (found != placed.sides.end())
        count += found->second.size();
    }
    EXPECT_EQ(count, sides.size()) << name;
    const std::vector<int> nodes = nodesOf(body.mesh, sides);
    for (const PlacedMesh& placed : torn) {
      std::vector<int> expected; // every local node of the named part, whether a side of it is here or not
      for (int node : placed.mesh->boundary)
        if (std::binary_search(nodes.begin(), nodes.end(), static_cast<int>(placed.number(node))))
          expected.push_back(node);
      const auto found = placed.sets.find(name);
      EXPECT_EQ(found == placed.sets.end() ? std::vector<int>{} : found->second, expected) << name;
      if (placed.sides.count(name) == 0)
        continue;
      for (int node : nodesOf(*placed.mesh, placed.sides.at(name)))
        EXPECT_TRUE(std::binary_search(expected.begin(), expected.end(), node));
    }
  }
  std::size_t withCentre = 0;
  for (const PlacedMesh& placed : torn)
    withCentre += placed.sets.count("centre");
  EXPECT_GE(withCentre, 1u);
}

TEST(TornBody, a_part_that_only_touches_a_named_part_has_its_node) {
  // Triangles: one of the two below the corner has no side on the left, but its node.
  const BodyMesh body = testBody(CellType::Triangle3, 1);
  ASSERT_EQ(body.mesh.numberOfCells(), 2);
  const std::vector<PlacedMesh> torn = tear(body, {0, 1}, 2, 0);
  // Cell 0 is below the diagonal: it has "bottom" and "right", and touches "left" and "top" with a node each.
  EXPECT_EQ(torn[0].sides.count("left"), 0u);
  EXPECT_EQ(torn[0].sets.at("left").size(), 1u);
  EXPECT_EQ(torn[0].sets.at("top").size(), 1u);
  EXPECT_EQ(torn[0].sides.at("bottom").size(), 1u);
  EXPECT_EQ(torn[0].sets.at("bottom").size(), 2u);
  EXPECT_EQ(torn[1].sides.at("left").size(), 1u);
}

TEST(TornBody, bytes_and_back) {
  const BodyMesh body = testBody(CellType::Tetrahedron10, 2);
  const fem::Partition partition = partitionCells(body, 3);
  for (const PlacedMesh& placed : tear(body, partition.part, partition.parts, 5)) {
    std::vector<char> bytes = pack(placed);
    expectSame(fem::unpack(bytes), placed);
    bytes.pop_back();
    EXPECT_THROW(fem::unpack(bytes), InternalError);
    bytes.resize(bytes.size() + 2);
    EXPECT_THROW(fem::unpack(bytes), InternalError);
  }
  EXPECT_THROW(fem::unpack({}), InternalError);
}

} // namespace test_torn_body
