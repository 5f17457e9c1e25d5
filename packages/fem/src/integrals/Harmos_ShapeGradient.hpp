// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_Mesh.hpp"

#include <vector>

namespace Harmos::fem {

/// ∂(vᵀ K(x) u)/∂x at fixed nodal values u and v: of the matrix of assembleElasticity() with its quadrature,
/// so that it is the derivative of what is computed, and not only of its limit on fine meshes.
///
/// When a point of a cell moves with its nodes a by Σ V_a φ_a, gradients change by δ∇w = −∇w ∇V, and sizes by
/// div V (Sokołowski and Zolésio: Introduction to Shape Optimization, 1992, section 2). Hence for node a and
/// direction k, where the dilatation is taken as it is,
///
///     s_ak = ∫ (σ(u) : ε(v)) ∂_k φ_a − (σ(u)_mn ∂_k v_m + σ(v)_mn ∂_k u_m) ∂_n φ_a.
///
/// Where it is projected, the projection moves too; see Harmos_ShapeGradient.cpp. The axes of materials stay
/// as they are. Costs less than an assembly: no matrix is made. Local.
///
/// @param v, u dimension() numbers a node, as dofs of K.
/// @return dimension() numbers a node.
/// @throws NumericalError for inverted cells; InternalError if a region has no material, or for lists of
/// another length.
/// Guarded by tests/unit/fem/test_shape_gradient.cpp.
std::vector<double> shapeGradient(const Mesh& mesh, const Elasticity& elasticity,
                                  const std::vector<double>& v, const std::vector<double>& u);

/// Area or volume of a mesh, exact up to rounding also where cells are curved. Local.
/// @throws NumericalError for inverted cells.
double measureOf(const Mesh& mesh);

/// ∂measureOf()/∂x, dimension() numbers a node: ∫ ∂_k φ_a. Zero up to rounding at nodes within the mesh.
/// @throws NumericalError for inverted cells. Local.
std::vector<double> shapeGradientOfMeasure(const Mesh& mesh);

} // namespace Harmos::fem
