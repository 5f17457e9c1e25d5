// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BodyForce.hpp"

#include "Harmos_DeckPlaces.hpp"
#include "Harmos_Errors.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfBodyForce() {
  ParameterSpec spec("<force>", "A force on the volume of a body.");
  spec.text("Body", "", "Name of the body. Required.");
  spec.reals("Density", {0.0, 0.0, 0.0}, Range(),
             "Force per volume along x, y, z. Membranes: force per area, the first number alone.");
  return {BodyForce::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            const int body = bodyIn(scene, list, "Body", path);
            const fem::Point density = pointIn(list, "Density");
            if (scene.physics != scene::Physics::Membrane)
              return std::make_shared<BodyForce>(body, density, scene::nameIn(path));
            constexpr double all = 1e300;
            const std::vector<fem::BoxLoad> everywhere = {{density[0], {-all, -all}, {all, all}}};
            return std::make_shared<BodyForce>(body, everywhere, scene::nameIn(path));
          },
          true};
}

BodyForce::BodyForce(int body, const fem::Point& density, std::string name)
    : Effect(kindName, std::move(name)),
      body_(body),
      isUniform_(true),
      density_([density](const fem::Point&) { return density; }) {}

BodyForce::BodyForce(int body, fem::VectorField density, std::string name)
    : Effect(kindName, std::move(name)), body_(body), density_(std::move(density)) {}

BodyForce::BodyForce(int body, std::vector<fem::BoxLoad> loads, std::string name)
    : Effect(kindName, std::move(name)), body_(body), boxes_(std::move(loads)) {}

void BodyForce::check(const scene::Scene& scene) const {
  const bool isMembrane = scene.physics == scene::Physics::Membrane;
  if (isMembrane == static_cast<bool>(density_))
    throw InputError(label() + " is " +
                     (isMembrane ? "per volume, but the body is a membrane"
                                 : "that of a membrane, but the body is elastic"));
}

// A membrane's key is what its boxes look like from within the subdomain: cut to it, relative to its anchor.
std::optional<scene::Effect::Key> BodyForce::loadKey(const scene::Scene&,
                                                     const scene::OwnedSubdomain& subdomain) const {
  if (density_)
    return isUniform_ ? Key() : ownKey(subdomain);
  Key key;
  for (const fem::BoxLoad& load : fem::localLoads(subdomain.mesh, boxes_))
    for (double entry : {load.value, load.least[0], load.least[1], load.most[0], load.most[1]})
      key.push_back(entry);
  return key.empty() ? std::nullopt : std::optional<Key>(key);
}

void BodyForce::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                        std::vector<double>& load) const {
  const fem::PlacedMesh& placed = subdomain.mesh;
  addTo(load, density_ ? fem::assembleBodyForce(*placed.mesh, placed.anchor, density_,
                                                scene.bodies[static_cast<std::size_t>(body_)].integration)
                       : fem::assembleLoad(*placed.mesh, fem::localLoads(placed, boxes_)));
}

} // namespace Harmos::effects
