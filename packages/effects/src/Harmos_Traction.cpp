// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Traction.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfTraction() {
  ParameterSpec spec("<traction>", "A distributed force on a boundary part.");
  spec.text("Part", "", "\"body/boundary part\" under load. Required.");
  spec.reals("Density", {0.0, 0.0, 0.0}, Range(), "Force per area along x, y, z; independent of the normal.");
  spec.real("Pressure", 0.0, Range(), "Force per area against the outward normal.");
  return {Traction::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            const Part part = partIn(scene, list, "Part", path);
            const fem::Point density = pointIn(list, "Density");
            const double pressure = list.get<double>("Pressure");
            const auto total = [density, pressure](const fem::Point&, const fem::Point& normal) {
              fem::Point t = density;
              for (std::size_t d = 0; d < 3; ++d)
                t[d] -= pressure * normal[d];
              return t;
            };
            return std::make_shared<Traction>(part, total, scene::nameIn(path));
          },
          true};
}

Traction::Traction(Part part, fem::Traction density, std::string name)
    : Effect(kindName, std::move(name)), part_(std::move(part)), density_(std::move(density)) {}

std::optional<scene::Effect::Key> Traction::loadKey(const scene::Scene&,
                                                    const scene::OwnedSubdomain& subdomain) const {
  const bool hasSides = subdomain.mesh.sides.count(part_.set) > 0;
  return hasSides ? std::optional<Key>(ownKey(subdomain)) : std::nullopt;
}

void Traction::addLoad(const scene::Scene&, const scene::OwnedSubdomain& subdomain,
                       std::vector<double>& load) const {
  const fem::PlacedMesh& placed = subdomain.mesh;
  addTo(load, fem::assembleTraction(*placed.mesh, placed.anchor, placed.sides.at(part_.set), density_));
}

} // namespace Harmos::effects
