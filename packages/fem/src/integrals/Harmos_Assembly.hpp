// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"
#include "Harmos_Mesh.hpp"

#include <vector>

namespace Harmos::fem {

/// A constant load density over an axis-parallel box.
struct BoxLoad {
  double value; ///< force per area
  std::array<double, 2> least;
  std::array<double, 2> most;
};

/// Stiffness matrix of −Δ: K_ij = ∫ ∇φ_i·∇φ_j, one dof a node, no boundary conditions.
///
/// Uses relative coordinates only: congruent meshes give identical matrices.
/// @throws NumericalError for a cell with a Jacobian that is not positive (inverted, wrong orientation),
/// naming it.
LocalMatrix assembleLaplace(const Mesh& mesh);

/// The loads as a subdomain sees them: boxes cut to the bounding box of its mesh, in the mesh's coordinates;
/// those that miss it are left out. Congruent subdomains under the same load get the same answer, up to
/// rounding where a box cuts them.
std::vector<BoxLoad> localLoads(const PlacedMesh& placed, const std::vector<BoxLoad>& loads);

/// Load vector f_i = ∫ f φ_i of box loads in the mesh's coordinates, integrated element-exactly: a cell that
/// a box cuts is clipped, and only the part inside is integrated, so that the answer does not depend on
/// whether the mesh resolves the jump. Exact for parallelograms. Meshes of other cells than quadrilaterals of
/// four nodes take loads that cut none of them.
/// Guarded by tests/unit/fem/test_assembly.cpp.
std::vector<double> assembleLoad(const Mesh& mesh, const std::vector<BoxLoad>& loads);

} // namespace Harmos::fem
