// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactByName.hpp"

#include "Harmos_Contact.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_NearestName.hpp"
#include "Harmos_RigidObstacle.hpp"

#include <vector>

namespace Harmos::effects {

bool isContact(const scene::Effect& effect) {
  return effect.kind() == Contact::kindName || effect.kind() == RigidObstacle::kindName;
}

std::shared_ptr<const scene::Effect> contactByName(const scene::Scene& scene, const std::string& name,
                                                   const std::string& path, const ActsOnContact& words) {
  std::vector<std::string> names;
  std::vector<std::shared_ptr<const scene::Effect>> found;
  std::string others;
  for (const auto& effect : scene.effects) {
    const bool isMeant = effect->name() == name || effect->kind() + "/" + effect->name() == name;
    if (isContact(*effect)) {
      names.push_back(effect->name());
      if (isMeant)
        found.push_back(effect);
    } else if (isMeant) {
      others = effect->label();
    }
  }
  if (found.size() == 1)
    return found.front();
  if (found.size() > 1)
    throw InputError("\"" + path + "\" = \"" + name +
                         "\" is the name of a contact and of an obstacle; write \"" + found[0]->kind() + "/" +
                         name + "\" or \"" + found[1]->kind() + "/" + name + "\"",
                     {{"path", path}});
  if (!others.empty())
    throw InputError("\"" + path + "\" names the " + others + ", which " + words.notThat + "; " + words.rule,
                     {{"path", path}});
  throw InputError("\"" + path + "\" names the contact \"" + name +
                       "\", which is neither in \"Effects/Contact\" nor in \"Effects/Obstacle\"" +
                       offer(name, names),
                   {{"path", path}});
}

} // namespace Harmos::effects
