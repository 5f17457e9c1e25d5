// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Drift.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::run {
namespace {

// The longest side of a box around the bodies.
double extentOf(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned) {
  std::vector<double> ends(6, -std::numeric_limits<double>::infinity()); // −x, −y, −z, x, y, z at most
  for (const scene::OwnedSubdomain& item : owned)
    for (const int node : item.mesh.mesh->boundary) {
      const fem::Point x = item.mesh.position(node);
      for (std::size_t d = 0; d < 3; ++d) {
        ends[d] = std::max(ends[d], -x[d]);
        ends[3 + d] = std::max(ends[3 + d], x[d]);
      }
    }
  globalMax(comm, ends);
  double extent = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    extent = std::max(extent, ends[d] + ends[3 + d]);
  return extent;
}

} // namespace

std::string driftText(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                      const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& u) {
  std::vector<double> largest(scene.bodies.size(), 0.0);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (const double value : u[i]) {
      double& ofBody = largest[static_cast<std::size_t>(owned[i].body)];
      ofBody = std::max(ofBody, std::abs(value));
    }
  globalMax(comm, largest);
  const double extent = extentOf(comm, owned), farthest = *std::max_element(largest.begin(), largest.end());
  if (!(farthest > extent))
    return "";
  std::string names;
  for (std::size_t b = 0; b < largest.size(); ++b)
    if (largest[b] > extent)
      names += (names.empty() ? "\"" : ", \"") + scene.bodies[b].name + "\"";
  return "drift: " + names + " moved by up to " + scientific(farthest) + " in a scene of size " +
         scientific(extent) +
         ": nothing holds a rigid-body mode but rounding errors of normals; prescribe a displacement in that "
         "direction, or give the contact friction";
}

} // namespace Harmos::run
