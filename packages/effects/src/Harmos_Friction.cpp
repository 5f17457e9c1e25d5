// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Friction.hpp"

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_ContactByName.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {
namespace {

constexpr double noValue = -1.0;

std::shared_ptr<const scene::Effect> makeFriction(const Teuchos::ParameterList& list, const std::string& path,
                                                  const scene::Scene& scene) {
  requireElastic(scene, "\"" + path + "\"");
  const bool isCoulomb = list.get<std::string>("Law") == "Coulomb";
  const std::string asked = isCoulomb ? "Coefficient" : "Slip bound",
                    other = isCoulomb ? "Slip bound" : "Coefficient";
  const std::string law = isCoulomb ? "Coulomb's law" : "Tresca's law",
                    needs = isCoulomb ? "a coefficient of friction" : "a force per area";
  if (list.get<double>(other) != noValue)
    throw InputError("\"" + path + "/" + other + "\" is given, but " + law + " does not use it; give \"" +
                         asked + "\", " + needs + ", or another \"Law\"",
                     {{"path", path + "/" + other}});
  if (!(list.get<double>(asked) >= 0.0))
    throw InputError("\"" + path + "/" + asked + "\" is missing or negative; " + law + " needs " + needs +
                         " of at least 0",
                     {{"path", path + "/" + asked}});
  const std::shared_ptr<const scene::Effect> contact =
      contactByName(scene, list.get<std::string>("Contact"), path + "/Contact",
                    {"does not slip", "friction acts on a contact or an obstacle"});
  if (isCoulomb)
    return std::make_shared<Friction>(contact, Coulomb(list.get<double>(asked)), scene::nameIn(path));
  return std::make_shared<Friction>(contact, list.get<double>(asked), scene::nameIn(path));
}

} // namespace

scene::EffectKind kindOfFriction() {
  ParameterSpec spec("<friction>", "Friction between the surfaces of a contact or a body and an obstacle. "
                                   "A point sticks below the bound of the friction force. Its slip "
                                   "accumulates from step to step.");
  spec.text("Contact", "",
            "Contact or obstacle on which it acts: the name of one of \"Effects/Contact\" or "
            "\"Effects/Obstacle\", with \"Contact/\" or "
            "\"Obstacle/\" before it if both have the name. Required.");
  spec.choice("Law", "Coulomb",
              {{"Coulomb", "the bound is proportional to the pressure"},
               {"Tresca", "the bound is given, independent of the pressure"}},
              "Law of the bound of the friction force.");
  spec.real(
      "Coefficient", noValue, Range(),
      "Coulomb: coefficient of friction, bound over pressure, at least 0; -1: not given. Required by this "
      "law.");
  spec.real(
      "Slip bound", noValue, Range(),
      "Tresca: bound, force per area, at least 0, also at open points; -1: not given. Required by this law.");
  return {Friction::kindName, spec, makeFriction};
}

Friction::Friction(std::shared_ptr<const scene::Effect> contact, double slipBound, std::string name)
    : Friction(
          std::move(contact), [slipBound](const fem::Point&) { return slipBound; }, std::move(name)) {}

Friction::Friction(std::shared_ptr<const scene::Effect> contact,
                   std::function<double(const fem::Point&)> slipBound, std::string name)
    : Effect(kindName, std::move(name)), contact_(std::move(contact)), value_(std::move(slipBound)) {}

Friction::Friction(std::shared_ptr<const scene::Effect> contact, Coulomb law, std::string name)
    : Effect(kindName, std::move(name)),
      contact_(std::move(contact)),
      value_(std::move(law.coefficient)),
      isCoulomb_(true) {}

void Friction::check(const scene::Scene& scene) const {
  requireElastic(scene, label());
  if (!contact_ || !isContact(*contact_))
    throw InputError(label() + " acts on " + (contact_ ? contact_->label() : "nothing") +
                     "; friction acts on a contact or an obstacle");
  bool isThere = false;
  for (const auto& effect : scene.effects) {
    isThere = isThere || effect == contact_;
    const auto* other = dynamic_cast<const Friction*>(effect.get());
    if (other != nullptr && other != this && other->contact_ == contact_)
      throw InputError(label() + " and " + other->label() + " act on the same " + contact_->label() +
                       "; remove one of them");
  }
  if (!isThere)
    throw InputError(label() + " acts on " + contact_->label() + ", which is not an effect of the scene");
}

void Friction::addConstraints(scene::ConstraintCollector& collector) const {
  const auto value = [this](const fem::Point& x) {
    const double given = value_(x);
    if (!(given >= 0.0) || !std::isfinite(given))
      throw InputError(label() + " has a " + (isCoulomb_ ? "coefficient" : "slip bound") + " of " +
                       scientific(given) + "; give " + (isCoulomb_ ? "a number" : "a force per area") +
                       " of at least 0");
    return given;
  };
  if (isCoulomb_)
    collector.addFrictionByPressure(*contact_, value);
  else
    collector.addFriction(*contact_, value);
}

void Friction::beginStep(std::vector<double>& trial) const {
  const auto rows = static_cast<std::ptrdiff_t>(trial.size() / 2);
  std::copy(trial.begin() + rows, trial.end(), trial.begin());
}

void Friction::addToBounds(const std::vector<double>& state, std::vector<double>& bounds) const {
  for (std::size_t k = 0; k < bounds.size(); ++k)
    bounds[k] += state[k];
}

bool Friction::updateState(const std::vector<RowAnswer>& answer, double, std::vector<double>& trial) const {
  for (std::size_t k = 0; k < answer.size(); ++k)
    trial[answer.size() + k] = trial[k] - answer[k].gap;
  return false;
}

} // namespace Harmos::effects
