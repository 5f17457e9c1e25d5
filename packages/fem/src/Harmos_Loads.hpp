// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <functional>
#include <vector>

namespace Harmos::fem {

/// A vector field in space: density of a force, a displacement. The position is the global one.
using VectorField = std::function<Point(const Point&)>;

/// f_i = ∫ b φ_i of a body force. @param anchor of the mesh: the field is given globally.
std::vector<double> assembleBodyForce(const Mesh& mesh, const Point& anchor, const VectorField& force);

/// f_i = ∫ t φ_i over sides, of a force per area, which may depend on the outward unit normal.
using Traction = std::function<Point(const Point& position, const Point& normal)>;
std::vector<double> assembleTraction(const Mesh& mesh, const Point& anchor, const std::vector<Side>& sides,
                                     const Traction& traction);

} // namespace Harmos::fem
