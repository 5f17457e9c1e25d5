// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Force.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfForce() {
  ParameterSpec spec("<force>", "A force at each node of a part, as of a group of points of the mesh file.");
  spec.text("Part", "", "\"body/boundary part\" with the nodes. Required.");
  spec.reals("Force", {0.0, 0.0, 0.0}, Range(),
             "Force along x, y, z at each node; in plane scenes per thickness, the third is not used.");
  return {Force::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            return std::make_shared<Force>(partIn(scene, list, "Part", path), pointIn(list, "Force"),
                                           scene::nameIn(path));
          },
          true};
}

Force::Force(Part part, const fem::Point& force, std::string name)
    : Effect(kindName, std::move(name)), part_(std::move(part)), force_(force) {}

std::optional<scene::Effect::Key> Force::loadKey(const scene::Scene&,
                                                 const scene::OwnedSubdomain& subdomain) const {
  const bool hasNodes = subdomain.ownNodes.count(part_.set) > 0;
  return hasNodes ? std::optional<Key>(ownKey(subdomain)) : std::nullopt;
}

void Force::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                    std::vector<double>& load) const {
  const auto components = static_cast<std::size_t>(scene.components());
  for (int node : subdomain.ownNodes.at(part_.set))
    for (std::size_t c = 0; c < components; ++c)
      load[static_cast<std::size_t>(node) * components + c] += force_[c];
}

} // namespace Harmos::effects
