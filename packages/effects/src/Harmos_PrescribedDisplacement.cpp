// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PrescribedDisplacement.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::effects {
namespace {

std::shared_ptr<const scene::Effect> makePrescribedDisplacement(const Teuchos::ParameterList& list,
                                                                const std::string& path,
                                                                const scene::Scene& scene) {
  const Part part = partIn(scene, list, "Part", path);
  const fem::Point value = pointIn(list, "Displacement");
  std::vector<PrescribedDisplacement::Component> held;
  for (const std::string& component : list.get<Teuchos::Array<std::string>>("Components")) {
    const std::size_t c = std::string("xyz").find(component);
    if (component.size() != 1 || c == std::string::npos)
      throw InputError("\"" + path + "/Components\" contains \"" + component +
                           "\", expected \"x\", \"y\" or \"z\"",
                       {{"path", path + "/Components"}});
    // In the plane z is held already.
    if (static_cast<int>(c) < scene.components())
      held.push_back({static_cast<int>(c), value[c]});
  }
  if (held.empty())
    throw InputError("\"" + path +
                         "/Components\" names no component of this physics; membranes have \"x\", plane "
                         "scenes \"x\" and \"y\"",
                     {{"path", path + "/Components"}});
  return std::make_shared<PrescribedDisplacement>(part, held, scene::nameIn(path));
}

} // namespace

scene::EffectKind kindOfPrescribedDisplacement() {
  ParameterSpec spec("<displacement>", "A boundary part has given displacements.");
  spec.text("Part", "", "\"body/boundary part\" that is held. Required.");
  spec.texts("Components", {"x", "y", "z"},
             "Components that are held; the others are free. Membranes have \"x\" alone.");
  spec.reals("Displacement", {0.0, 0.0, 0.0}, Range(),
             "Displacements along x, y, z; those of other components are not used.");
  return {PrescribedDisplacement::kindName, spec, makePrescribedDisplacement, true};
}

PrescribedDisplacement::PrescribedDisplacement(Part part, std::vector<Component> components, std::string name)
    : Effect(kindName, std::move(name)), part_(std::move(part)), components_(std::move(components)) {}

void PrescribedDisplacement::check(const scene::Scene& scene) const {
  for (const Component& held : components_)
    if (held.component < 0 || held.component >= scene.components())
      throw InputError(label() + " of body \"" + scene.bodies[static_cast<std::size_t>(part_.body)].name +
                       "\" prescribes component " + std::to_string(held.component) +
                       ", but the number of components per node is " + std::to_string(scene.components()));
}

void PrescribedDisplacement::addPrescribed(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                                           std::vector<feti::FixedDof>& fixed) const {
  const auto set = subdomain.mesh.sets.find(part_.set);
  if (set == subdomain.mesh.sets.end())
    return;
  for (const Component& held : components_)
    for (int node : set->second)
      fixed.push_back({node * scene.components() + held.component,
                       held.field ? held.field(subdomain.mesh.position(node)) : held.value});
}

std::shared_ptr<const PrescribedDisplacement> hold(const Part& part, int component, double value) {
  return std::make_shared<PrescribedDisplacement>(
      part, std::vector<PrescribedDisplacement::Component>{{component, value}}, part.set);
}

} // namespace Harmos::effects
