// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Surface.hpp"

#include <vector>

namespace Harmos::contact::Details {

/// The normals of the smooth sides that meet at sharp edges, at each node of each facet: averaged over the
/// facets of one side, weighted by their areas, as Surface::normals are over all. Two facets with a joint at
/// a node belong to one side of it if they meet at less than sharpestAngle.
/// @param inside nodes around which all facets are here; at others normals stay those of the surface.
/// @return empty if nothing is sharp here. Local.
std::vector<fem::Point> sideNormalsOf(const Surface& surface, const std::vector<char>& inside);

} // namespace Harmos::contact::Details
