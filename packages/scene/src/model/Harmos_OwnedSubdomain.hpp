// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

namespace Harmos::scene {

/// What a boundary part of a body is as a whole: the same on every rank.
struct PartMeasure {
  double area = 0.0;   ///< length in the plane, times the thickness; around the axis of axisymmetric scenes
  fem::Point normal{}; ///< ∫n, outward
};

/// A subdomain of a body with its mesh, on the rank that owns it.
struct OwnedSubdomain {
  long long number; ///< over all bodies
  int body;
  fem::PlacedMesh mesh;
  /// Of boundary parts whose nodes an effect counts (Effect::BoundaryPart): those of its nodes of which no
  /// subdomain of a lower number has a copy, rising.
  std::map<std::string, std::vector<int>> ownNodes = {};
  /// Of boundary parts that an effect measures (Effect::BoundaryPart).
  std::map<std::string, PartMeasure> measures = {};
};

} // namespace Harmos::scene
