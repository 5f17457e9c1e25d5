// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FrontTree.hpp"
#include "Harmos_SubdomainChoice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_subdomain_choice {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// The pattern of elasticity on a grid of n nodes a side whose cells are split into simplices along one
// diagonal: nodes are coupled whose differences have one sign.
LocalMatrix simplices(int n, int dimension) {
  const int layers = dimension == 3 ? n : 1;
  std::vector<MatrixEntry> entries;
  const auto node = [n](int x, int y, int z) { return x + n * (y + n * z); };
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        for (int sign : {-1, 1})
          for (int step = 0; step < (1 << dimension); ++step) {
            const int p = x + sign * (step & 1), q = y + sign * (step >> 1 & 1),
                      r = z + sign * (step >> 2 & 1);
            if (std::min({p, q, r}) < 0 || std::max(p, q) >= n || r >= layers || (step == 0 && sign > 0))
              continue;
            for (int i = 0; i < dimension; ++i)
              for (int j = 0; j < dimension; ++j)
                entries.push_back({dimension * node(x, y, z) + i, dimension * node(p, q, r) + j, 1.0});
          }
  return makeLocalMatrix(dimension * n * n * layers, std::move(entries));
}

double entriesOf(const FrontTree& tree) {
  return tree.entriesOf(std::vector<char>(tree.fronts.size(), 1));
}

} // namespace

// Beside the factors of cubes and squares.
TEST(SubdomainChoice, entries_of_factors) {
  for (int n : {7, 9, 12, 15}) {
    const LocalMatrix matrix = simplices(n, 3);
    const FrontTree tree(matrix, {});
    const FactorizationEstimate part = typicalPart({std::pow(n, 3), 3, 3, 15.0}, 1.0);
    EXPECT_EQ(part.rows, matrix.rows());
    EXPECT_NEAR(part.entries / entriesOf(tree), 1.0, 0.3) << n;
  }
  for (int n : {20, 40, 80}) {
    const FrontTree tree(simplices(n, 2), {});
    EXPECT_NEAR(typicalPart({std::pow(n, 2), 2, 2, 7.0}, 1.0).entries / entriesOf(tree), 1.0, 0.3) << n;
  }
}

// Of cubes in a cube: (n + 1)³ nodes each, of which (n + 1)³ − (n − 1)³ are at its surface.
TEST(SubdomainChoice, sizes_of_parts) {
  for (int n : {6, 8, 12}) {
    const double whole = std::pow(8 * n, 3);
    const FactorizationEstimate part = typicalPart({whole, 3, 3, 15.0}, 512.0);
    const double all = std::pow(n + 1, 3), inner = std::pow(n - 1, 3);
    EXPECT_NEAR(part.rows / (3.0 * all), 1.0, 0.1) << n;
    EXPECT_NEAR(part.boundary / (3.0 * (all - inner)), 1.0, 0.1) << n;
  }
}

TEST(SubdomainChoice, grows_with_the_body_and_fits_the_ranks) {
  for (int ranks : {1, 2, 3, 16, 64}) {
    int before = 0;
    for (double nodes : {1e3, 1e4, 1e5, 1e6}) {
      const WholeBodies bodies = {nodes, 3, 3, 15.0};
      const SubdomainChoice choice = chooseSubdomains(bodies, ranks, 0.0);
      EXPECT_GE(choice.parts, before) << ranks << " ranks, " << nodes;
      EXPECT_GT(choice.seconds, 0.0);
      EXPECT_GE(nodes / choice.parts, 30.0);
      if (nodes / ranks > 60.0)
        EXPECT_EQ(choice.parts % ranks, 0) << ranks << " ranks, " << nodes;
      before = choice.parts;
    }
  }
  // A part of 300 to 2000 nodes on few ranks: what tests/performance measures to be within a tenth of the
  // best.
  for (int ranks : {1, 2, 4})
    for (double nodes : {5e4, 2e5}) {
      const SubdomainChoice choice = chooseSubdomains({nodes, 3, 3, 15.0}, ranks, 0.0);
      EXPECT_GT(nodes / choice.parts, 300.0);
      EXPECT_LT(nodes / choice.parts, 2000.0);
    }
  EXPECT_EQ(chooseSubdomains({20.0, 3, 3, 15.0}, 16, 0.0).parts, 1);
}

// Little memory asks for more parts, whose factors are smaller; too little for the leanest.
TEST(SubdomainChoice, fits_into_the_memory) {
  const WholeBodies bodies = {2e5, 3, 3, 15.0};
  const SubdomainChoice any = chooseSubdomains(bodies, 1, 0.0);
  const double bytes = any.parts * 8.0 * typicalPart(bodies, any.parts).entries;
  const SubdomainChoice little = chooseSubdomains(bodies, 1, 0.4 * bytes / 1048576.0),
                        least = chooseSubdomains(bodies, 1, 1.0);
  EXPECT_GT(little.parts, any.parts);
  EXPECT_GT(little.seconds, any.seconds);
  EXPECT_GT(least.parts, little.parts);
}

} // namespace test_subdomain_choice
