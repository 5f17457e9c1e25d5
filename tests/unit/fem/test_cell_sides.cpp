// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellClusters.hpp"
#include "Harmos_CellGraph.hpp"
#include "Harmos_CellSides.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <tuple>

namespace test_cell_sides {

using namespace Harmos;
using namespace Harmos::fem;

namespace {

// Of a block, with nodes in any order, and three cells at one side.
Mesh shuffled(CellType type) {
  StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {4, 3, 2};
  Mesh mesh = *StructuredBlock(options).subdomain(0).mesh;
  std::vector<int> order(static_cast<std::size_t>(mesh.numberOfNodes()));
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = static_cast<int>(k);
  std::mt19937 random(7);
  std::shuffle(order.begin(), order.end(), random);
  for (int& node : mesh.cells)
    node = order[static_cast<std::size_t>(node)];
  const std::vector<int> again(mesh.cells.begin(), mesh.cells.begin() + mesh.nodesPerCell());
  mesh.cells.insert(mesh.cells.end(), again.begin(), again.end());
  return mesh;
}

std::set<int> cornersOf(const Mesh& mesh, const Side& side) {
  const auto corners = static_cast<std::size_t>(shapeOf(mesh.typeOf(side)).corners);
  const std::vector<int> nodes = mesh.nodesOf(side);
  return {nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(corners)};
}

} // namespace

TEST(CellSides, come_by_rising_corners_and_cells) {
  for (CellType type : {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4,
                        CellType::Quadrilateral9, CellType::Tetrahedron4, CellType::Tetrahedron10,
                        CellType::Hexahedron8, CellType::Hexahedron27, CellType::Quadrilateral8,
                        CellType::Hexahedron20, CellType::Wedge6, CellType::Wedge15, CellType::Wedge18}) {
    const Mesh mesh = shuffled(type);
    std::map<std::set<int>, std::vector<std::pair<int, int>>> expected; // sets compare as their elements do
    for (int c = 0; c < mesh.numberOfCells(); ++c)
      for (std::size_t s = 0; s < shapeOf(type).sides.size(); ++s)
        expected[cornersOf(mesh, {c, static_cast<int>(s)})].emplace_back(c, static_cast<int>(s));
    const MatchedSides matched = matchSides(mesh);
    ASSERT_EQ(matched.first.size(), expected.size() + 1);
    ASSERT_EQ(matched.first.back(), matched.sides.size());
    std::size_t group = 0;
    for (const auto& [corners, sides] : expected) {
      std::vector<std::pair<int, int>> found;
      for (std::size_t k = matched.first[group]; k < matched.first[group + 1]; ++k)
        found.emplace_back(matched.sides[k].cell, matched.sides[k].side);
      EXPECT_EQ(found, sides);
      ++group;
    }
  }
}

// Against all pairs of cells.
TEST(CellSides, the_graph_has_the_cells_that_share_one) {
  for (CellType type :
       {CellType::Triangle3, CellType::Quadrilateral9, CellType::Tetrahedron10, CellType::Hexahedron8}) {
    const Mesh mesh = shuffled(type);
    const CellGraph graph = graphOf(mesh);
    std::map<std::set<int>, std::vector<int>> cells;
    for (int c = 0; c < mesh.numberOfCells(); ++c)
      for (std::size_t s = 0; s < shapeOf(type).sides.size(); ++s)
        cells[cornersOf(mesh, {c, static_cast<int>(s)})].push_back(c);
    std::vector<std::set<int>> expected(static_cast<std::size_t>(mesh.numberOfCells()));
    for (const auto& [corners, sharing] : cells)
      for (int a : sharing)
        for (int b : sharing)
          if (a != b)
            expected[static_cast<std::size_t>(a)].insert(b);
    ASSERT_EQ(graph.cells(), mesh.numberOfCells());
    for (int c = 0; c < mesh.numberOfCells(); ++c)
      EXPECT_EQ(std::vector<int>(graph.begin(c), graph.end(c)),
                std::vector<int>(expected[static_cast<std::size_t>(c)].begin(),
                                 expected[static_cast<std::size_t>(c)].end()));
  }
}

// Each cell is in one cluster, which hangs together; sides between clusters are all counted.
TEST(CellSides, clusters_of_cells_and_their_graph) {
  StructuredBlock::Options options;
  options.cellType = CellType::Tetrahedron4;
  options.elements = {6, 5, 4};
  const Mesh mesh = *StructuredBlock(options).subdomain(0).mesh;
  const CellGraph graph = graphOf(mesh);
  const CellClusters clusters = clustersOf(graph, 8);
  std::vector<int> sizes(clusters.sizes.size(), 0);
  std::map<std::pair<int, int>, int> sides;
  for (int c = 0; c < graph.cells(); ++c) {
    const int own = clusters.of.at(static_cast<std::size_t>(c));
    ++sizes.at(static_cast<std::size_t>(own));
    for (const int* other = graph.begin(c); other != graph.end(c); ++other)
      if (const int beside = clusters.of[static_cast<std::size_t>(*other)]; beside != own)
        ++sides[{own, beside}];
  }
  EXPECT_EQ(sizes, clusters.sizes);
  EXPECT_EQ(*std::max_element(sizes.begin(), sizes.end()), 8);
  EXPECT_EQ(componentsOf(graph, clusters.of).cells.size(), sizes.size());
  std::map<std::pair<int, int>, int> found;
  for (int k = 0; k < clusters.graph.cells(); ++k)
    for (const int* other = clusters.graph.begin(k); other != clusters.graph.end(k); ++other)
      found[{k, *other}] = clusters.sides[static_cast<std::size_t>(other - clusters.graph.neighbours.data())];
  EXPECT_EQ(found, sides);
}

} // namespace test_cell_sides
