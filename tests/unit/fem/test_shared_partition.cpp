// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellClusters.hpp"
#include "Harmos_CellGraph.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_GraphPartition.hpp"
#include "Harmos_PartShape.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_shared_partition {

using namespace Harmos;
using namespace Harmos::fem;

namespace {

// As many tetrahedra as are cut in pieces.
BodyMesh block() {
  StructuredBlock::Options options;
  options.cellType = CellType::Tetrahedron4;
  options.elements = {28, 28, 28};
  BodyMesh body;
  body.name = "block";
  body.mesh = *StructuredBlock(options).subdomain(0).mesh;
  body.regions = {"all"};
  return body;
}

int cutSides(const CellGraph& graph, const std::vector<int>& part) {
  int sides = 0;
  for (int c = 0; c < graph.cells(); ++c)
    for (const int* other = graph.begin(c); other != graph.end(c); ++other)
      sides += part[static_cast<std::size_t>(*other)] != part[static_cast<std::size_t>(c)] ? 1 : 0;
  return sides / 2;
}

} // namespace

// Beside the cut of one rank: parts as large, with as few sides between them, none ragged, and the same
// again.
TEST(SharedPartition, is_as_good_as_that_of_one_rank) {
  const auto comm = testComm();
  const bool isRoot = comm->getRank() == 0;
  constexpr int wanted = 41;
  const BodyMesh body = isRoot ? block() : BodyMesh();
  const Partition shared = partitionCells(*comm, isRoot ? &body : nullptr, wanted);
  const Partition again = partitionCells(*comm, isRoot ? &body : nullptr, wanted);
  EXPECT_EQ(shared.part, again.part);
  if (!isRoot) {
    EXPECT_EQ(shared.parts, 0);
    return;
  }
  EXPECT_EQ(shared.part, partitionCells(body, wanted).part) << "the same on any number of ranks";
  ASSERT_EQ(shared.parts, wanted);
  const CellGraph graph = graphOf(body.mesh), along = reordered(graph, curveThrough(graph.centres));
  ASSERT_EQ(shared.part.size(), static_cast<std::size_t>(graph.cells()));
  const Partition whole = fem::Details::partition(along, wanted, 8, {});
  EXPECT_EQ(componentsOf(graph, shared.part).cells.size(), static_cast<std::size_t>(wanted));
  EXPECT_LT(cutSides(graph, shared.part), 1.06 * cutSides(along, whole.part));
  std::vector<int> sizes, lowest;
  for (const std::vector<int>& cells : cellsOf(shared.part, wanted)) {
    ASSERT_FALSE(cells.empty());
    sizes.push_back(static_cast<int>(cells.size()));
    lowest.push_back(cells.front());
  }
  const double mean = static_cast<double>(graph.cells()) / wanted;
  EXPECT_GT(*std::min_element(sizes.begin(), sizes.end()), 0.85 * mean);
  EXPECT_LT(*std::max_element(sizes.begin(), sizes.end()), 1.15 * mean);
  EXPECT_TRUE(std::is_sorted(lowest.begin(), lowest.end()))
      << "parts come in the order of their lowest cells";
  // Necks are measured with cells in another order, and so with other rounding errors.
  const std::vector<double> necks = neckWidths(graph, shared.part, wanted);
  ASSERT_EQ(shared.necks.size(), necks.size());
  for (std::size_t p = 0; p < necks.size(); ++p) {
    EXPECT_NEAR(shared.necks[p], necks[p], 0.1 * necks[p]) << p;
    EXPECT_GT(shared.necks[p], raggedNeck) << p;
  }
}

// A body in components is cut component by component, and says so.
TEST(SharedPartition, of_bodies_in_components_and_small_ones) {
  const auto comm = testComm();
  const bool isRoot = comm->getRank() == 0;
  BodyMesh two = block();
  const int nodes = two.mesh.numberOfNodes();
  const std::vector<int> cells = two.mesh.cells;
  const std::vector<double> coordinates = two.mesh.coordinates;
  for (int node : cells)
    two.mesh.cells.push_back(node + nodes);
  for (double x : coordinates)
    two.mesh.coordinates.push_back(x + 2.0);
  BodyMesh small = block();
  small.mesh.cells.resize(static_cast<std::size_t>(4 * 20000));
  for (const BodyMesh* body : {&two, &small}) {
    const Partition shared = partitionCells(*comm, isRoot ? body : nullptr, 41);
    if (!isRoot)
      continue;
    EXPECT_EQ(shared.part, partitionCells(*body, 41).part);
    const bool isTwo = std::any_of(shared.notes.begin(), shared.notes.end(), [](const std::string& note) {
      return note.find("consists of 2 components") != std::string::npos;
    });
    EXPECT_EQ(isTwo, body == &two);
  }
}

TEST(SharedPartition, impossible_wishes_are_everybodys_error) {
  const auto comm = testComm();
  const bool isRoot = comm->getRank() == 0;
  const BodyMesh body = block();
  EXPECT_THROW(partitionCells(*comm, isRoot ? &body : nullptr, 0), InputError);
  EXPECT_THROW(partitionCells(*comm, isRoot ? &body : nullptr, 10000000), InputError);
}

} // namespace test_shared_partition
