// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Adhesion.hpp"

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_ContactByName.hpp"
#include "Harmos_DamageUpdate.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {
namespace {

constexpr double notGiven = -1.0;

// Strengths and stiffnesses are always asked for, energies by one law, and none that a law does not have.
void requireGiven(const Teuchos::ParameterList& list, const std::string& path, bool isBrittle) {
  const std::string law = isBrittle ? "the brittle law" : "the bilinear law";
  for (const char* name :
       {"Normal stiffness", "Tangential stiffness", "Normal strength", "Tangential strength"})
    if (!(list.get<double>(name) > 0.0))
      throw InputError("\"" + path + "/" + name + "\" is missing or not positive; adhesion needs " +
                           (std::string(name).find("stiffness") != std::string::npos
                                ? "a force per area and opening"
                                : "a force per area") +
                           " above zero",
                       {{"path", path + "/" + name}});
  for (const char* name : {"Fracture energy", "Fracture energy II"}) {
    const double energy = list.get<double>(name);
    if (isBrittle && energy != notGiven)
      throw InputError("\"" + path + "/" + name + "\" is given, but " + law +
                           " does not use it; omit it or set \"Law\" = \"bilinear\"",
                       {{"path", path + "/" + name}});
    if (!isBrittle && !(energy > 0.0))
      throw InputError("\"" + path + "/" + name + "\" is missing, or not positive; " + law +
                           " needs an energy per area above zero",
                       {{"path", path + "/" + name}});
  }
}

std::shared_ptr<const scene::Effect> makeAdhesion(const Teuchos::ParameterList& list, const std::string& path,
                                                  const scene::Scene& scene) {
  requireElastic(scene, "\"" + path + "\"");
  const CohesiveLaw law = cohesiveLawFrom(list, path);
  return std::make_shared<Adhesion>(contactByName(scene, list.get<std::string>("Contact"), path + "/Contact",
                                                  {"is permanently glued or never in contact",
                                                   "adhesion acts on a contact or an obstacle"}),
                                    law, scene::nameIn(path));
}

} // namespace

CohesiveLaw cohesiveLawFrom(const Teuchos::ParameterList& list, const std::string& path) {
  CohesiveLaw::Options options;
  const bool isBrittle = list.get<std::string>("Law") == "brittle";
  requireGiven(list, path, isBrittle);
  options.kind = isBrittle ? CohesiveLaw::Kind::Brittle : CohesiveLaw::Kind::Bilinear;
  options.normalStiffness = list.get<double>("Normal stiffness");
  options.tangentialStiffness = list.get<double>("Tangential stiffness");
  options.normalStrength = list.get<double>("Normal strength");
  options.tangentialStrength = list.get<double>("Tangential strength");
  options.fractureEnergy = list.get<double>("Fracture energy");
  options.fractureEnergyII = list.get<double>("Fracture energy II");
  options.mixedMode = list.get<std::string>("Mixed mode") == "power"
                          ? CohesiveLaw::MixedMode::Power
                          : CohesiveLaw::MixedMode::BenzeggaghKenane;
  options.exponent = list.get<double>("Mixed mode exponent");
  try {
    return CohesiveLaw(options);
  } catch (const InputError& error) {
    throw InputError("\"" + path + "\": " + error.what(), {{"path", path}});
  }
}

void addCohesiveLaw(ParameterSpec& spec) {
  spec.real("Normal stiffness", notGiven, Range(),
            "Stiffness in tension: force per area and opening, above 0. Required.");
  spec.real("Tangential stiffness", notGiven, Range(),
            "Stiffness along the surface: force per area and slip, above 0. Required.");
  spec.choice("Law", "bilinear",
              {{"brittle", "a point breaks completely at its strength"},
               {"bilinear", "a point softens from its strength on, until the fracture energy is spent"}},
              "Law of damage.");
  spec.real("Normal strength", notGiven, Range(),
            "Strength in tension alone: force per area, above 0. Required.");
  spec.real(
      "Tangential strength", notGiven, Range(),
      "Strength along the surface alone: force per area, above 0. Under both, damage begins at (t_n/σ)² + "
      "(t_t/τ)² = 1. Required.");
  spec.real(
      "Fracture energy", notGiven, Range(),
      "Bilinear: fracture energy per area in tension, above the energy of the springs at the strength. -1: "
      "not given. Required by this law.");
  spec.real(
      "Fracture energy II", notGiven, Range(),
      "Bilinear: fracture energy per area along the surface, above 0. -1: not given. Required by this law.");
  spec.choice(
      "Mixed mode", "power",
      {{"power", "((1 - b)/G)^a + (b/G_II)^a = G_c^-a"}, {"Benzeggagh-Kenane", "G_c = G + (G_II - G) b^a"}},
      "Bilinear: fracture energy G_c under both. b is the share of the tangential springs in the energy that "
      "intact springs would store, a the exponent.");
  spec.real("Mixed mode exponent", 1.0, Range::above(0.0), "Exponent a of the mixed mode.");
}

scene::EffectKind kindOfAdhesion() {
  ParameterSpec spec("<adhesion>",
                     "Adhesion between the surfaces of a contact or a body and an obstacle. Springs "
                     "glue the points that touch at the beginning of the run. Where they break, "
                     "contact remains.");
  spec.text("Contact", "",
            "Contact or obstacle on which it acts: the name of one of \"Effects/Contact\" or "
            "\"Effects/Obstacle\", with \"Contact/\" or "
            "\"Obstacle/\" before it if both have the name. Required.");
  addCohesiveLaw(spec);
  return {Adhesion::kindName, spec, makeAdhesion};
}

Adhesion::Adhesion(std::shared_ptr<const scene::Effect> contact, const CohesiveLaw& law, std::string name)
    : Effect(kindName, std::move(name)), contact_(std::move(contact)), law_(law) {}

void Adhesion::check(const scene::Scene& scene) const {
  requireElastic(scene, label());
  if (!contact_ || !isContact(*contact_))
    throw InputError(label() + " acts on " + (contact_ ? contact_->label() : "nothing") +
                     "; adhesion acts on a contact or an obstacle");
  bool isThere = false;
  for (const auto& effect : scene.effects) {
    isThere = isThere || effect == contact_;
    const auto* other = dynamic_cast<const Adhesion*>(effect.get());
    if (other != nullptr && other != this && other->contact_ == contact_)
      throw InputError(label() + " and " + other->label() + " act on the same " + contact_->label() +
                       "; remove one of them");
  }
  if (!isThere)
    throw InputError(label() + " acts on " + contact_->label() + ", which is not an effect of the scene");
}

void Adhesion::addConstraints(scene::ConstraintCollector& collector) const {
  const CohesiveLaw::Options& law = law_.options();
  // The length over which a crack softens is E·G/σ², to a factor near 1 (Hillerborg, Modéer, Petersson: Cem.
  // Concr. Res. 6, 1976; Turon, Dávila, Camanho, Costa: Eng. Fract. Mech. 74, 2007). The brittle law has
  // none.
  const double toughness =
      law_.isBrittle() ? 0.0
                       : std::min(law.fractureEnergy / (law.normalStrength * law.normalStrength),
                                  law.fractureEnergyII / (law.tangentialStrength * law.tangentialStrength));
  collector.addAdhesion(*contact_, {law.normalStiffness, law.tangentialStiffness, toughness});
}

void Adhesion::beginStep(scene::PointStates& trial) const {
  DamageUpdate(law_, trial).beginStep();
}

namespace {

// Which of a point's stretches rows are: the opening, slips in their order.
std::vector<std::size_t> directionsOf(const std::vector<scene::InterfaceLaw::Row>& rows, std::size_t points) {
  std::vector<std::size_t> directions, slips(points, 0);
  for (const scene::InterfaceLaw::Row& row : rows)
    directions.push_back(row.isLimited ? ++slips[row.place] : 0);
  return directions;
}

std::vector<double> openingsOf(const std::vector<scene::InterfaceLaw::RowAnswer>& answer) {
  std::vector<double> openings;
  for (const scene::InterfaceLaw::RowAnswer& row : answer)
    openings.push_back(row.opening());
  return openings;
}

} // namespace

// Rows grow where points close, and openings where they open.
void Adhesion::soften(const scene::PointStates& state, const std::vector<Row>& rows,
                      std::vector<Spring>& springs) const {
  const std::vector<std::size_t> directions = directionsOf(rows, state.points());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::optional<double>& softness = springs[k].softness;
    if (!softness)
      continue;
    const DamageState its = state.get<DamageState>(rows[k].place);
    const std::size_t direction = directions[k];
    if (its.damage == 1.0) {
      softness.reset();
      if (rows[k].isLimited && softens()) // the brittle law breaks for good: from where the step began
        if (const auto at = its.brokenAt())
          springs[k].brokenAt = (*at)[direction] / root(direction);
      continue;
    }
    const DamageState::Spring spring = its.spring();
    *softness /= spring.stiffness[direction];
    springs[k].unstretched = spring.unstretched[direction] / root(direction) * (direction == 0 ? -1.0 : 1.0);
  }
}

double Adhesion::root(std::size_t direction) const {
  return std::sqrt(direction == 0 ? law_.options().normalStiffness : law_.options().tangentialStiffness);
}

std::vector<DamageUpdate::Point> Adhesion::pointsOf(const std::vector<Row>& rows,
                                                    const std::vector<double>& openings,
                                                    std::size_t count) const {
  const std::vector<std::size_t> directions = directionsOf(rows, count);
  std::vector<DamageUpdate::Point> points(count);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    DamageUpdate::Point& point = points[rows[k].place];
    point.area = rows[k].point->area;
    const double opening = directions[k] == 0 ? std::max(openings[k], 0.0) : openings[k];
    point.stretch[directions[k]] = root(directions[k]) * opening;
  }
  return points;
}

bool Adhesion::updateState(const std::vector<RowAnswer>& answer, double tolerance, const Largest& largest,
                           scene::PointStates& trial) const {
  // Tractions are known to some ten times what residuals are.
  constexpr double known = 10.0, most = 0.01;
  const std::vector<Row> rows(answer.begin(), answer.end());
  return DamageUpdate(law_, trial)
      .breakWorst(pointsOf(rows, openingsOf(answer), trial.points()), std::min(known * tolerance, most),
                  largest);
}

std::vector<double> Adhesion::lawForces(const scene::PointStates& trial, const std::vector<Row>& rows,
                                        const std::vector<double>& openings) const {
  const std::vector<std::size_t> directions = directionsOf(rows, trial.points());
  const std::vector<DamageUpdate::Point> points = pointsOf(rows, openings, trial.points());
  std::vector<Stretch> tractions;
  for (std::size_t k = 0; k < points.size(); ++k)
    tractions.push_back(DamageUpdate::traction(law_, trial.get<DamageState>(k), points[k].stretch));
  std::vector<double> forces;
  for (std::size_t k = 0; k < rows.size(); ++k)
    forces.push_back(rows[k].point->area * root(directions[k]) * tractions[rows[k].place][directions[k]]);
  return forces;
}

double Adhesion::misfit(const std::vector<RowAnswer>& answer, const scene::PointStates& trial) const {
  const std::vector<Row> rows(answer.begin(), answer.end());
  return DamageUpdate::misfit(law_, trial, pointsOf(rows, openingsOf(answer), trial.points()));
}

bool Adhesion::follow(const std::vector<Row>& rows, const std::vector<double>& openings,
                      std::optional<double> steepness, double known, scene::PointStates& trial) const {
  return DamageUpdate(law_, trial).follow(pointsOf(rows, openings, trial.points()), steepness, known);
}

scene::InterfaceLaw::Broken Adhesion::broken(const scene::PointStates& state,
                                             const std::vector<Row>& rows) const {
  return DamageUpdate::broken(law_, state,
                              pointsOf(rows, std::vector<double>(rows.size(), 0.0), state.points()));
}

} // namespace Harmos::effects
