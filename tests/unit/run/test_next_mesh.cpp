// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NextMesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_next_mesh {

using namespace Harmos;
using run::CellError;

namespace {

// What a mesh of these cells would have for error and number, cells cut as the theory has it.
struct Predicted {
  double error = 0.0, cells = 0.0, least = 1e300, most = 0.0;
};
Predicted predicted(const std::vector<CellError>& cells, const run::NextMesh& next, double p, double d) {
  Predicted result;
  for (const CellError& cell : cells) {
    const double factor = (*next.sizes)(cell.centre) / cell.size;
    result.error += cell.square * std::pow(factor, 2.0 * p);
    result.cells += std::pow(factor, -d);
    const double of_each = cell.square * std::pow(factor, 2.0 * p + d);
    result.least = std::min(result.least, of_each);
    result.most = std::max(result.most, of_each);
  }
  result.error = std::sqrt(result.error);
  return result;
}

std::vector<CellError> cells() {
  std::vector<CellError> result;
  for (int k = 0; k < 50; ++k)
    result.push_back({{0.1 * k, 0.0, 0.0}, 0.1, 1e-4 * std::pow(1.02, k)});
  return result;
}

} // namespace

// The error is the goal, every cell of the next mesh has the same, and cells are as many as foretold.
TEST(NextMesh, error_is_the_goal) {
  for (int p : {1, 2})
    for (int d : {2, 3}) {
      const std::vector<CellError> all = cells();
      const run::NextMesh next = run::nextMesh(all, {0.07, p, d, 0.0});
      const Predicted found = predicted(all, next, p, d);
      EXPECT_NEAR(found.error, 0.07, 1e-12);
      EXPECT_NEAR(found.cells, next.cells, 1e-9 * next.cells);
      EXPECT_NEAR(found.least, found.most, 1e-12 * found.most);
    }
}

// Nothing known of a cell: as the nearest. Without error: as coarse as may be. No more cells than allowed.
TEST(NextMesh, what_is_not_known_and_limits) {
  std::vector<CellError> all = cells();
  all[20].square = -1.0;
  all[21].square = 0.0;
  all[20].centre[0] = all[19].centre[0] + 0.01;
  const run::NextMesh next = run::nextMesh(all, {0.05, 1, 2, 0.0});
  EXPECT_DOUBLE_EQ((*next.sizes)(all[20].centre), (*next.sizes)(all[19].centre));
  EXPECT_DOUBLE_EQ((*next.sizes)(all[21].centre), 2.0 * 0.1);
  const run::NextMesh tiny = run::nextMesh(all, {1e-9, 1, 2, 0.0});
  EXPECT_DOUBLE_EQ((*tiny.sizes)(all[3].centre), 0.5 * 0.1);
  const run::NextMesh limited = run::nextMesh(all, {1e-9, 1, 2, 100.0});
  EXPECT_DOUBLE_EQ(limited.cells, 100.0);
  EXPECT_GT((*limited.sizes)(all[3].centre), 0.06);
}

} // namespace test_next_mesh
