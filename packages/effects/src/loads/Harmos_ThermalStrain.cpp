// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ThermalStrain.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfThermalStrain() {
  ParameterSpec spec("<temperature>", "A body has another temperature than in its stress-free state.");
  spec.text("Body", "", "Name of the body. Required.");
  spec.real("Temperature", 0.0, Range(),
            "Rise of temperature in degrees; negative: cooling. Several effects add up.");
  spec.text(
      "Field", "",
      "Name of a nodal field of the mesh file with the rise at each node, in the place of \"Temperature\": "
      "$NodeData of a .msh file.");
  return {ThermalStrain::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            const std::string field = list.get<std::string>("Field");
            if (!field.empty() && list.get<double>("Temperature") != 0.0)
              throw InputError("\"" + path + "\" has a \"Field\" and a \"Temperature\"; give one of them",
                               {{"path", path}});
            if (!field.empty())
              return std::make_shared<ThermalStrain>(bodyIn(scene, list, "Body", path), field,
                                                     scene::nameIn(path));
            return std::make_shared<ThermalStrain>(bodyIn(scene, list, "Body", path),
                                                   list.get<double>("Temperature"), scene::nameIn(path));
          },
          true};
}

ThermalStrain::ThermalStrain(int body, double rise, std::string name)
    : Effect(kindName, std::move(name)), body_(body), rise_(rise) {}

// The same in all subdomains of a mesh: the rise is uniform.
ThermalStrain::ThermalStrain(int body, std::string field, std::string name)
    : Effect(kindName, std::move(name)), body_(body), field_(std::move(field)) {}

std::optional<scene::Effect::Key> ThermalStrain::loadKey(const scene::Scene&,
                                                         const scene::OwnedSubdomain& subdomain) const {
  return field_.empty() ? Key() : ownKey(subdomain);
}

void ThermalStrain::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                            std::vector<double>& load) const {
  if (scene.iterates())
    return;
  const scene::Body& body = scene.bodies[static_cast<std::size_t>(body_)];
  const fem::Mesh& mesh = *subdomain.mesh.mesh;
  if (field_.empty())
    addTo(load, fem::assembleThermalLoad(mesh, elasticityOf(scene, body), rise_));
  else
    addTo(load, fem::assembleThermalLoad(mesh, elasticityOf(scene, body),
                                         nodalField(scene, subdomain, field_, label())));
}

} // namespace Harmos::effects
