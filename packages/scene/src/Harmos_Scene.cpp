// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Scene.hpp"

#include <algorithm>

namespace Harmos::scene {

int Scene::subdomains() const {
  int count = 0;
  for (const Body& body : bodies)
    count += body.subdomains;
  return count;
}

bool Scene::hasInequalities() const {
  return std::any_of(interfaces.begin(), interfaces.end(),
                     [](const Interface& interface) { return interface.kind == Interface::Kind::Contact; });
}

bool Scene::hasFloatingBody() const {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.prescribed.empty(); });
}

std::vector<std::string> Scene::effects() const {
  std::vector<std::string> result;
  if (std::any_of(interfaces.begin(), interfaces.end(),
                  [](const Interface& interface) { return interface.kind == Interface::Kind::Tie; }))
    result.push_back("Tie");
  if (hasInequalities())
    result.push_back("Contact");
  if (std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return !body.bodyForce.empty(); }))
    result.push_back("Body force");
  if (std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return !body.prescribed.empty(); }))
    result.push_back("Prescribed displacement");
  return result;
}

} // namespace Harmos::scene
