// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_PointLocator.hpp"

#include <array>
#include <functional>
#include <vector>

namespace Harmos::fem {

/// ∫|u_h − u|² and the energy product of the error over the mesh.
struct SquaredErrors {
  double l2 = 0.0;
  double energy = 0.0;
};

/// Twice the energy density of a displacement gradient, in a region of the mesh: ε : C : ε, or |∇u|².
using EnergyDensity = std::function<double(int region, const std::array<Point, 3>& gradient)>;
/// Of the strains as they are, also where the stiffness matrix projects the dilatation.
EnergyDensity elasticEnergy(const Elasticity& elasticity);
EnergyDensity membraneEnergy();

/// What u_h is compared with, at quadrature point q of a cell, which lies at x.
using FieldSample = std::function<FieldValue(int cell, int q, const Point& x)>;

/// The rule that integrates energies as the stiffness matrix does, and squares of displacements exactly on
/// affine cells.
int errorDegree(CellType type);

/// The error of a nodal field, displacement[node · components + component], by a rule of the given degree.
/// Guarded by tests/unit/fem/test_point_locator.cpp.
SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, int degree, int components,
                            const std::vector<double>& displacement, const EnergyDensity& energy,
                            const FieldSample& other);

/// The error against an exact solution of elasticity, by a rule of high degree. For verification.
/// @param gradient of u: result[i][j] = ∂u_i/∂x_j.
SquaredErrors squaredErrors(const Mesh& mesh, const Point& anchor, const Elasticity& elasticity,
                            const std::vector<double>& displacement, const VectorField& exact,
                            const std::function<std::array<Point, 3>(const Point&)>& gradient);

} // namespace Harmos::fem
