// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeckEffects.hpp"

#include "Harmos_DeckBodies.hpp"
#include "Harmos_Errors.hpp"

#include <functional>

namespace Harmos::app {
namespace {

using Teuchos::ParameterList;

fem::Point point(const ParameterList& list, const std::string& name) {
  const auto& array = list.get<Teuchos::Array<double>>(name);
  return {array[0], array[1], array[2]};
}

int bodyNamed(const scene::Scene& scene, const std::string& name, const std::string& path) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    names.push_back(scene.bodies[b].name);
    if (names.back() == name)
      return static_cast<int>(b);
  }
  throw InputError("\"" + path + "\" names the body \"" + name + "\", which is not in \"Bodies\"" +
                       offer(name, names),
                   {{"path", path}});
}

// "body/part".
struct Part {
  int body;
  std::string set;
};

Part partIn(const scene::Scene& scene, const ParameterList& list, const std::string& parameter,
            const std::string& path) {
  const std::string text = list.get<std::string>(parameter);
  const std::string place = path + "/" + parameter;
  const std::size_t slash = text.rfind('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == text.size())
    throw InputError("\"" + place + "\" = \"" + text + "\" is not of the form \"body/boundary part\"",
                     {{"path", place}});
  return {bodyNamed(scene, text.substr(0, slash), place), text.substr(slash + 1)};
}

void requireElastic(const scene::Scene& scene, const std::string& path) {
  if (scene.physics == scene::Physics::Membrane)
    throw InputError("\"" + path +
                         "\" is for elastic bodies, but \"Model/Physics\" = \"membrane\"; leave it out or "
                         "choose another physics",
                     {{"path", path}});
}

void addSurfaces(ParameterSpec& spec) {
  spec.text("First", "",
            "\"body/boundary part\" that carries the multipliers: the finer or softer one. Required.");
  spec.text("Second", "", "\"body/boundary part\" opposite to it. Required.");
  spec.choice("Coupling", "automatic",
              {{"automatic", "nodes where they match, else mortar"},
               {"nodes", "node to node; the nodes have to match"},
               {"mortar", "dual Lagrange multipliers; the meshes need not match"}},
              "How the two meshes are brought together.");
  spec.real("Reach", 0.0, Range::atLeast(0.0),
            "Mortar: counterparts farther than this are none; 0: a tenth of the smaller surface's extent.");
}

scene::Interface interfaceFrom(const ParameterList& list, const std::string& path, const scene::Scene& scene,
                               scene::Interface::Kind kind) {
  using Coupling = scene::Interface::Coupling;
  const Part first = partIn(scene, list, "First", path), second = partIn(scene, list, "Second", path);
  if (first.body == second.body && first.set == second.set)
    throw InputError("\"" + path +
                         "\": \"First\" and \"Second\" are the same boundary part; name two that face "
                         "each other",
                     {{"path", path}});
  scene::Interface interface;
  interface.kind = kind;
  interface.firstBody = first.body;
  interface.firstSet = first.set;
  interface.secondBody = second.body;
  interface.secondSet = second.set;
  const std::string coupling = list.get<std::string>("Coupling");
  interface.coupling = coupling == "nodes"    ? Coupling::Nodes
                       : coupling == "mortar" ? Coupling::Mortar
                                              : Coupling::Automatic;
  interface.reach = list.get<double>("Reach");
  return interface;
}

// A kind of effect: its parameters, and what one of it does to a scene. The path is that of its list.
struct Effect {
  ParameterSpec spec;
  std::function<void(const ParameterList&, const std::string& path, scene::Scene&)> apply;
};

Effect contact() {
  ParameterSpec spec("<contact>",
                     "Two boundary parts do not penetrate each other; no friction, no adhesion.");
  addSurfaces(spec);
  spec.real("Gap", 0.0, Range(), "Added to the distance of the meshes; negative: initial penetration.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            scene.interfaces.push_back(interfaceFrom(list, path, scene, scene::Interface::Kind::Contact));
            scene.interfaces.back().gap = list.get<double>("Gap");
          }};
}

Effect tie() {
  ParameterSpec spec("<tie>", "Two boundary parts are glued together.");
  addSurfaces(spec);
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            scene.interfaces.push_back(interfaceFrom(list, path, scene, scene::Interface::Kind::Tie));
          }};
}

void requireGeometry(const contact::Obstacle& obstacle, const scene::Scene& scene, const std::string& path) {
  using Shape = contact::Obstacle::Shape;
  const bool inPlane = scene.components() == 2;
  const auto& [x, y, z] = obstacle.direction;
  const bool needsDirection =
      obstacle.shape == Shape::HalfSpace || (obstacle.shape == Shape::Cylinder && !inPlane);
  if (needsDirection && x == 0.0 && y == 0.0 && (inPlane || z == 0.0))
    throw InputError("\"" + path + "/Direction\" has no length" + (inPlane ? " in the plane" : "") +
                         "; give the outward normal of the half-space, or the axis of the cylinder",
                     {{"path", path + "/Direction"}});
  if (obstacle.shape != Shape::HalfSpace && obstacle.radius == 0.0)
    throw InputError("\"" + path +
                         "/Radius\" is 0; give a positive one, or a negative one for a hollow obstacle with "
                         "the body inside",
                     {{"path", path + "/Radius"}});
}

Effect obstacle() {
  ParameterSpec spec("<obstacle>", "A boundary part does not penetrate a rigid obstacle at rest.");
  spec.text("Part", "", "Where: \"body/boundary part\". Required.");
  spec.choice("Shape", "half-space",
              {{"half-space", "behind the plane through \"Point\" that \"Direction\" leaves"},
               {"cylinder", "about the axis through \"Point\" along \"Direction\""},
               {"sphere", "about \"Point\""}},
              "What the obstacle is.");
  spec.reals("Point", {0.0, 0.0, 0.0}, Range(), "On the plane, on the axis, or the centre.");
  spec.reals("Direction", {0.0, 1.0, 0.0}, Range(),
             "Half-space: its outward normal, towards the body. Cylinder: its axis; in the plane always 0, "
             "0, 1. Spheres have none.");
  spec.real("Radius", 0.0, Range(), "Of cylinder and sphere; negative: the body is inside of a hollow one.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            requireElastic(scene, path);
            const Part part = partIn(scene, list, "Part", path);
            scene::ObstacleContact contact;
            contact.name = path.substr(path.rfind('/') + 1);
            contact.body = part.body;
            contact.set = part.set;
            using Shape = contact::Obstacle::Shape;
            const std::string shape = list.get<std::string>("Shape");
            contact.obstacle.shape = shape == "cylinder" ? Shape::Cylinder
                                     : shape == "sphere" ? Shape::Sphere
                                                         : Shape::HalfSpace;
            contact.obstacle.point = point(list, "Point");
            contact.obstacle.direction = point(list, "Direction");
            contact.obstacle.radius = list.get<double>("Radius");
            requireGeometry(contact.obstacle, scene, path);
            scene.obstacles.push_back(contact);
          }};
}

Effect prescribedDisplacement() {
  ParameterSpec spec("<displacement>", "A boundary part is held at given displacements.");
  spec.text("Part", "", "Where: \"body/boundary part\". Required.");
  spec.texts("Components", {"x", "y", "z"},
             "Which are held; the others are free. Membranes have \"x\" alone.");
  spec.reals("Displacement", {0.0, 0.0, 0.0}, Range(), "In x, y, z; only those of the components count.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            const Part part = partIn(scene, list, "Part", path);
            const auto& components = list.get<Teuchos::Array<std::string>>("Components");
            const fem::Point value = point(list, "Displacement");
            int held = 0;
            for (const std::string& component : components) {
              const std::size_t c = std::string("xyz").find(component);
              if (component.size() != 1 || c == std::string::npos)
                throw InputError("\"" + path + "/Components\" holds \"" + component +
                                     "\", expected \"x\", \"y\" or \"z\"",
                                 {{"path", path + "/Components"}});
              // In the plane z is held already.
              if (static_cast<int>(c) >= scene.components())
                continue;
              ++held;
              scene.bodies[static_cast<std::size_t>(part.body)].prescribed.push_back(
                  {part.set, value[c], static_cast<int>(c)});
            }
            if (held == 0)
              throw InputError(
                  "\"" + path +
                      "/Components\" names none of the components of this physics; membranes have "
                      "\"x\", plane scenes \"x\" and \"y\"",
                  {{"path", path + "/Components"}});
          }};
}

Effect bodyForce() {
  ParameterSpec spec("<force>", "A force on all of a body.");
  spec.text("Body", "", "The name of the body. Required.");
  spec.reals("Density", {0.0, 0.0, 0.0}, Range(),
             "Force per volume along x, y, z; of membranes per area, the first number alone.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            const int body = bodyNamed(scene, list.get<std::string>("Body"), path + "/Body");
            const fem::Point density = point(list, "Density");
            if (scene.physics == scene::Physics::Membrane) {
              constexpr double all = 1e300;
              scene.bodies[static_cast<std::size_t>(body)].bodyForce.push_back(
                  {density[0], {-all, -all}, {all, all}});
            } else {
              scene.bodies[static_cast<std::size_t>(body)].forces.push_back(
                  [density](const fem::Point&) { return density; });
            }
          }};
}

Effect traction() {
  ParameterSpec spec("<traction>", "A force on a boundary part.");
  spec.text("Part", "", "Where: \"body/boundary part\". Required.");
  spec.reals("Density", {0.0, 0.0, 0.0}, Range(),
             "Force per area along x, y, z; constant, whatever the normal.");
  spec.real("Pressure", 0.0, Range(), "Force per area against the outward normal.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            requireElastic(scene, path);
            const Part part = partIn(scene, list, "Part", path);
            const fem::Point density = point(list, "Density");
            const double pressure = list.get<double>("Pressure");
            scene.bodies[static_cast<std::size_t>(part.body)].tractions.push_back(
                {part.set, [density, pressure](const fem::Point&, const fem::Point& normal) {
                   fem::Point t = density;
                   for (std::size_t d = 0; d < 3; ++d)
                     t[d] -= pressure * normal[d];
                   return t;
                 }});
          }};
}

Effect thermalStrain() {
  ParameterSpec spec("<temperature>", "A body is warmer than when it was free of stress.");
  spec.text("Body", "", "The name of the body. Required.");
  spec.real("Temperature", 0.0, Range(),
            "Rise in degrees; negative: the body was cooled. Rises of several effects add up.");
  return {spec, [](const ParameterList& list, const std::string& path, scene::Scene& scene) {
            requireElastic(scene, path);
            const int body = bodyNamed(scene, list.get<std::string>("Body"), path + "/Body");
            scene.bodies[static_cast<std::size_t>(body)].temperature += list.get<double>("Temperature");
          }};
}

// The names are those that the log and the summary use.
const std::vector<std::pair<std::string, Effect>>& effects() {
  static const std::vector<std::pair<std::string, Effect>> all = {
      {"Tie", tie()},
      {"Contact", contact()},
      {"Obstacle", obstacle()},
      {"Body force", bodyForce()},
      {"Traction", traction()},
      {"Prescribed displacement", prescribedDisplacement()},
      {"Thermal strain", thermalStrain()}};
  return all;
}

} // namespace

void addEffectParameters(ParameterSpec& deck) {
  ParameterSpec list("Effects", "What happens to the bodies; what is not named costs nothing.");
  for (const auto& [name, effect] : effects()) {
    ParameterSpec kind(name, "Effects of this kind, each by a name of your choice.");
    kind.family(effect.spec);
    list.list(std::move(kind));
  }
  deck.list(std::move(list));
}

void addEffects(const ParameterList& deck, scene::Scene& scene) {
  for (const auto& [kind, effect] : effects()) {
    const ParameterList& list = deck.sublist("Effects").sublist(kind);
    for (auto item = list.begin(); item != list.end(); ++item)
      effect.apply(list.sublist(list.name(item)), "Effects/" + kind + "/" + list.name(item), scene);
  }
}

} // namespace Harmos::app
