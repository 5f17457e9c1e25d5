// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <vector>

namespace Harmos::scene {

/// An order of places such that consecutive groups of the given sizes are compact: by recursive sections
/// across the longest side of the box of what is left, into as many pieces as divide the number of groups.
/// Places of a group follow each other by their numbers.
/// @param sizes of the groups; they add up to the number of places.
/// @return place by position. Local. Guarded by tests/unit/scene/test_compact_order.cpp.
std::vector<int> compactOrder(const std::vector<fem::Point>& places, const std::vector<long long>& sizes);

} // namespace Harmos::scene
