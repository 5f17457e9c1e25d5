// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_InitialVelocity.hpp"

#include "Harmos_DeckPlaces.hpp"
#include "Harmos_Errors.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfInitialVelocity() {
  ParameterSpec spec("<motion>", "Velocities of a body when a transient run begins.");
  spec.text("Body", "", "Name of the body. Required.");
  spec.reals("Velocity", {0.0, 0.0, 0.0}, Range(), "Velocity along x, y, z at \"Centre\".");
  spec.reals("Angular velocity", {0.0, 0.0, 0.0}, Range(),
             "Radians per time about the axes x, y, z; in the plane about z alone.");
  spec.reals("Centre", {0.0, 0.0, 0.0}, Range(), "A point that has the velocity \"Velocity\".");
  return {InitialVelocity::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            const InitialVelocity::Motion motion = {
                pointIn(list, "Velocity"), pointIn(list, "Angular velocity"), pointIn(list, "Centre")};
            return std::make_shared<InitialVelocity>(bodyIn(scene, list, "Body", path), motion,
                                                     scene::nameIn(path));
          },
          false};
}

InitialVelocity::InitialVelocity(int body, const Motion& motion, std::string name)
    : Effect(kindName, std::move(name)), body_(body), motion_(motion) {}

void InitialVelocity::check(const scene::Scene& scene) const {
  if (!scene.isTransient())
    throw InputError(label() + " is for transient runs; set \"Steps/Time integration\" = \"Newmark\"",
                     {{"path", "Steps/Time integration"}});
  const fem::Point &v = motion_.velocity, &w = motion_.angularVelocity;
  const bool isPlane = scene.components() == 2, isRound = scene.physics == scene::Physics::Axisymmetric;
  if (isPlane && (v[2] != 0.0 || w[0] != 0.0 || w[1] != 0.0))
    throw InputError(label() +
                     " leaves the plane; it has velocities along x and y and an angular one about z");
  if (isRound && (v[0] != 0.0 || w[2] != 0.0))
    throw InputError(label() + ": bodies of revolution move along their axis, y, alone");
}

void InitialVelocity::addVelocity(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                                  std::vector<double>& velocity) const {
  const auto components = static_cast<std::size_t>(scene.components());
  for (int node = 0; node < subdomain.mesh.mesh->numberOfNodes(); ++node) {
    const fem::Point arm = difference(subdomain.mesh.position(node), motion_.centre);
    const fem::Point& w = motion_.angularVelocity;
    for (std::size_t d = 0; d < components; ++d)
      velocity[static_cast<std::size_t>(node) * components + d] +=
          motion_.velocity[d] + w[(d + 1) % 3] * arm[(d + 2) % 3] - w[(d + 2) % 3] * arm[(d + 1) % 3];
  }
}

} // namespace Harmos::effects
