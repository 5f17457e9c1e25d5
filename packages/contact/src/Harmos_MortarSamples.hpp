// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Facet.hpp"

#include <vector>

namespace Harmos::contact {

/// A quadrature point of the part of a facet that has a counterpart on the other surface.
struct MortarSample {
  FacetPlace place; ///< on the facet of the first surface
  int opposite;     ///< facet of the second surface
  FacetPlace oppositePlace;
  double weight; ///< of the quadrature, with the measure of the first surface; positive
  double gap;    ///< along the normal of the first surface
};

/// Quadrature of one facet of the first surface, cut where the facets of the second one begin and end, so
/// that all integrands are smooth between the cuts. Candidates are those facets of the second surface that
/// are near enough to count; parts whose least distance exceeds `reach`, and facets that do not face each
/// other, give no samples.
/// @throws InputError for facets so distorted that a point of theirs cannot be found again.

/// In the plane: cut at the projections of nodes along the averaged normals of the first surface. Where
/// several facets of the second surface lie behind each other, the nearest counts.
std::vector<MortarSample> planeSamples(const Surface& first, int facet, const Surface& second,
                                       const std::vector<int>& candidates, double reach);

/// In space: polygons of the corners, clipped in the plane of the facet of the first surface at its centre.
/// Facets are taken as convex, and their sides of second order as straight: bends give slivers that are
/// counted twice or not at all. Facets at more than 84 degrees to each other do not face.
std::vector<MortarSample> spaceSamples(const Surface& first, int facet, const Surface& second,
                                       const std::vector<int>& candidates, double reach);

} // namespace Harmos::contact
