// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_Loads.hpp"

#include <array>
#include <functional>
#include <vector>

namespace Harmos::fem {

/// ∫|u_h − u|² and the energy product of the error ∫ (ε(u_h) − ε) : C : (ε(u_h) − ε), over the mesh, by a
/// rule of high degree. For verification.
struct SquaredErrors {
  double l2 = 0.0;
  double energy = 0.0;
};
/// @param gradient of u: result[i][j] = ∂u_i/∂x_j.
SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, const Elasticity& elasticity,
                            const std::vector<double>& displacement, const VectorField& exact,
                            const std::function<std::array<Point, 3>(const Point&)>& gradient);

} // namespace Harmos::fem
