// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Surface.hpp"

#include <optional>
#include <vector>

namespace Harmos::contact {

/// Where a surface lies so deeply in another body that a search along its normals misses that body's
/// boundary: a place x of the surface such that the body fills the way from x to x − depth·n. Looked for at
/// the middle of each facet and half-way to its corners.
///
/// Cost: linear in this rank's facets and cells of the body; what is near goes to all ranks.
/// @param body this rank's subdomains of it, on any rank. @param depth above 0.
/// @return the same on all ranks; nothing where surface and body do not overlap so.
/// @note Collective.
/// Guarded by tests/unit/contact/test_overlap.cpp.
std::optional<fem::Point> deepOverlap(const Surface& surface, const std::vector<const fem::PlacedMesh*>& body,
                                      double depth);

} // namespace Harmos::contact
