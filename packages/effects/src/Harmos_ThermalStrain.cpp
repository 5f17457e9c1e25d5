// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ThermalStrain.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfThermalStrain() {
  ParameterSpec spec("<temperature>", "A body has another temperature than in its stress-free state.");
  spec.text("Body", "", "Name of the body. Required.");
  spec.real("Temperature", 0.0, Range(),
            "Rise of temperature in degrees; negative: cooling. Several effects add up.");
  return {ThermalStrain::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            return std::make_shared<ThermalStrain>(bodyIn(scene, list, "Body", path),
                                                   list.get<double>("Temperature"), scene::nameIn(path));
          },
          true};
}

ThermalStrain::ThermalStrain(int body, double rise, std::string name)
    : Effect(kindName, std::move(name)), body_(body), rise_(rise) {}

// The same in all subdomains of a mesh: the rise is uniform.
std::optional<scene::Effect::Key> ThermalStrain::loadKey(const scene::Scene&,
                                                         const scene::OwnedSubdomain&) const {
  return Key();
}

void ThermalStrain::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                            std::vector<double>& load) const {
  const scene::Body& body = scene.bodies[static_cast<std::size_t>(body_)];
  addTo(load, fem::assembleThermalLoad(*subdomain.mesh.mesh, elasticityOf(scene, body), rise_));
}

} // namespace Harmos::effects
