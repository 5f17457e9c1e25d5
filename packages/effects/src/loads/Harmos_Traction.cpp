// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Traction.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfTraction() {
  ParameterSpec spec("<traction>", "A distributed force on a boundary part.");
  spec.text("Part", "", "\"body/boundary part\" under load. Required.");
  spec.reals("Density", {0.0, 0.0, 0.0}, Range(), "Force per area along x, y, z; independent of the normal.");
  spec.real("Pressure", 0.0, Range(),
            "Force per area against the outward normal; of finite "
            "kinematics of the deformed body.");
  return {Traction::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            const Part part = partIn(scene, list, "Part", path);
            const fem::Point density = pointIn(list, "Density");
            const double pressure = list.get<double>("Pressure");
            const bool hasDensity = density != fem::Point{};
            const auto constant = [density](const fem::Point&, const fem::Point&) { return density; };
            return std::make_shared<Traction>(part, hasDensity ? fem::Traction(constant) : nullptr, pressure,
                                              scene::nameIn(path));
          },
          true};
}

Traction::Traction(Part part, fem::Traction density, std::string name)
    : Traction(std::move(part), std::move(density), 0.0, std::move(name)) {}

Traction::Traction(Part part, fem::Traction density, double pressure, std::string name)
    : Effect(kindName, std::move(name)),
      part_(std::move(part)),
      density_(std::move(density)),
      pressure_(pressure) {}

std::optional<scene::Effect::Key> Traction::loadKey(const scene::Scene&,
                                                    const scene::OwnedSubdomain& subdomain) const {
  const bool hasSides = subdomain.mesh.sides.count(part_.set) > 0;
  return hasSides ? std::optional<Key>(ownKey(subdomain)) : std::nullopt;
}

void Traction::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                       std::vector<double>& load) const {
  const bool hasPressure = pressure_ != 0.0 && !scene.isFinite();
  if (!density_ && !hasPressure)
    return;
  const fem::PlacedMesh& placed = subdomain.mesh;
  const auto total = [&](const fem::Point& x, const fem::Point& normal) {
    fem::Point t = density_ ? density_(x, normal) : fem::Point{};
    for (std::size_t d = 0; d < 3 && hasPressure; ++d)
      t[d] -= pressure_ * normal[d];
    return t;
  };
  addTo(load, fem::assembleTraction(*placed.mesh, placed.anchor, placed.sides.at(part_.set), total));
}

void Traction::addFollowingLoad(const scene::Scene&, const Deformed& subdomain,
                                std::vector<double>& load) const {
  const fem::PlacedMesh& placed = subdomain.now.mesh;
  const auto sides = placed.sides.find(part_.set);
  if (sides == placed.sides.end())
    return;
  const auto total = [&](const fem::Point&, const fem::Point& normal) {
    return fem::Point{-pressure_ * normal[0], -pressure_ * normal[1], -pressure_ * normal[2]};
  };
  addTo(load, fem::assembleTraction(*placed.mesh, placed.anchor, sides->second, total));
}

} // namespace Harmos::effects
