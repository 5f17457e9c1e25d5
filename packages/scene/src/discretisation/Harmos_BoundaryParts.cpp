// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryParts.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_NearestName.hpp"

#include <algorithm>

namespace Harmos::scene {

// Names travel as text, a line each.
PartNames gatherPartNames(const Teuchos::Comm<int>& comm, std::size_t bodies,
                          const std::vector<OwnedSubdomain>& owned) {
  std::set<std::string> lines;
  for (const OwnedSubdomain& item : owned) {
    for (const auto& set : item.mesh.sets)
      lines.insert(std::to_string(item.body) + " n" + set.first + '\n');
    for (const auto& sides : item.mesh.sides)
      lines.insert(std::to_string(item.body) + " s" + sides.first + '\n');
  }
  std::vector<char> text;
  for (const std::string& line : lines)
    text.insert(text.end(), line.begin(), line.end());
  PartNames names;
  names.all.resize(bodies);
  names.withSides.resize(bodies);
  const std::vector<char> all = gatherAll(comm, text);
  for (auto begin = all.begin(); begin != all.end();) {
    const auto space = std::find(begin, all.end(), ' '), end = std::find(begin, all.end(), '\n');
    const std::size_t body = std::stoul(std::string(begin, space));
    names.all[body].insert(std::string(space + 2, end));
    if (*(space + 1) == 's')
      names.withSides[body].insert(std::string(space + 2, end));
    begin = end + 1;
  }
  return names;
}

namespace {

std::vector<std::string> rulesFirst(const Scene& scene, std::set<std::string> names) {
  std::vector<std::string> result;
  for (const fem::BoundaryRule& rule : scene.boundaryRules)
    if (names.erase(rule.name) > 0)
      result.push_back(rule.name);
  result.insert(result.end(), names.begin(), names.end());
  return result;
}

} // namespace

std::vector<PartSummary> boundaryPartsOf(const Teuchos::Comm<int>& comm, const Scene& scene,
                                         const std::vector<OwnedSubdomain>& owned) {
  const PartNames names = gatherPartNames(comm, scene.bodies.size(), owned);
  std::vector<PartSummary> parts;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    for (const std::string& name : rulesFirst(scene, names.all[b])) {
      fem::SidesGeometry geometry;
      for (const OwnedSubdomain& item : owned)
        if (const auto sides = item.mesh.sides.find(name);
            item.body == static_cast<int>(b) && sides != item.mesh.sides.end())
          for (const fem::Side& side : sides->second)
            geometry.add(fem::geometryOf(item.mesh, side));
      parts.push_back({scene.bodies[b].name, name, fem::overAll(comm, geometry)});
    }
  return parts;
}

namespace {

void requireBody(const Scene& scene, int body, const std::string& what) {
  if (body < 0 || body >= static_cast<int>(scene.bodies.size()))
    throw InputError(what + " names body number " + std::to_string(body) + ", but the scene has " +
                     std::to_string(scene.bodies.size()) + " bodies");
}

void requirePart(const Scene& scene, const PartNames& names, const Effect::BoundaryPart& part,
                 const std::string& what) {
  requireBody(scene, part.body, what);
  const auto body = static_cast<std::size_t>(part.body);
  const std::string& set = part.set;
  const std::set<std::string>& known = part.needsSides ? names.withSides[body] : names.all[body];
  if (known.count(set) > 0)
    return;
  const std::vector<std::string> candidates(known.begin(), known.end());
  const std::string nearest = nearestName(set, candidates);
  std::string list;
  for (const std::string& name : candidates)
    list += (list.empty() ? "\"" : ", \"") + name + "\"";
  throw InputError(what + " names the boundary part \"" + set + "\" of body \"" + scene.bodies[body].name +
                       (names.all[body].count(set) > 0
                            ? "\", which has nodes but no cell sides on the boundary"
                            : "\", which does not exist there") +
                       (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
                       (list.empty() ? " (available: none)" : " (available: " + list + ")"),
                   {{"set", set}, {"body", scene.bodies[body].name}});
}

// Pressures of contacts are forces by lengths, of the thickness 1.
void requireThicknessOne(const Scene& scene, const Effect& effect) {
  if (!effect.givesInequalities())
    return;
  for (const Effect::BoundaryPart& part : effect.boundaryParts()) {
    const Body& body = scene.bodies[static_cast<std::size_t>(part.body)];
    for (double thickness : body.thickness)
      if (thickness != 1.0)
        throw InputError(effect.label() + " acts on body \"" + body.name +
                             "\", which has a \"Thickness\" other than 1; remove it and divide forces by it",
                         {{"body", body.name}});
  }
}

void requireFinite(const Scene& scene) {
  if (!scene.isFinite())
    return;
  if (scene.physics == Physics::Membrane)
    throw InputError("\"Model/Kinematics\" = \"finite\" is for elastic bodies; membranes have small "
                     "displacements",
                     {{"path", "Model/Kinematics"}});
  for (const auto& effect : scene.effects)
    if (effect->finite() == nullptr)
      throw InputError(effect->label() + " does not work with \"Model/Kinematics\" = \"finite\"; remove it "
                                         "or use \"small\"",
                       {{"path", "Model/Kinematics"}});
}

// What goes with inertia, and that there is any.
void requireTransient(const Scene& scene) {
  if (!scene.isTransient())
    return;
  const auto refuse = [](const std::string& what) {
    throw InputError("\"Steps/Time integration\" = \"Newmark\" " + what,
                     {{"path", "Steps/Time integration"}});
  };
  if (scene.physics == Physics::Membrane)
    refuse("is for elastic bodies, not for membranes");
  for (const Body& body : scene.bodies)
    for (const fem::Material& material : body.materials)
      if (!(material.density > 0.0))
        refuse("needs the \"Density\" of each material, which body \"" + body.name + "\" lacks");
}

} // namespace

void checkBoundaryParts(const Teuchos::Comm<int>& comm, const Scene& scene,
                        const std::vector<OwnedSubdomain>& owned) {
  const PartNames names = gatherPartNames(comm, scene.bodies.size(), owned);
  // From here on every rank has the same data and meets the same errors.
  requireFinite(scene);
  requireTransient(scene);
  for (const auto& effect : scene.effects) {
    for (int body : effect->bodies())
      requireBody(scene, body, effect->label());
    effect->check(scene);
    for (const Effect::BoundaryPart& part : effect->boundaryParts())
      requirePart(scene, names, part, effect->label());
    requireThicknessOne(scene, *effect);
  }
}

} // namespace Harmos::scene
