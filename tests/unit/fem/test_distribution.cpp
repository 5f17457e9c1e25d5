// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_TestBodies.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TornBody.hpp"

#include <gtest/gtest.h>

namespace test_distribution {

using namespace Harmos;
using fem::PlacedMesh;

namespace {

std::vector<PlacedMesh> tornBody() {
  const fem::BodyMesh body = testBody(fem::CellType::Quadrilateral9, 8);
  const fem::Partition partition = partitionCells(body, 7);
  return tear(body, partition.part, partition.parts, 100);
}

} // namespace

TEST(Distribution, each_rank_gets_its_own_in_order) {
  const auto comm = testComm();
  const std::vector<PlacedMesh> all = tornBody(); // the same on all ranks
  const std::vector<PlacedMesh> given = comm->getRank() == 0 ? all : std::vector<PlacedMesh>{};
  for (const bool isReversed : {false, true}) {
    std::vector<int> owner;
    for (int s = 0; s < static_cast<int>(all.size()); ++s)
      owner.push_back(isReversed ? comm->getSize() - 1 - s % comm->getSize() : s % comm->getSize());
    // In one round; in many that cut through subdomains; byte by byte would take too long.
    for (std::size_t bytes : {fem::distributionRound, std::size_t(5000), std::size_t(301)}) {
      const std::vector<PlacedMesh> mine = distribute(*comm, given, owner, bytes);
      std::size_t next = 0;
      for (std::size_t s = 0; s < all.size(); ++s)
        if (owner[s] == comm->getRank()) {
          ASSERT_LT(next, mine.size());
          expectSame(mine[next++], all[s]);
        }
      EXPECT_EQ(next, mine.size());
    }
  }
}

TEST(Distribution, of_nothing_and_to_one_rank_only) {
  const auto comm = testComm();
  EXPECT_TRUE(fem::distribute(*comm, {}, {}).empty());
  const std::vector<PlacedMesh> all = tornBody();
  const int last = comm->getSize() - 1;
  const std::vector<PlacedMesh> mine = distribute(
      *comm, comm->getRank() == 0 ? all : std::vector<PlacedMesh>{}, std::vector<int>(all.size(), last));
  EXPECT_EQ(mine.size(), comm->getRank() == last ? all.size() : 0u);
}

TEST(Distribution, wrong_owners_are_everybodys_error) {
  const auto comm = testComm();
  const std::vector<PlacedMesh> all = tornBody();
  const std::vector<PlacedMesh> given = comm->getRank() == 0 ? all : std::vector<PlacedMesh>{};
  EXPECT_THROW(distribute(*comm, given, std::vector<int>(all.size(), comm->getSize())), InternalError);
  EXPECT_THROW(distribute(*comm, given, {0}), InternalError);
}

} // namespace test_distribution
