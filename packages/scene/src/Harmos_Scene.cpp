// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Scene.hpp"

#include <algorithm>
#include <tuple>

namespace Harmos::scene {
namespace {

template<class Condition>
bool anyBody(const Scene& scene, Condition&& condition) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), condition);
}

bool anyInterface(const Scene& scene, Interface::Kind kind) {
  return std::any_of(scene.interfaces.begin(), scene.interfaces.end(),
                     [kind](const Interface& interface) { return interface.kind == kind; });
}

} // namespace

int componentsOf(Physics physics) {
  switch (physics) {
  case Physics::Membrane:
    return 1;
  case Physics::PlaneStrain:
  case Physics::PlaneStress:
    return 2;
  case Physics::Solid:
    return 3;
  }
  return 0;
}

fem::Kinematics kinematicsOf(Physics physics) {
  return physics == Physics::PlaneStress ? fem::Kinematics::PlaneStress
         : physics == Physics::Solid     ? fem::Kinematics::Solid
                                         : fem::Kinematics::PlaneStrain;
}

int Scene::subdomains() const {
  int count = 0;
  for (const Body& body : bodies)
    count += body.subdomains;
  return count;
}

bool Scene::hasInequalities() const {
  return !obstacles.empty() || anyInterface(*this, Interface::Kind::Contact);
}

bool Scene::hasFloatingBody() const {
  return anyBody(*this, [](const Body& body) { return body.prescribed.empty(); });
}

bool Scene::hasSeveralMaterials() const {
  const auto elastic = [](const fem::Material& m) { return std::tie(m.young, m.poisson, m.shear, m.angle); };
  const fem::Material* first = nullptr;
  for (const Body& body : bodies)
    for (const fem::Material& material : body.materials) {
      if (first != nullptr && elastic(material) != elastic(*first))
        return true;
      first = &material;
    }
  return false;
}

std::vector<std::string> Scene::effects() const {
  std::vector<std::string> result;
  if (anyInterface(*this, Interface::Kind::Tie))
    result.push_back("Tie");
  if (anyInterface(*this, Interface::Kind::Contact))
    result.push_back("Contact");
  if (!obstacles.empty())
    result.push_back("Obstacle");
  if (anyBody(*this, [](const Body& body) { return !body.bodyForce.empty() || !body.forces.empty(); }))
    result.push_back("Body force");
  if (anyBody(*this, [](const Body& body) { return !body.tractions.empty(); }))
    result.push_back("Traction");
  if (anyBody(*this, [](const Body& body) { return !body.prescribed.empty(); }))
    result.push_back("Prescribed displacement");
  if (anyBody(*this, [](const Body& body) { return body.temperature != 0.0; }))
    result.push_back("Thermal strain");
  return result;
}

} // namespace Harmos::scene
