// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DistributedFactor.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_distributed_factor {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

using Form = DistributedFactor::Form;

// The Laplacian of a grid of n × n points, an edge a term (1, −1; −1, 1) from one rank or another, and `held`
// added to the diagonal of the first point; points of no rank in particular. Two grids, of which one is held
// by nothing if there are any beside.
struct Grid {
  Grid(int size, double held, int pieces) : n(size), total(pieces * size * size) {
    const int ranks = testComm()->getSize(), rank = testComm()->getRank();
    // The last of several ranks has no row.
    const int sharing = ranks > 1 ? ranks - 1 : 1;
    first = rank < sharing ? rank * total / sharing : total;
    own = rank < sharing ? (rank + 1) * total / sharing - first : 0;
    std::map<std::pair<int, int>, double> sums;
    int edge = 0;
    for (int piece = 0; piece < pieces; ++piece)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (int step : {1, n}) {
            if (step == 1 ? j + 1 == n : i + 1 == n)
              continue;
            const int a = piece * n * n + i * n + j, b = a + step;
            if (edge++ % ranks != rank)
              continue;
            sums[{a, a}] += 1.0;
            sums[{b, b}] += 1.0;
            sums[{a, b}] -= 1.0;
          }
    if (rank == 0)
      sums[{0, 0}] += held;
    for (const auto& [place, value] : sums) {
      places.push_back(place);
      values.push_back(value);
    }
  }
  // Ax, all of it.
  std::vector<double> product(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto [i, j] = places[k];
      y[static_cast<std::size_t>(i)] += values[k] * x[static_cast<std::size_t>(j)];
      if (i != j)
        y[static_cast<std::size_t>(j)] += values[k] * x[static_cast<std::size_t>(i)];
    }
    globalSum(*testComm(), y);
    return y;
  }
  std::vector<double> share(const std::vector<double>& all) const {
    return {all.begin() + first, all.begin() + first + own};
  }
  int n, total, first = 0, own = 0;
  std::vector<std::pair<int, int>> places;
  std::vector<double> values;
};

std::vector<double> waves(int n) {
  std::vector<double> x;
  for (int k = 0; k < n; ++k)
    x.push_back(std::sin(1.0 + 3.0 * k));
  return x;
}

} // namespace

TEST(DistributedFactor, rows_of_the_inverse_and_solves_in_groups_of_all_sizes) {
  const Grid grid(9, 1.0, 1);
  const std::vector<double> x = waves(grid.total), e = grid.product(x), mine = grid.share(x);
  for (int group : {1, 2, 3, 100}) {
    const DistributedGraph graph(testComm(), grid.own, grid.places, group);
    EXPECT_GE(graph.groupSize(), std::min(group, testComm()->getSize()));
    for (Form form : {Form::Rows, Form::Solves})
      for (double threshold : {0.0, 1e-12}) {
        const DistributedFactor factor(graph, grid.values, {form, threshold, {}});
        EXPECT_TRUE(factor.leftOut().empty());
        const std::vector<double> solved = factor.solve(grid.share(e));
        ASSERT_EQ(solved.size(), mine.size());
        for (std::size_t k = 0; k < solved.size(); ++k)
          EXPECT_NEAR(solved[k], mine[k], 1e-11); // κ of some hundred, and sums of 81 terms
      }
  }
}

// Two grids that nothing holds: a row of each is left out, the same on all ranks, and e = Ax is still solved
// for.
TEST(DistributedFactor, leaves_rows_out_where_nothing_holds) {
  const Grid grid(6, 0.0, 2);
  const std::vector<double> x = waves(grid.total), e = grid.product(x);
  for (int group : {1, 2, 4}) {
    const DistributedGraph graph(testComm(), grid.own, grid.places, group);
    for (Form form : {Form::Rows, Form::Solves}) {
      const DistributedFactor factor(graph, grid.values, {form, 1e-12, {}});
      ASSERT_EQ(factor.leftOut().size(), 2u);
      EXPECT_LT(factor.leftOut()[0], 36);
      EXPECT_GE(factor.leftOut()[1], 36);
      const std::vector<double> solved = graph.gather(factor.solve(grid.share(e)));
      for (int row : factor.leftOut())
        EXPECT_EQ(solved[static_cast<std::size_t>(row)], 0.0);
      const std::vector<double> back = grid.product(solved);
      for (std::size_t k = 0; k < e.size(); ++k)
        EXPECT_NEAR(back[k], e[k], 1e-12);
      // They stay out where they are told to, of a matrix that needs it no more.
      const Grid held(6, 1.0, 2);
      const DistributedFactor again(graph, held.values, {form, 1e-12, factor.leftOut()});
      EXPECT_EQ(again.leftOut(), factor.leftOut());
    }
  }
}

TEST(DistributedFactor, a_matrix_that_is_not_finite_is_refused_by_all_ranks) {
  Grid grid(4, 1.0, 1);
  if (testComm()->getRank() == 0)
    grid.values[0] = std::nan("");
  const DistributedGraph graph(testComm(), grid.own, grid.places, 2);
  EXPECT_ANY_THROW(DistributedFactor(graph, grid.values, {Form::Rows, 0.0, {}}));
}

} // namespace test_distributed_factor
