// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"

#include <Teuchos_Comm.hpp>

#include <map>
#include <utility>
#include <vector>

namespace Harmos::scene {

/// Of each side that sides[i] has of subdomain i: the other bodies that it faces, rising.
using FacedBodies = std::vector<std::vector<std::vector<int>>>;

/// Diagonals of the boxes around the bodies; none has one of −∞. @note Collective.
std::vector<double> bodyDiagonals(const Teuchos::Comm<int>& comm, std::size_t bodies,
                                  const std::vector<OwnedSubdomain>& owned);

/// How near two bodies are to be, where nobody says it: this share of the smaller diagonal.
constexpr double usualNearness = 0.05;

/// Finds what may touch: a side of another body whose normal looks against its own, up to 60 degrees, that is
/// no further away along one of the normals, measured at the nodes, and no further aside than both sides
/// are large. Overlaps count as near, up to the same distance and half of how thick both bodies are there. No
/// side of a third body may be between.
///
/// Sides go to the ranks whose boxes around the bodies they are near; nothing is gathered but these boxes.
/// Guarded by tests/unit/scene/test_facing_sides.cpp.
///
/// @param sides of each subdomain, on the boundary of its body, see outerSides(). @param distance a length;
/// 0: usualNearness. @note Collective.
FacedBodies facedBodies(const Teuchos::Comm<int>& comm, std::size_t bodies,
                        const std::vector<OwnedSubdomain>& owned,
                        const std::vector<std::vector<fem::Side>>& sides, double distance);

/// How many sides of two bodies face the other body, by their numbers of corners.
struct FacingCounts {
  std::map<std::size_t, long long> first, second;
};

/// By pairs of bodies, the lower number first. @note Collective; the same on all ranks.
std::map<std::pair<int, int>, FacingCounts> facingPairs(const Teuchos::Comm<int>& comm, std::size_t bodies,
                                                        const std::vector<OwnedSubdomain>& owned,
                                                        double distance);

} // namespace Harmos::scene
