// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <vector>

namespace Harmos::fem {

/// Masses of the nodes of a mesh, a lumped mass matrix: that of each cell, ∫ρ, goes to its nodes in
/// proportion to ∫φ_i² (Hinton, Rock, Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976), which is positive
/// for every element.
///
/// Nodes in contact may be without mass: what a cell has there goes to its other nodes, so that the mass
/// stays what it is. Motions of these nodes are in equilibrium at every time then, and contact forces do not
/// oscillate (Khenous, Laborde, Renard, Eur. J. Mech. A/Solids 27, 2008). So that the body as a whole moves
/// as it did, masses m become m(1 + p(x)), p the quadratic polynomial that gives centre and moments of
/// inertia back; a linear one, for the centre alone, or none, where nodes are too few for that with masses of
/// at least a quarter of m.
/// @param density of each region, mass per volume. @param massless by node; empty: none. Cells all of whose
/// nodes are give theirs to the nodes nearest by cells.
/// @throws InputError if no node is left to take mass. Local.
/// Guarded by tests/unit/fem/test_mass.cpp.
std::vector<double> lumpedMasses(const Mesh& mesh, const std::vector<double>& density,
                                 const std::vector<char>& massless = {});

} // namespace Harmos::fem
