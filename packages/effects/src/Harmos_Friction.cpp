// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Friction.hpp"

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_NearestName.hpp"
#include "Harmos_RigidObstacle.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {
namespace {

bool maySlip(const scene::Effect& effect) {
  return effect.kind() == Contact::kindName || effect.kind() == RigidObstacle::kindName;
}

// By its name, or by "Contact/name" where an obstacle has the same.
std::shared_ptr<const scene::Effect> contactNamed(const scene::Scene& scene, const std::string& name,
                                                  const std::string& path) {
  std::vector<std::string> names;
  std::vector<std::shared_ptr<const scene::Effect>> found;
  std::string others;
  for (const auto& effect : scene.effects) {
    const bool isMeant = effect->name() == name || effect->kind() + "/" + effect->name() == name;
    if (maySlip(*effect)) {
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
                         "\" is the name of a contact and of an obstacle; say \"" + found[0]->kind() + "/" +
                         name + "\" or \"" + found[1]->kind() + "/" + name + "\"",
                     {{"path", path}});
  if (!others.empty())
    throw InputError("\"" + path + "\" names the " + others +
                         ", which does not slip; friction acts on a contact or an obstacle",
                     {{"path", path}});
  throw InputError("\"" + path + "\" names the contact \"" + name +
                       "\", which is neither in \"Effects/Contact\" nor in \"Effects/Obstacle\"" +
                       offer(name, names),
                   {{"path", path}});
}

std::shared_ptr<const scene::Effect> make(const Teuchos::ParameterList& list, const std::string& path,
                                          const scene::Scene& scene) {
  requireElastic(scene, "\"" + path + "\"");
  if (!(list.get<double>("Slip bound") >= 0.0))
    throw InputError("\"" + path +
                         "/Slip bound\" is missing or negative; Tresca's law needs a force per area, zero or "
                         "more",
                     {{"path", path + "/Slip bound"}});
  return std::make_shared<Friction>(contactNamed(scene, list.get<std::string>("Contact"), path + "/Contact"),
                                    list.get<double>("Slip bound"), scene::nameIn(path));
}

} // namespace

scene::EffectKind kindOfFriction() {
  ParameterSpec spec("<friction>", "The surfaces of a contact, or a body on an obstacle, slip against a "
                                   "resistance that has a bound.");
  spec.text("Contact", "",
            "On what it acts: the name of one of \"Effects/Contact\" or \"Effects/Obstacle\". Required.");
  spec.choice("Law", "Tresca", {{"Tresca", "the bound is given, whatever the pressure is"}},
              "What the bound depends on.");
  spec.real("Slip bound", -1.0, Range(), "Tresca: force per area, zero or more. Required.");
  spec.absent("Coefficient", "Tresca's law has no coefficient of friction; give \"Slip bound\", a force per "
                             "area");
  return {Friction::kindName, spec, make};
}

Friction::Friction(std::shared_ptr<const scene::Effect> contact, double slipBound, std::string name)
    : Friction(
          std::move(contact), [slipBound](const fem::Point&) { return slipBound; }, std::move(name)) {}

Friction::Friction(std::shared_ptr<const scene::Effect> contact,
                   std::function<double(const fem::Point&)> slipBound, std::string name)
    : Effect(kindName, std::move(name)), contact_(std::move(contact)), slipBound_(std::move(slipBound)) {}

void Friction::check(const scene::Scene& scene) const {
  requireElastic(scene, label());
  if (!contact_ || !maySlip(*contact_))
    throw InputError(label() + " acts on " + (contact_ ? contact_->label() : "nothing") +
                     "; friction acts on a contact or an obstacle");
  bool isThere = false;
  for (const auto& effect : scene.effects) {
    isThere = isThere || effect == contact_;
    const auto* other = dynamic_cast<const Friction*>(effect.get());
    if (other != nullptr && other != this && other->contact_ == contact_)
      throw InputError(label() + " and " + other->label() + " act on the same " + contact_->label() +
                       "; leave one of them out");
  }
  if (!isThere)
    throw InputError(label() + " acts on " + contact_->label() + ", which is not an effect of the scene");
}

void Friction::addConstraints(scene::ConstraintCollector& collector) const {
  collector.addFriction(*contact_, [this](const fem::Point& x) {
    const double bound = slipBound_(x);
    if (!(bound >= 0.0) || !std::isfinite(bound))
      throw InputError(label() + " has a slip bound of " + scientific(bound) +
                       "; give a force per area, zero or more");
    return bound;
  });
}

void Friction::beginStep(std::vector<double>& trial) const {
  const auto rows = static_cast<std::ptrdiff_t>(trial.size() / 2);
  std::copy(trial.begin() + rows, trial.end(), trial.begin());
}

void Friction::addToBounds(const std::vector<double>& state, std::vector<double>& bounds) const {
  for (std::size_t k = 0; k < bounds.size(); ++k)
    bounds[k] += state[k];
}

bool Friction::updateState(const std::vector<RowAnswer>& answer, std::vector<double>& trial) const {
  for (std::size_t k = 0; k < answer.size(); ++k)
    trial[answer.size() + k] = trial[k] - answer[k].gap;
  return false;
}

} // namespace Harmos::effects
