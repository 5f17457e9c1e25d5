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

namespace {

// Of a point, along its tangents.
struct SlipState {
  double begun[2]; // when the step began
  double now[2];   // in the last answer
};

// visit(row, direction): which of its point's tangents a row is.
template<class Rows, class Visit>
void overTangents(const Rows& rows, std::size_t points, const Visit& visit) {
  std::vector<std::size_t> next(points, 0);
  for (std::size_t k = 0; k < rows.size(); ++k)
    visit(k, next[rows[k].place]++);
}

} // namespace

std::size_t Friction::stateSize() const {
  return scene::PointStates::sizeOf<SlipState>();
}

void Friction::beginStep(scene::PointStates& trial) const {
  for (std::size_t point = 0; point < trial.points(); ++point) {
    SlipState state = trial.get<SlipState>(point);
    std::copy_n(state.now, 2, state.begun);
    trial.set(point, state);
  }
}

void Friction::addToBounds(const scene::PointStates& state, const std::vector<Row>& rows,
                           std::vector<double>& bounds) const {
  overTangents(rows, state.points(), [&](std::size_t k, std::size_t t) {
    bounds[k] += state.get<SlipState>(rows[k].place).begun[t];
  });
}

bool Friction::updateState(const std::vector<RowAnswer>& answer, double, const Largest&,
                           scene::PointStates& trial) const {
  overTangents(answer, trial.points(), [&](std::size_t k, std::size_t t) {
    SlipState state = trial.get<SlipState>(answer[k].place);
    state.now[t] = state.begun[t] - answer[k].gap;
    trial.set(answer[k].place, state);
  });
  return false;
}

} // namespace Harmos::effects
