// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// A subdomain of a body with its mesh, on the rank that owns it.
struct OwnedSubdomain {
  long long number; ///< over all bodies
  int body;
  fem::PlacedMesh mesh;
};

/// The subdomains of this rank: blocks of consecutive numbers, as equal as possible; ranks beyond the number
/// of subdomains have none. Local.
std::vector<OwnedSubdomain> decompose(const Scene& scene, int rank, int ranks);

/// Stiffness, load, kernel and Dirichlet conditions of each. Subdomains that share a mesh share the matrix.
/// Local.
std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
