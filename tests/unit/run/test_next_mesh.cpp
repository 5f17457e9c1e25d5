// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NextMesh.hpp"
#include "Harmos_Quantity.hpp"
#include "Harmos_RoundAim.hpp"

#include <Teuchos_DefaultSerialComm.hpp>
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
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const CellError& cell = cells[k];
    const double factor = next.lengths[k] / cell.size;
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

// Without error: as coarse as may be. No cell is less than half as long. No more cells than allowed, of which
// all have the same error, and edges as the mesher will make them.
TEST(NextMesh, limits) {
  std::vector<CellError> all = cells();
  all[21].square = 0.0;
  const run::NextMesh next = run::nextMesh(all, {0.05, 1, 2, 0.0});
  EXPECT_DOUBLE_EQ(next.lengths[21], 2.0 * 0.1);
  EXPECT_LT((*next.sizes)(all[21].centre), 0.2); // as far as sizes may grow from its neighbours'
  const run::NextMesh tiny = run::nextMesh(all, {1e-9, 1, 2, 0.0});
  EXPECT_DOUBLE_EQ(tiny.lengths[3], 0.5 * 0.1);
  all[21].square = all[20].square;
  const run::NextMesh limited = run::nextMesh(all, {1e-9, 1, 2, 100.0});
  const Predicted found = predicted(all, limited, 1, 2);
  EXPECT_NEAR(found.cells, 100.0, 1e-6);
  EXPECT_NEAR(found.least, found.most, 0.1 * found.most); // all[21] has that of its neighbour
  const run::NextMesh asked = run::nextMesh(all, {0.05, 1, 2, 0.0});
  const run::NextMesh shorter = run::nextMesh(all, {0.05, 1, 2, 0.0, 1.25});
  EXPECT_DOUBLE_EQ(shorter.lengths[3], 0.8 * asked.lengths[3]);
}

// Where nothing is known of errors: half the size at the places, elsewhere as it was.
TEST(NextMesh, finer_at_places) {
  const std::vector<CellError> all = cells();
  const run::NextMesh next = run::finerAt(all, {all[10].centre}, 2, 1.25);
  double count = 0.0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool isNear = k >= 9 && k <= 11;
    EXPECT_DOUBLE_EQ(next.lengths[k], (isNear ? 0.05 : 0.1) / 1.25) << k;
    count += isNear ? 4.0 : 1.0;
  }
  EXPECT_DOUBLE_EQ(next.cells, count);
  EXPECT_LT((*next.sizes)(all[10].centre), (*next.sizes)(all[20].centre));
}

// The first rounds are limited by growth and by a share of the error; a mesher that makes longer edges is
// asked for shorter ones; a target that was missed is aimed below.
TEST(RoundAim, what_became_of_rounds_before) {
  const std::vector<CellError> all = cells();
  double sum = 0.0;
  for (const CellError& cell : all)
    sum += cell.square;
  const double scale = 1.0, error = std::sqrt(sum);
  run::RoundAim far(1e-6, 0.0);
  const run::NextMesh first = far.next(all, {error, scale, 1, 2});
  EXPECT_LE(first.cells, 3.0 * 50.0 * (1.0 + 1e-6));
  EXPECT_GE(predicted(all, first, 1, 2).error, 0.35 * error * (1.0 - 1e-9));

  const double target = 0.8 * error;
  run::RoundAim near(target, 0.0);
  const run::NextMesh wanted = near.next(all, {error, scale, 1, 2});
  EXPECT_NEAR(predicted(all, wanted, 1, 2).error, 0.95 * target, 1e-9 * target);
  // Nothing came of it: cells and error are as they were.
  const run::NextMesh again = near.next(all, {error, scale, 1, 2});
  const double stretch = std::sqrt(wanted.cells / 50.0), excess = error / (0.95 * target);
  const run::NextMesh same = run::nextMesh(all, {0.95 * target / excess, 1, 2, 150.0, stretch});
  EXPECT_GT(stretch, 1.05);
  for (std::size_t k = 0; k < all.size(); ++k)
    EXPECT_NEAR(again.lengths[k], same.lengths[k], 1e-9 * all[k].size);
}

// Derivatives against differences; of degree one in the forces, and between the mean and the largest
// pressure.
TEST(Quantity, derivatives_of_the_peak_pressure) {
  const Teuchos::SerialComm<int> comm;
  const std::vector<double> areas = {0.5, 1.0, 2.0, 1.0, 0.0, 1.0};
  std::vector<double> forces = {0.4, 1.0, 1.8, 0.1, 0.3, -0.2};
  const run::PeakOfPressure peak = run::peakOfPressure(comm, forces, areas);
  EXPECT_GT(peak.value, 0.6);
  EXPECT_LT(peak.value, 1.0);
  double product = 0.0;
  for (std::size_t r = 0; r < forces.size(); ++r) {
    product += forces[r] * peak.derivatives[r];
    constexpr double step = 1e-6; // central differences: 1e-12 · third derivative + 1e-16 / step
    const double force = forces[r];
    forces[r] = force + step;
    const double above = run::peakOfPressure(comm, forces, areas).value;
    forces[r] = force - step;
    const double below = run::peakOfPressure(comm, forces, areas).value;
    forces[r] = force;
    EXPECT_NEAR(peak.derivatives[r], 0.5 * (above - below) / step, 1e-8) << r;
  }
  EXPECT_NEAR(product, peak.value, 1e-13);
  EXPECT_EQ(run::peakOfPressure(comm, {0.0, -1.0}, {1.0, 1.0}).value, 0.0);
}

} // namespace test_next_mesh
