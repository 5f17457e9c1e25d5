// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Adds the parts that the scene's rules choose to the sets and sides of the subdomains; as with all parts,
/// every copy of a node is in them, in subdomains that only touch the part, too. Costs nothing without rules.
///
/// Guarded by tests/unit/scene/test_boundary_rules.cpp.
///
/// @throws InputError on all ranks for rules that choose nothing, telling which condition is met by how many
/// sides; for names that are taken, and for parts that are not there.
/// @note Collective.
void chooseBoundaryParts(const Teuchos::Comm<int>& comm, const Scene& scene,
                         std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
