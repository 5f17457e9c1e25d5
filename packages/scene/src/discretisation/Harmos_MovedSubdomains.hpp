// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <vector>

namespace Harmos::scene {

/// The subdomains of deformed bodies: meshes of their own, with nodes at X + u, and the same boundary parts.
/// @param displacement of each subdomain. Local.
std::vector<OwnedSubdomain> moved(const std::vector<OwnedSubdomain>& atRest,
                                  const feti::TornVector& displacement);

} // namespace Harmos::scene
