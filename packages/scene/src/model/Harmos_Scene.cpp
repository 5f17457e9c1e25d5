// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Scene.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace Harmos::scene {
int componentsOf(Physics physics) {
  switch (physics) {
  case Physics::Membrane:
    return 1;
  case Physics::PlaneStrain:
  case Physics::PlaneStress:
  case Physics::Axisymmetric:
    return 2;
  case Physics::Solid:
    return 3;
  }
  return 0;
}

int rigidBodyModesOf(Physics physics) {
  switch (physics) {
  case Physics::PlaneStrain:
  case Physics::PlaneStress:
    return 3;
  case Physics::Solid:
    return 6;
  default:
    return 1;
  }
}

fem::Kinematics kinematicsOf(Physics physics) {
  return physics == Physics::PlaneStress    ? fem::Kinematics::PlaneStress
         : physics == Physics::Axisymmetric ? fem::Kinematics::Axisymmetric
         : physics == Physics::Solid        ? fem::Kinematics::Solid
                                            : fem::Kinematics::PlaneStrain;
}

int Scene::subdomains() const {
  int count = 0;
  for (const Body& body : bodies)
    count += body.subdomains;
  return count;
}

bool Scene::breaks() const {
  return std::any_of(effects.begin(), effects.end(), [](const auto& effect) {
    return effect->interfaceLaw() != nullptr && effect->interfaceLaw()->breaks();
  });
}

bool Scene::hasInequalities() const {
  return std::any_of(effects.begin(), effects.end(),
                     [](const auto& effect) { return effect->givesInequalities(); });
}

bool Scene::hasFloatingBody() const {
  std::set<int> held;
  for (const auto& effect : effects)
    for (int body : effect->heldBodies())
      held.insert(body);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (held.count(static_cast<int>(b)) == 0)
      return true;
  return false;
}

bool Scene::hasSeveralMaterials() const {
  const auto elastic = [](const fem::Material& m) {
    return std::tie(m.young, m.poisson, m.shear, m.angle, m.axes, m.coupled);
  };
  const fem::Material* first = nullptr;
  for (const Body& body : bodies)
    for (const fem::Material& material : body.materials) {
      if (first != nullptr && elastic(material) != elastic(*first))
        return true;
      first = &material;
    }
  return false;
}

double Scene::materialContrast() const {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  if (physics == Physics::Membrane)
    return 1.0;
  for (const Body& body : bodies)
    for (const fem::Material& material : body.materials) {
      const double young = *std::max_element(material.young.begin(), material.young.end());
      const double poisson = *std::max_element(material.poisson.begin(), material.poisson.end());
      const double confined = (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
      const double stiffness = physics == Physics::PlaneStress ? young : young * std::max(confined, 1.0);
      least = std::min(least, stiffness);
      most = std::max(most, stiffness);
    }
  return most > 0.0 ? most / least : 1.0;
}

std::vector<double> Scene::temperatureRises(double time) const {
  std::vector<double> rises(bodies.size(), 0.0);
  for (const auto& effect : effects)
    for (int b : effect->bodies())
      if (const double own = effect->temperatureRise(b); own != 0.0)
        rises[static_cast<std::size_t>(b)] += timeline.factor(*effect, time) * own;
  return rises;
}

std::shared_ptr<const std::vector<double>> Scene::nodalRises(const OwnedSubdomain& subdomain,
                                                             double time) const {
  std::shared_ptr<std::vector<double>> rises;
  for (const auto& effect : effects) {
    const std::string called = effect->temperatureField(subdomain.body);
    if (called.empty())
      continue;
    const std::vector<double>& field = nodalField(*this, subdomain, called, effect->label());
    if (!rises)
      rises = std::make_shared<std::vector<double>>(field.size(), 0.0);
    const double factor = timeline.factor(*effect, time);
    for (std::size_t node = 0; node < field.size(); ++node)
      (*rises)[node] += factor * field[node];
  }
  return rises;
}

const std::vector<double>& nodalField(const Scene& scene, const OwnedSubdomain& subdomain,
                                      const std::string& name, const std::string& label) {
  const auto found = subdomain.mesh.fields.find(name);
  if (found != subdomain.mesh.fields.end())
    return found->second;
  const std::string& body = scene.bodies[static_cast<std::size_t>(subdomain.body)].name;
  std::string known;
  for (const auto& field : subdomain.mesh.fields)
    known += (known.empty() ? "\"" : ", \"") + field.first + "\"";
  throw InputError(label + ": the mesh of body \"" + body + "\" has no field \"" + name +
                       "\" with a value at each node (available: " + (known.empty() ? "none" : known) + ")",
                   {{"body", body}, {"field", name}});
}

bool Scene::hasTemperatures(double time) const {
  for (const double rise : temperatureRises(time))
    if (rise != 0.0)
      return true;
  for (const auto& effect : effects)
    for (int b : effect->bodies())
      if (!effect->temperatureField(b).empty() && timeline.factor(*effect, time) != 0.0)
        return true;
  return false;
}

std::vector<std::string> Scene::effectKinds() const {
  std::vector<std::string> kinds;
  for (const auto& effect : effects)
    if (std::find(kinds.begin(), kinds.end(), effect->kind()) == kinds.end())
      kinds.push_back(effect->kind());
  return kinds;
}

std::vector<std::string> Scene::effectPaths() const {
  std::vector<std::string> paths;
  std::set<std::string> taken;
  std::map<std::string, int> unnamed; // by kind
  for (const auto& effect : effects) {
    const std::string own =
        effect->name().empty() ? std::to_string(++unnamed[effect->kind()]) : effect->name();
    std::string path = effect->kind() + "/" + own;
    for (int k = 2; !taken.insert(path).second; ++k)
      path = effect->kind() + "/" + own + " " + std::to_string(k);
    paths.push_back(path);
  }
  return paths;
}

std::vector<std::string> Scene::forcePaths() const {
  const std::vector<std::string> all = effectPaths();
  std::vector<std::string> paths;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (effects[k]->exertsForce())
      paths.push_back(all[k]);
  return paths;
}

std::vector<std::string> Scene::contactPaths() const {
  const std::vector<std::string> all = effectPaths();
  std::vector<std::string> paths;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (effects[k]->givesInequalities())
      paths.push_back(all[k]);
  return paths;
}

fem::Point directionOf(const Scene& scene, int component) {
  fem::Point direction{};
  direction[scene.components() == 1 ? 2 : static_cast<std::size_t>(component)] = 1.0;
  return direction;
}

bool Scene::hasInterfaceLaws() const {
  return std::any_of(effects.begin(), effects.end(),
                     [](const auto& effect) { return effect->interfaceLaw() != nullptr; });
}

bool Scene::yields() const {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) {
    return std::any_of(body.materials.begin(), body.materials.end(),
                       [](const fem::Material& material) { return material.plasticity.has_value(); });
  });
}

fem::Elasticity elasticityOf(const Scene& scene, const Body& body) {
  return {kinematicsOf(scene.physics), body.dilatation, body.materials, body.integration, scene.strains};
}

} // namespace Harmos::scene
