// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

namespace Harmos::scene {

/// A subdomain of a body with its mesh, on the rank that owns it.
struct OwnedSubdomain {
  long long number; ///< over all bodies
  int body;
  fem::PlacedMesh mesh;
};

} // namespace Harmos::scene
