// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Kernel.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <array>
#include <functional>
#include <vector>

namespace Harmos {

/// An elastic block on a grid of n cells a direction: its stiffness and its rigid body modes.
///
/// The elements are trusses along edges and diagonals of the cells (stiffness EA/length): as a solid it has
/// exactly the rigid motions of the plane (3) or of space (6) for a kernel, which is what the tests need.
struct TestSolid {
  LocalMatrix stiffness;
  feti::Kernel motions;
  std::vector<std::array<double, 3>> nodes;
  int dimension;
};

/// @param dimension 2 or 3. @param isHinge two such blocks side by side, joined at one node.
TestSolid testSolid(int dimension, int n, double modulus = 1.0, bool isHinge = false);

} // namespace Harmos
