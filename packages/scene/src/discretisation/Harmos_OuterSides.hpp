// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Of each subdomain, the sides of cells on its body's boundary: those that no other cell has, in this or in
/// another subdomain. Sorted by cell. They meet at the ranks that their corners' numbers name; nothing is
/// gathered.
/// @note Collective.
std::vector<std::vector<fem::Side>> outerSides(const Teuchos::Comm<int>& comm,
                                               const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
