// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ConstraintCollector.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::scene {
namespace {

using contact::ContactPoint;

std::size_t bytesOf(const ContactPoint& point) {
  return sizeof(ContactPoint) + point.terms.size() * sizeof(ContactPoint::Term);
}

std::size_t bytesOf(const ConstraintRow& row) {
  return sizeof(ConstraintRow) + row.terms.size() * sizeof(ConstraintRow::Term);
}

} // namespace

bool ContactSetup::hasFriction() const {
  return std::any_of(slips.begin(), slips.end(),
                     [](const contact::SlipPoint& slip) { return slip.hasFriction; });
}

void DistinctPoints::add(const std::vector<ContactPoint>& more, const Effect& effect) {
  for (const ContactPoint& point : more) {
    std::vector<std::size_t>& here = withNode_[point.terms.front().node];
    const auto twin =
        std::find_if(here.begin(), here.end(), [&](std::size_t k) { return sameRow(all_[k], point); });
    if (twin != here.end()) {
      double& gap = all_[*twin].gap;
      if (std::isnan(point.gap) || point.gap < gap) // a NaN is kept, to be refused
        gap = point.gap;
      if (effects_[*twin] != &effect)
        others_[*twin].push_back(&effect);
      continue;
    }
    here.push_back(all_.size());
    all_.push_back(point);
    effects_.push_back(&effect);
  }
}

std::vector<const Effect*> DistinctPoints::effectsAt(std::size_t point) const {
  std::vector<const Effect*> result = {effects_[point]};
  if (const auto more = others_.find(point); more != others_.end())
    result.insert(result.end(), more->second.begin(), more->second.end());
  return result;
}

bool DistinctPoints::sameRow(const ContactPoint& a, const ContactPoint& b) const {
  constexpr double rounding = 1e-12;
  if (a.terms.size() != b.terms.size())
    return false;
  for (double sign : {1.0, -1.0}) {
    bool same = true;
    for (std::size_t d = 0; d < 3 && normalsMatter_; ++d)
      same = same && std::abs(a.normal[d] - sign * b.normal[d]) <= rounding;
    for (std::size_t k = 0; same && k < a.terms.size(); ++k)
      same = a.terms[k].node == b.terms[k].node &&
             std::abs(a.terms[k].weight - sign * b.terms[k].weight) <= rounding;
    if (same)
      return true;
  }
  return false;
}

ConstraintCollector::ConstraintCollector(const Teuchos::Comm<int>& comm, const Scene& scene,
                                         const std::vector<OwnedSubdomain>& owned, EffectCosts& costs)
    : comm_(comm),
      scene_(scene),
      costs_(costs),
      effects_(scene, costs),
      contacts_(scene.physics != Physics::Membrane),
      ties_(false) {
  held_[scene.timeline.ends().front()];
  if (scene.timeline.hasSteps())
    for (double time : scene.timeline.corners())
      held_[time];
  for (const OwnedSubdomain& item : owned) {
    for (const auto& set : item.mesh.sides)
      withSides_[{item.body, set.first}].push_back(&item.mesh);
    for (const auto& set : item.mesh.sets)
      withNodes_[{item.body, set.first}].push_back(&item);
  }
}

contact::Surface ConstraintCollector::surface(int body, const std::string& set,
                                              const contact::NormalField& normal) const {
  const auto found = withSides_.find({body, set});
  return contact::gatherSurface(
      comm_, found == withSides_.end() ? std::vector<const fem::PlacedMesh*>() : found->second, set,
      scene_.bodies[static_cast<std::size_t>(body)].name + "/" + set, normal);
}

void ConstraintCollector::addContacts(const std::vector<ContactPoint>& points,
                                      const std::vector<Part>& surfaces) {
  contacts_.add(points, *asked_);
  surfacesOf_[asked_] = surfaces;
  if (isAlong(asked_))
    findHeldDofs(surfaces);
}

// Whether friction or adhesion has asked for rows along the surfaces of a contact.
bool ConstraintCollector::isAlong(const Effect* contact) const {
  const auto isOn = [contact](const auto& item) { return item.contact == contact; };
  return std::any_of(frictions_.begin(), frictions_.end(), isOn) ||
         std::any_of(adhesions_.begin(), adhesions_.end(), isOn);
}

void ConstraintCollector::addFriction(Friction friction) {
  if (const auto surfaces = surfacesOf_.find(friction.contact); surfaces != surfacesOf_.end())
    findHeldDofs(surfaces->second);
  frictions_.push_back(std::move(friction));
}

void ConstraintCollector::addAdhesion(const Effect& contact, double normal, double tangential) {
  if (const auto surfaces = surfacesOf_.find(&contact); surfaces != surfacesOf_.end())
    findHeldDofs(surfaces->second);
  adhesions_.push_back({&contact, asked_, normal, tangential});
}

void ConstraintCollector::addTies(const std::vector<ContactPoint>& points,
                                  const std::vector<Part>& surfaces) {
  ties_.add(points, *asked_);
  findHeldDofs(surfaces);
}

// The same on every rank.
void ConstraintCollector::findHeldDofs(const std::vector<Part>& surfaces) {
  const int components = scene_.components();
  struct Item {
    long long dof;
    double time, value;
  };
  std::vector<Item> mine;
  for (const Part& part : surfaces) {
    const auto subdomains = withNodes_.find(part);
    if (subdomains == withNodes_.end())
      continue;
    for (const OwnedSubdomain* item : subdomains->second) {
      const std::vector<int>& nodes = item->mesh.sets.at(part.second);
      for (const auto& timed : held_)
        for (const feti::FixedDof& fixed : effects_.prescribed(*item, timed.first))
          if (const int node = fixed.dof / components; std::binary_search(nodes.begin(), nodes.end(), node))
            mine.push_back(
                {item->mesh.number(node) * components + fixed.dof % components, timed.first, fixed.value});
    }
  }
  for (const Item& item : gatherAll(comm_, mine))
    held_.at(item.time).emplace(item.dof, item.value);
}

void ConstraintCollector::collect(const Effect& effect) {
  asked_ = &effect;
  const auto scope = costs_.scope(effect);
  effect.addConstraints(*this);
}

void ConstraintCollector::addContactRows(ContactSetup& setup) {
  const std::vector<ContactPoint>& points = contacts_.all();
  setup.rows = contact::contactRows(comm_, points, scene_.components(), 0);
  const bool isScalar = scene_.components() == 1;
  for (const ConstraintRow& row : setup.rows) {
    const auto k = static_cast<std::size_t>(row.number);
    const Effect& effect = contacts_.effect(k);
    costs_.addRows(effect.kind(), 1);
    costs_.addBytes(effect.kind(), bytesOf(row));
    setup.origins.push_back(
        {&effect, points[k].position, isScalar ? directionOf(scene_, 0) : points[k].normal});
  }
}

namespace {

// Of each of the effects that act on contacts, the points that are its own: the first that names one has it.
template<class Acting>
std::vector<std::vector<std::size_t>> pointsOf(const std::vector<Acting>& acting,
                                               const DistinctPoints& contacts, std::size_t count) {
  std::unordered_map<const Effect*, std::size_t> actsOn;
  for (std::size_t f = 0; f < acting.size(); ++f)
    actsOn.emplace(acting[f].contact, f);
  std::vector<std::vector<std::size_t>> result(acting.size());
  for (std::size_t k = 0; k < count && !acting.empty(); ++k) {
    std::size_t first = acting.size();
    for (const Effect* effect : contacts.effectsAt(k))
      if (const auto found = actsOn.find(effect); found != actsOn.end())
        first = std::min(first, found->second);
    if (first < acting.size())
      result[first].push_back(k);
  }
  return result;
}

} // namespace

// Friction after friction, each with its points in their order.
void ConstraintCollector::findSlips(ContactSetup& setup) {
  const std::vector<ContactPoint>& points = contacts_.all();
  const std::vector<std::vector<std::size_t>> own = pointsOf(frictions_, contacts_, points.size());
  for (std::size_t f = 0; f < frictions_.size(); ++f)
    for (std::size_t k : own[f]) {
      contact::SlipPoint slip;
      slip.point = k;
      slip.tangents = contact::slipDirections(points[k], scene_.components(), held_);
      if (slip.tangents.empty())
        continue;
      slip.firstRow = setup.slipRows();
      slip.follows = frictions_[f].isByPressure;
      const double value = frictions_[f].value(points[k].position);
      (slip.follows ? slip.coefficient : slip.limit) = slip.follows ? value : value * points[k].area;
      setup.slips.push_back(slip);
      setup.frictions.push_back(frictions_[f].effect);
    }
}

// Likewise, after all friction.
void ConstraintCollector::findBonds(ContactSetup& setup) {
  const std::vector<ContactPoint>& points = contacts_.all();
  const double extent = adhesions_.empty() ? 0.0 : contact::extentOf(points);
  std::unordered_map<std::size_t, std::size_t> slipAt;
  for (std::size_t s = 0; s < setup.slips.size() && !adhesions_.empty(); ++s)
    slipAt.emplace(setup.slips[s].point, s);
  const std::vector<std::vector<std::size_t>> own = pointsOf(adhesions_, contacts_, points.size());
  for (std::size_t a = 0; a < adhesions_.size(); ++a) {
    const Adhesion& adhesion = adhesions_[a];
    const std::size_t before = setup.bonds.size();
    for (std::size_t k : own[a]) {
      if (!contact::touches(points[k], extent))
        continue;
      ContactSetup::Bond bond = {adhesion.effect, k, ContactSetup::Bond::none,
                                 1.0 / (adhesion.normal * points[k].area),
                                 1.0 / (adhesion.tangential * points[k].area)};
      if (const auto shared = slipAt.find(k); shared != slipAt.end()) {
        bond.slip = shared->second;
      } else if (std::vector<fem::Point> tangents =
                     contact::slipDirections(points[k], scene_.components(), held_);
                 !tangents.empty()) {
        bond.slip = setup.slips.size();
        contact::SlipPoint slip;
        slip.point = k;
        slip.tangents = std::move(tangents);
        slip.firstRow = setup.slipRows();
        slip.hasFriction = false;
        setup.slips.push_back(slip);
        setup.frictions.push_back(adhesion.effect);
      }
      setup.bonds.push_back(bond);
    }
    const std::size_t bound = setup.bonds.size() - before;
    note(adhesion.effect->label() + " binds " + std::to_string(bound) + " of the " +
         std::to_string(own[a].size()) + " points of " + adhesion.contact->label() +
         (bound == own[a].size() ? std::string()
                                 : "; at the other " + std::to_string(own[a].size() - bound) +
                                       " the surfaces are apart, or overlap: a contact without adhesion"));
  }
}

void ConstraintCollector::addSlipRows(ContactSetup& setup) {
  findSlips(setup);
  findBonds(setup);
  if (setup.slips.empty())
    return;
  const std::vector<ContactPoint>& points = contacts_.all();
  for (const Effect* friction : setup.frictions)
    costs_.addBytes(friction->kind(), sizeof(contact::SlipPoint));
  std::size_t s = 0;
  for (const ConstraintRow& row : contact::slipRows(comm_, points, setup.slips, scene_.components())) {
    const auto number = static_cast<std::size_t>(row.number);
    while (number >= setup.slips[s].firstRow + setup.slips[s].tangents.size())
      ++s;
    const contact::SlipPoint& slip = setup.slips[s];
    const std::string& kind = setup.frictions[s]->kind();
    costs_.addRows(kind, 1);
    costs_.addBytes(kind, bytesOf(row));
    setup.rows.push_back(row);
    setup.origins.push_back({&contacts_.effect(slip.point), points[slip.point].position,
                             slip.tangents[number - slip.firstRow], true});
  }
}

// The springs of what is bound.
void ConstraintCollector::soften(ContactSetup& setup) const {
  if (setup.bonds.empty())
    return;
  std::unordered_map<long long, double> ofPoint, ofSlip;
  for (const ContactSetup::Bond& bond : setup.bonds) {
    costs_.addBytes(bond.effect->kind(), sizeof(ContactSetup::Bond));
    ofPoint.emplace(static_cast<long long>(bond.point), bond.softness);
    if (bond.slip == ContactSetup::Bond::none)
      continue;
    const contact::SlipPoint& slip = setup.slips[bond.slip];
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      ofSlip.emplace(static_cast<long long>(slip.firstRow + t), bond.tangentialSoftness);
  }
  for (ConstraintRow& row : setup.rows) {
    if (row.kind == ConstraintRow::Kind::Equality)
      continue;
    const auto& known = row.kind == ConstraintRow::Kind::Inequality ? ofPoint : ofSlip;
    if (const auto found = known.find(row.number); found != known.end())
      row.softness = found->second;
  }
}

// Kind after kind, to know whose rows are whose; their points are not kept.
void ConstraintCollector::addTieRows(ContactSetup& setup) {
  const std::vector<ContactPoint>& ties = ties_.all();
  long long first = 0;
  for (std::size_t begin = 0, end = 0; begin < ties.size(); begin = end) {
    const std::string& kind = ties_.effect(begin).kind();
    while (end < ties.size() && ties_.effect(end).kind() == kind)
      ++end;
    const auto at = [&](std::size_t k) { return ties.begin() + static_cast<std::ptrdiff_t>(k); };
    const std::vector<ContactPoint> points(at(begin), at(end));
    contact::TieRows part;
    for (const auto& timed : held_) // the same rows each time, or a contradiction
      part = contact::tieRows(comm_, points, scene_.components(), first, timed.second);
    first += part.count;
    for (const ConstraintRow& row : part.rows)
      costs_.addBytes(kind, bytesOf(row));
    costs_.addRows(kind, static_cast<long long>(part.rows.size()));
    setup.rows.insert(setup.rows.end(), part.rows.begin(), part.rows.end());
    for (const auto& [point, component] : part.origins)
      setup.origins.push_back(
          {&ties_.effect(begin + point), ties[begin + point].position, directionOf(scene_, component)});
  }
}

ContactSetup ConstraintCollector::finish() {
  ContactSetup result;
  addContactRows(result);
  addSlipRows(result);
  soften(result);
  addTieRows(result);
  for (std::size_t k = 0; k < contacts_.all().size(); ++k) {
    costs_.addBytes(contacts_.effect(k).kind(), bytesOf(contacts_.all()[k]));
    result.effects.push_back(&contacts_.effect(k));
  }
  result.points = std::move(contacts_.all());
  result.notes = std::move(notes_);
  return result;
}

} // namespace Harmos::scene
