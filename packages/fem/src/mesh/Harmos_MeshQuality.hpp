// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <limits>
#include <string>
#include <vector>

namespace Harmos::fem {

/// How good a cell is, and where it is worst: at most 1; not above 0: it is tangled.
struct CellQuality {
  int cell = -1; ///< none: there are no cells
  Point place{}; ///< of the sample where the quality is least, absolute
  double quality = std::numeric_limits<double>::infinity(); ///< of no cells: worse than that is any cell

  bool isTangled() const { return !(quality > 0.0); }
};

/// The scaled Jacobian of each cell, as Verdict has it (Stimpson et al.: The Verdict Geometric Quality
/// Library, SAND2007-1751; Knupp: Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23, 2001), for cells
/// of second order at more places: the least, over the samples, of
///
///     det J / max(mean of det J over the cell, product of the lengths of the sides of the frame of J).
///
/// Samples are the cell's nodes and the points of stiffness matrices. The frame is that of the columns of J;
/// on simplices that of the reference edges from the corner for which the product is largest, times the
/// factor that gives equilateral cells 1. So rectangles and bricks have 1 whatever their sides, skew ones the
/// sine of their angle. The mean sees nodes amid edges that run along these towards a corner, to which angles
/// are blind. A cell with a quality above zero is one that matrices are assembled of. Cells that have no size
/// have 0; coordinates that are not finite, −∞. Local. Guarded by tests/unit/fem/test_mesh_quality.cpp.
std::vector<double> cellQualities(const Mesh& mesh);

/// What a motion of the mesh has left of the shape of each cell: with the gradient F = J_after J_before⁻¹ of
/// the motion, the least, over the same samples, of
///
///     det F / max(size after / size before, (‖F‖² / d)^(d/2)),
///
/// the mean ratio of the mesh after with the cells before as targets (Knupp: Introducing the target-matrix
/// paradigm for mesh optimization via node-movement, Eng. Comput. 28, 2012); in space its power 3/2, which
/// needs no root of what is negative. Similar cells have 1; cells sheared by γ in the plane 1/(1 + γ²/2);
/// cells flattened to a share s of their height 2s/(1 + s²), where the scaled Jacobian of a rectangle stays 1
/// until it is tangled. What the cells before looked like does not matter; samples where these have no
/// positive Jacobian are left out. Local.
/// @throws InternalError for meshes of other cells, and for cells that are tangled before.
/// Guarded by tests/unit/fem/test_mesh_quality.cpp.
std::vector<double> cellQualities(const Mesh& before, const Mesh& after);

/// The cell of the least quality; of equal ones the first. Local.
CellQuality worstCell(const PlacedMesh& mesh);
/// The cell that a motion has harmed most, at its place after. @throws as cellQualities(). Local.
CellQuality worstCell(const PlacedMesh& before, const PlacedMesh& after);

/// "cell 12 (quadrilateral of 4 nodes) at (0.5, 0.25, 0): quality -0.1". For messages.
std::string textOf(const PlacedMesh& mesh, const CellQuality& quality);

} // namespace Harmos::fem
