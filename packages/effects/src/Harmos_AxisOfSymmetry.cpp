// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AxisOfSymmetry.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos::effects {

AxisOfSymmetry::AxisOfSymmetry(std::size_t bodies) : Effect(kindName, ""), bodies_(bodies) {
  std::iota(bodies_.begin(), bodies_.end(), 0);
}

void AxisOfSymmetry::check(const scene::Scene& scene) const {
  if (scene.physics != scene::Physics::Axisymmetric)
    throw InputError(label() + " needs an axisymmetric scene");
}

void AxisOfSymmetry::addPrescribed(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                                   std::vector<feti::FixedDof>& fixed) const {
  const fem::Mesh& mesh = *subdomain.mesh.mesh;
  double extent = 0.0;
  for (double x : mesh.coordinates)
    extent = std::max(extent, std::abs(x));
  constexpr double rounding = 1e-12; // of coordinates
  for (int node : mesh.boundary)
    if (mesh.local(node)[0] <= rounding * extent)
      fixed.push_back({node * scene.components(), 0.0});
}

} // namespace Harmos::effects
