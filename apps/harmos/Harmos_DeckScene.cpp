// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeckScene.hpp"

#include "Harmos_AutomaticContact.hpp"
#include "Harmos_AxisOfSymmetry.hpp"
#include "Harmos_DeckBodies.hpp"
#include "Harmos_DeckParts.hpp"

namespace Harmos::app {
namespace {

const std::vector<std::pair<std::string, scene::Physics>> physicsNames = {
    {"plane strain", scene::Physics::PlaneStrain},
    {"plane stress", scene::Physics::PlaneStress},
    {"axisymmetric", scene::Physics::Axisymmetric},
    {"solid", scene::Physics::Solid},
    {"membrane", scene::Physics::Membrane}};

} // namespace

void addSceneParameters(ParameterSpec& deck, const scene::EffectRegistry& registry,
                        KinematicsChoice kinematics) {
  ParameterSpec model("Model", "Physics, name and mesh file of the scene.");
  model.choice("Physics", "plane strain",
               {{"plane strain", "elastic, no strain out of the plane"},
                {"plane stress", "elastic, no stress out of the plane"},
                {"axisymmetric", "elastic bodies of revolution: x is the distance from the axis, y along it"},
                {"solid", "elastic, three dimensions"},
                {"membrane", "−Δu = f in the plane, one displacement a node"}},
               "Of all bodies.");
  if (kinematics == KinematicsChoice::Offered) { // of the program harmos
    model.choice(
        "Kinematics", "small",
        {{"small", "linear: strains and rotations are small, contacts are those of the bodies at rest"},
         {"finite", "displacements, rotations and strains of any size; contacts slide"}},
        "What displacements may be.");
    model.real(
        "Mesh size", 0.0, Range::atLeast(0.0),
        "Longest edge, about, of the cells of a geometry that is meshed (.geo, .step). 0: as the file has "
        "it.");
    model.integer("Mesh order", 0, 0, 2,
                  "Order of the cells of a geometry that is meshed: 2 has nodes in the middle of edges, on "
                  "the curved surface. 0: as the file has it, or 1.");
  }
  model.text("Name", "scene", "Name of the scene in log and summary.");
  model.text("Mesh file", "",
             "Mesh file of bodies with the source \"file\", relative to the deck. A file that Gmsh reads "
             "(.msh, .vtk; .geo and .step are meshed first), or one that harmos-mesh has cut (.h5: each rank "
             "reads its own parts).");
  deck.list(std::move(model));
  addBodyParameters(deck);
  addPartParameters(deck);
  registry.addParameters(deck);
}

scene::Scene sceneFromDeck(const DeckContext& context, const scene::EffectRegistry& registry) {
  const Teuchos::ParameterList& model = context.deck.sublist("Model");
  scene::Scene scene;
  scene.name = model.get<std::string>("Name");
  for (const auto& [name, kind] : physicsNames)
    if (name == model.get<std::string>("Physics"))
      scene.physics = kind;
  if (model.isParameter("Kinematics") && model.get<std::string>("Kinematics") == "finite")
    scene.strains = fem::Strains::Finite;
  addBodies(context, scene);
  addBoundaryRules(context.deck, scene);
  registry.addEffects(withAutomaticContacts(context, registry, scene), scene);
  if (scene.physics == scene::Physics::Axisymmetric)
    scene.effects.push_back(std::make_shared<effects::AxisOfSymmetry>(scene.bodies.size()));
  return scene;
}

} // namespace Harmos::app
