// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_Mesh.hpp"

#include <functional>
#include <vector>

namespace Harmos::fem {

/// A vector field in space: density of a force, a displacement. The position is the global one.
using VectorField = std::function<Point(const Point&)>;

/// f_i = ∫ b φ_i of a body force. @param anchor of the mesh: the field is given globally. @param integration
/// that of the stiffness, whose points a reduced one takes.
std::vector<double> assembleBodyForce(const Mesh& mesh, const Point& anchor, const VectorField& force,
                                      Integration integration = Integration::Full);

/// The same of a body that has moved: b of where it is, over the body at rest. @param displacement of all
/// nodes.
std::vector<double> assembleMovedBodyForce(const Mesh& mesh, const Point& anchor,
                                           const std::vector<double>& displacement, const VectorField& force,
                                           Integration integration = Integration::Full);

/// A quadrature point of a side.
struct SidePoint {
  std::vector<int> nodes;     ///< of the side
  std::vector<double> values; ///< of their basis functions
  Point position{};           ///< relative to the mesh's anchor
  Point normal{};             ///< outward, of length one
  double measure = 0.0;       ///< weight · area, times Mesh::around(): Σ measure · f = ∫ f
};

/// Visits the points of a quadrature rule on each side.
/// @param degree of the polynomials on the reference side that the rule integrates exactly.
void visitSides(const Mesh& mesh, const std::vector<Side>& sides, int degree,
                const std::function<void(const SidePoint&)>& visit);

/// f_i = ∫ t φ_i over sides, of a force per area, which may depend on the outward unit normal.
using Traction = std::function<Point(const Point& position, const Point& normal)>;
std::vector<double> assembleTraction(const Mesh& mesh, const Point& anchor, const std::vector<Side>& sides,
                                     const Traction& traction);

} // namespace Harmos::fem
