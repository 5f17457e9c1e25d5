// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_NodePairs.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <set>

using namespace Harmos;
using contact::SurfaceNode;
using fem::makeRectangle;
using fem::StructuredBlock;

namespace {

// Subdomains s with s mod ranks = rank.
std::vector<SurfaceNode> share(const StructuredBlock& body, const std::string& set) {
  const auto comm = testComm();
  std::vector<SurfaceNode> nodes;
  for (int s = comm->getRank(); s < body.numberOfSubdomains(); s += comm->getSize()) {
    const auto more = contact::surfaceNodes(body.subdomain(s), set);
    nodes.insert(nodes.end(), more.begin(), more.end());
  }
  return nodes;
}

std::string failure(const StructuredBlock& a, const StructuredBlock& b, const std::string& set) {
  try {
    contact::pairNodes(*testComm(), share(a, "right"), share(b, set), "left body and right body");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(NodePairs, matching_sides_are_paired_once_with_their_lengths) {
  const StructuredBlock a = makeRectangle({0, 0, 0}, {1, 1}, {2, 3}, {2, 2}, 0);
  const StructuredBlock b = makeRectangle({1, 0, 0}, {1, 1}, {1, 2}, {3, 3}, a.numberOfNodes());
  const auto pairs = contact::pairNodes(*testComm(), share(a, "right"), share(b, "left"), "test");
  ASSERT_EQ(pairs.size(), 7u);
  double length = 0.0;
  std::set<long long> seen;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    // Row by row: the right side of a has numbers 4, 9, 14, …, the left side of b 35, 39, 43, …
    EXPECT_EQ(pairs[k].first, 4 + 5 * static_cast<long long>(k));
    EXPECT_EQ(pairs[k].second, 35 + 4 * static_cast<long long>(k));
    EXPECT_NEAR(pairs[k].length, k == 0 || k == 6 ? 1.0 / 12.0 : 1.0 / 6.0, 1e-15);
    length += pairs[k].length;
    seen.insert(pairs[k].second);
  }
  EXPECT_NEAR(length, 1.0, 1e-14);
  EXPECT_EQ(seen.size(), 7u);
}

TEST(NodePairs, surfaces_that_do_not_match_are_refused_on_all_ranks) {
  const StructuredBlock a = makeRectangle({0, 0, 0}, {1, 1}, {1, 1}, {2, 2}, 0);
  const StructuredBlock coarse = makeRectangle({1, 0, 0}, {1, 1}, {1, 1}, {1, 1}, 100);
  const StructuredBlock fine = makeRectangle({1, 0, 0}, {1, 1}, {1, 1}, {4, 4}, 100);
  EXPECT_NE(failure(a, coarse, "left")
                .find("node 5 at (1.000000, 0.500000, 0.000000) of the first surface has no "
                      "partner"),
            std::string::npos)
      << failure(a, coarse, "left");
  EXPECT_NE(failure(a, fine, "left").find("of the second surface has no partner"), std::string::npos);
  EXPECT_NE(failure(a, fine, "front").find("the second surface has no nodes"), std::string::npos);
}

TEST(NodePairs, rows_are_numbered_through_and_each_is_on_one_rank) {
  const auto comm = testComm();
  std::vector<contact::NodePair> pairs;
  for (long long k = 0; k < 5; ++k)
    pairs.push_back({k, 10 + k, 0.1, 1.0});
  const auto rows = contact::contactRows(*comm, pairs);
  for (const ConstraintRow& row : rows) {
    EXPECT_EQ(row.number % comm->getSize(), comm->getRank());
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Inequality);
    EXPECT_EQ(row.terms[0].dof, row.number);
    EXPECT_EQ(row.terms[0].coefficient, 1.0);
    EXPECT_EQ(row.terms[1].dof, 10 + row.number);
    EXPECT_EQ(row.terms[1].coefficient, -1.0);
    EXPECT_EQ(row.bound, 0.1);
  }
  for (const ConstraintRow& row : contact::tieRows(*comm, pairs))
    EXPECT_EQ(row.kind, ConstraintRow::Kind::Equality);
}
