// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

namespace Harmos::scene {

/// A subdomain of a body with its mesh, on the rank that owns it.
struct OwnedSubdomain {
  long long number; ///< over all bodies
  int body;
  fem::PlacedMesh mesh;
  /// Of boundary parts whose nodes an effect counts (Effect::BoundaryPart): those of its nodes of which no
  /// subdomain of a lower number has a copy, rising.
  std::map<std::string, std::vector<int>> ownNodes = {};
};

} // namespace Harmos::scene
