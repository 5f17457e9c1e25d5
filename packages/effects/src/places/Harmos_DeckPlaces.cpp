// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeckPlaces.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_NearestName.hpp"

namespace Harmos::effects {
namespace {

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

} // namespace

int bodyIn(const scene::Scene& scene, const Teuchos::ParameterList& list, const std::string& parameter,
           const std::string& path) {
  return bodyNamed(scene, list.get<std::string>(parameter), path + "/" + parameter);
}

Part partIn(const scene::Scene& scene, const Teuchos::ParameterList& list, const std::string& parameter,
            const std::string& path) {
  return partNamed(scene, list.get<std::string>(parameter), path + "/" + parameter);
}

Part partNamed(const scene::Scene& scene, const std::string& text, const std::string& place) {
  const std::size_t slash = text.rfind('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == text.size())
    throw InputError("\"" + place + "\" = \"" + text + "\" is not of the form \"body/boundary part\"",
                     {{"path", place}});
  return {bodyNamed(scene, text.substr(0, slash), place), text.substr(slash + 1)};
}

void requireElastic(const scene::Scene& scene, const std::string& what) {
  if (scene.physics == scene::Physics::Membrane)
    throw InputError(
        what +
        " needs elastic bodies, but \"Model/Physics\" = \"membrane\"; remove it or choose another physics");
}

fem::Point pointIn(const Teuchos::ParameterList& list, const std::string& parameter) {
  const auto& array = list.get<Teuchos::Array<double>>(parameter);
  return {array[0], array[1], array[2]};
}

} // namespace Harmos::effects
