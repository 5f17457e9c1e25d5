// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Kernel.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_kernel {

using namespace Harmos;
using feti::Kernel;

namespace {

// Rigid motions of plane elasticity at points of a circle: two translations, a rotation.
Kernel planeMotions(int nodes) {
  Kernel kernel{2 * nodes, 3, std::vector<double>(static_cast<std::size_t>(6 * nodes), 0.0)};
  for (int k = 0; k < nodes; ++k) {
    const auto i = static_cast<std::size_t>(2 * k), n = static_cast<std::size_t>(2 * nodes);
    kernel.values[i] = 1.0;
    kernel.values[n + i + 1] = 1.0;
    kernel.values[2 * n + i] = -std::sin(k);
    kernel.values[2 * n + i + 1] = std::cos(k);
  }
  return kernel;
}

} // namespace

TEST(Kernel, basis_is_orthonormal) {
  const Kernel kernel = feti::heldKernel(planeMotions(7), {});
  ASSERT_EQ(kernel.columns, 3);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      double dot = 0.0;
      for (int i = 0; i < kernel.rows; ++i)
        dot += kernel.column(a)[i] * kernel.column(b)[i];
      EXPECT_NEAR(dot, a == b ? 1.0 : 0.0, 1e-14);
    }
}

// A pinned node leaves the rotation about it; two pinned nodes leave nothing; a roller leaves one motion
// less.
TEST(Kernel, fixed_dofs_take_motions_away) {
  const Kernel motions = planeMotions(7);
  const Kernel pinned = feti::heldKernel(motions, {4, 5});
  ASSERT_EQ(pinned.columns, 1);
  EXPECT_NEAR(pinned.column(0)[4], 0.0, 1e-14);
  EXPECT_NEAR(pinned.column(0)[5], 0.0, 1e-14);
  // Rotation about node 2: velocity of node 0 is perpendicular to the line between them.
  const double dx = std::cos(0.0) - std::cos(2.0), dy = std::sin(0.0) - std::sin(2.0);
  EXPECT_NEAR(pinned.column(0)[0] * dx + pinned.column(0)[1] * dy, 0.0, 1e-14);
  EXPECT_EQ(feti::heldKernel(motions, {4, 5, 8, 9}).columns, 0);
  EXPECT_EQ(feti::heldKernel(motions, {4}).columns, 2);
}

// Rigid motions, to the first order, leave distances as they are: (u_p − u_q)·(x_p − x_q) = 0 for any two
// points.
TEST(Kernel, rigid_motions_keep_distances) {
  const std::vector<double> coordinates = {0.3, 1.7, -2.1, 0.9, 0.4, 3.3, -1.2, 2.2, 0.8, 1.9, -0.7, 0.1};
  for (int dimension : {2, 3}) {
    const Kernel kernel = feti::rigidBodyKernel(coordinates, dimension);
    const int points = static_cast<int>(coordinates.size()) / dimension;
    EXPECT_EQ(kernel.columns, dimension == 2 ? 3 : 6);
    for (int k = 0; k < kernel.columns; ++k)
      for (int p = 0; p < points; ++p)
        for (int q = 0; q < p; ++q) {
          double product = 0.0;
          for (int c = 0; c < dimension; ++c)
            product += (kernel.column(k)[p * dimension + c] - kernel.column(k)[q * dimension + c]) *
                       (coordinates[static_cast<std::size_t>(p * dimension + c)] -
                        coordinates[static_cast<std::size_t>(q * dimension + c)]);
          EXPECT_NEAR(product, 0.0, 1e-14) << "dimension " << dimension << ", motion " << k;
        }
  }
}

// Springs take away the motions that stretch them: two upright ones leave sliding aside, a third that leans
// nothing; how stiff they are does not matter.
TEST(Kernel, springs_take_motions_away) {
  const Kernel motions = planeMotions(7);
  const auto spring = [](int node, double x, double y, double stiffness) {
    std::vector<MatrixEntry> entries;
    const double direction[] = {x, y};
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        entries.push_back({2 * node + a, 2 * node + b, stiffness * direction[a] * direction[b]});
    return entries;
  };
  for (double stiffness : {1e-9, 1.0, 1e9}) {
    std::vector<MatrixEntry> springs = spring(2, 0, 1, stiffness);
    EXPECT_EQ(feti::keptKernel(motions, makeLocalMatrix(14, springs)).columns, 2);
    for (const MatrixEntry& entry : spring(5, 0, 1, stiffness))
      springs.push_back(entry);
    const LocalMatrix two = makeLocalMatrix(14, springs);
    const Kernel left = feti::keptKernel(motions, two);
    ASSERT_EQ(left.columns, 1);
    EXPECT_LE(feti::kernelDefect(two, left), 1e-15);
    for (int node = 0; node < 7; ++node) {
      EXPECT_NEAR(std::abs(left.column(0)[2 * node]), 1.0 / std::sqrt(7.0), 1e-14);
      EXPECT_NEAR(left.column(0)[2 * node + 1], 0.0, 1e-14);
    }
    for (const MatrixEntry& entry : spring(0, 0.6, 0.8, stiffness))
      springs.push_back(entry);
    EXPECT_EQ(feti::keptKernel(motions, makeLocalMatrix(14, springs)).columns, 0);
  }
  EXPECT_EQ(feti::keptKernel(motions, makeLocalMatrix(14, {})).columns, 3);
}

TEST(Kernel, scalar_body_is_held_by_one_dof) {
  EXPECT_EQ(feti::heldKernel(feti::constantKernel(10000), {17}).columns, 0);
  EXPECT_EQ(feti::heldKernel(feti::constantKernel(10000), {}).columns, 1);
}

TEST(Kernel, dependent_motions_are_refused) {
  Kernel kernel = planeMotions(4);
  for (int i = 0; i < kernel.rows; ++i)
    kernel.values[static_cast<std::size_t>(2 * kernel.rows + i)] = kernel.values[static_cast<std::size_t>(i)];
  EXPECT_THROW(feti::heldKernel(kernel, {}), NumericalError);
}

} // namespace test_kernel
