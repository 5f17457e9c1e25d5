// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ConstraintCollector.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FiniteBehaviour.hpp"
#include "Harmos_GlobalOrder.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <unordered_map>

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

ConstraintCollector::ConstraintCollector(const Teuchos::Comm<int>& comm, const Scene& scene,
                                         const std::vector<OwnedSubdomain>& owned, EffectCosts& costs)
    : comm_(comm),
      scene_(scene),
      costs_(costs),
      effects_(scene, costs),
      places_{PartsOfRank(owned)},
      contacts_(scene.physics != Physics::Membrane),
      ties_(false) {
  held_[scene.timeline.ends().front()];
  if (scene.timeline.hasSteps())
    for (double time : scene.timeline.corners())
      held_[time];
}

ConstraintCollector::ConstraintCollector(const Teuchos::Comm<int>& comm, const Scene& scene,
                                         const std::vector<OwnedSubdomain>& moved, EffectCosts& costs,
                                         const AtRest& atRest)
    : ConstraintCollector(comm, scene, moved, costs) {
  places_.atRest.emplace(atRest.owned);
  if (atRest.bound == nullptr)
    return;
  places_.bound.emplace();
  for (const ContactSetup::Pairing& pairing : *atRest.bound)
    places_.bound->emplace(PointKey(pairing.contact, pairing.point.node, pairing.point.side), &pairing);
}

contact::Surface ConstraintCollector::surface(int body, const std::string& set,
                                              const contact::NormalField& normal) const {
  return contact::gatherSurface(comm_, partsOfAsked().withSides({body, set}), set,
                                scene_.bodies[static_cast<std::size_t>(body)].name + "/" + set, normal);
}

contact::Surface ConstraintCollector::surfaceAtRest(int body, const std::string& set) const {
  return contact::gatherSurface(comm_, partsAtRest().withSides({body, set}), set,
                                scene_.bodies[static_cast<std::size_t>(body)].name + "/" + set, nullptr);
}

void ConstraintCollector::addContacts(const std::vector<ContactPoint>& points,
                                      const std::vector<Part>& surfaces) {
  std::vector<ContactPoint> own = points;
  if (places_.bound)
    keepPairings(surfaces, own);
  contacts_.add(own, *asked_);
  take(own, surfaces, false);
  surfacesOf_[asked_] = surfaces;
  if (isAlong(asked_))
    askForHeldDofs(surfaces);
}

// What is bound faces what it was bound to, also where a search finds no counterpart any more.
void ConstraintCollector::keepPairings(const std::vector<Part>& surfaces,
                                       std::vector<ContactPoint>& points) const {
  std::set<std::pair<long long, int>> isThere;
  for (ContactPoint& point : points)
    if (const ContactSetup::Pairing* pairing = pairingOf(*asked_, point)) {
      point.terms = pairing->point.terms;
      point.area = pairing->point.area;
      isThere.emplace(point.node, point.side);
    }
  std::map<std::pair<long long, int>, const ContactPoint*> missing;
  for (const auto& [key, pairing] : *places_.bound)
    if (std::get<0>(key) == asked_ && isThere.count({pairing->point.node, pairing->point.side}) == 0)
      missing.emplace(std::pair(pairing->point.node, pairing->point.side), &pairing->point);
  if (globalMax(comm_, static_cast<long long>(missing.size())) == 0)
    return;
  const contact::Surface sides =
      contact::splitAtEdges(surface(surfaces.front().first, surfaces.front().second));
  // Smooth sides of a node that meet at an edge no more are one: what was bound to each stays so.
  std::map<long long, std::vector<std::size_t>> sidesOf;
  for (std::size_t k = 0; k < sides.numbers.size(); ++k)
    sidesOf[sides.numbers[k]].push_back(k);
  for (const auto& [key, point] : missing) {
    const std::vector<std::size_t>& its = sidesOf.at(key.first);
    const std::size_t k = its[std::min(static_cast<std::size_t>(key.second), its.size() - 1)];
    points.push_back(*point);
    points.back().position = sides.positions[k];
    points.back().normal = sides.normals[k];
    points.back().pressure.clear();
    points.back().beside.clear();
  }
}

// Whether friction or adhesion has asked for rows along the surfaces of a contact.
bool ConstraintCollector::isAlong(const Effect* contact) const {
  const auto isOn = [contact](const auto& item) { return item.contact == contact; };
  return std::any_of(frictions_.begin(), frictions_.end(), isOn) ||
         std::any_of(adhesions_.begin(), adhesions_.end(), isOn);
}

void ConstraintCollector::addFriction(Friction friction) {
  if (const auto surfaces = surfacesOf_.find(friction.contact); surfaces != surfacesOf_.end())
    askForHeldDofs(surfaces->second);
  frictions_.push_back(std::move(friction));
}

void ConstraintCollector::addAdhesion(const Effect& contact, const Glue& glue) {
  if (const auto surfaces = surfacesOf_.find(&contact); surfaces != surfacesOf_.end())
    askForHeldDofs(surfaces->second);
  adhesions_.push_back({&contact, asked_, glue});
}

// Points that are farther apart than a crack is long where it softens break one by one, each held by its
// neighbours: the interface bears more than it could.
void ConstraintCollector::tellOfProcessZone(const Adhesion& adhesion, long long bound, double area) {
  const auto surfaces = surfacesOf_.find(adhesion.contact);
  if (adhesion.glue.toughness == 0.0 || bound == 0 || surfaces == surfacesOf_.end())
    return;
  double young = std::numeric_limits<double>::infinity();
  for (const auto& surface : surfaces->second)
    for (const fem::Material& material : scene_.bodies[static_cast<std::size_t>(surface.first)].materials)
      young = std::min({young, material.young[0], material.young[1], material.young[2]});
  const double mean = area / static_cast<double>(bound);
  const double apart = scene_.components() == 3 ? std::sqrt(mean) : mean,
               zone = young * adhesion.glue.toughness;
  constexpr double fewest = 2.0; // points in it
  if (fewest * apart > zone)
    note(adhesion.effect->label() + ": process zone of its interface, E G/σ², about " + scientific(zone) +
         " long, point distance " + scientific(apart) +
         ": the computed strength is too high. Use smaller cells along it or a smaller strength at the same "
         "fracture energy");
}

std::vector<std::optional<ConstraintCollector::Taken>>
ConstraintCollector::taken(int body, int other, const std::vector<long long>& nodes) const {
  const auto found = taken_.find(std::minmax(body, other));
  const std::vector<std::pair<long long, Taken>> known =
      found == taken_.end() ? std::vector<std::pair<long long, Taken>>() : found->second;
  if (globalMax(comm_, static_cast<long long>(known.size())) == 0)
    return std::vector<std::optional<Taken>>(nodes.size());
  return lookUp(comm_, known, nodes, [](const Taken& next, const Taken& present) {
    return next.effect != present.effect ? next.effect < present.effect : next.normal < present.normal;
  });
}

// Nodes of both sides: the next effect may have its multipliers on the other one.
void ConstraintCollector::take(const std::vector<ContactPoint>& points, const std::vector<Part>& surfaces,
                               bool isTied) {
  if (surfaces.size() != 2)
    return;
  auto& known = taken_[std::minmax(surfaces[0].first, surfaces[1].first)];
  for (const ContactPoint& point : points)
    for (const ContactPoint::Term& term : point.terms)
      known.emplace_back(term.node, Taken{point.normal, isTied, askedBefore_});
}

void ConstraintCollector::addTies(const std::vector<ContactPoint>& points,
                                  const std::vector<Part>& surfaces) {
  take(points, surfaces, true);
  ties_.add(points, *asked_);
  askForHeldDofs(surfaces);
}

// Of the dofs of this rank's points: what is held there, on whatever rank it is prescribed.
void ConstraintCollector::findHeldDofs() {
  if (heldParts_.empty())
    return;
  const int components = scene_.components();
  const auto times = static_cast<long long>(held_.size());
  std::vector<std::pair<long long, double>> known; // by dof and time
  std::vector<long long> asked;
  agree(comm_, [&] {
    for (const Part& part : heldParts_) {
      for (const OwnedSubdomain* item : partsAtRest().withNodes(part)) {
        const std::vector<int>& nodes = item->mesh.sets.at(part.second);
        long long time = 0;
        for (const auto& timed : held_) {
          for (const feti::FixedDof& fixed : effects_.prescribed(*item, timed.first))
            if (const int node = fixed.dof / components; std::binary_search(nodes.begin(), nodes.end(), node))
              known.emplace_back((item->mesh.number(node) * components + fixed.dof % components) * times +
                                     time,
                                 fixed.value);
          ++time;
        }
      }
    }
    const bool areAlong = !frictions_.empty() || !adhesions_.empty();
    for (const DistinctPoints* points : {&contacts_, &ties_})
      for (const ContactPoint& point : points->all())
        if (points == &ties_ || areAlong)
          for (const ContactPoint::Term& term : point.terms)
            for (int c = 0; c < components; ++c)
              asked.push_back(term.node * components + c);
    for (const long long dof : equations_.dofs(components))
      asked.push_back(dof);
    std::sort(asked.begin(), asked.end());
    asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
    std::vector<long long> withTimes;
    for (const long long dof : asked)
      for (long long time = 0; time < times; ++time)
        withTimes.push_back(dof * times + time);
    asked = std::move(withTimes);
  });
  const std::vector<std::optional<double>> values =
      lookUp(comm_, known, asked, [](double next, double present) { return next < present; });
  std::vector<contact::HeldDofs*> byTime;
  for (auto& timed : held_)
    byTime.push_back(&timed.second);
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (values[k])
      byTime[static_cast<std::size_t>(asked[k] % times)]->emplace(asked[k] / times, *values[k]);
}

void ConstraintCollector::collect(const Effect& effect) {
  asked_ = &effect;
  ++askedBefore_;
  const auto scope = costs_.scope(effect);
  effect.addConstraints(*this);
}

std::string ConstraintCollector::faultOf(const Effect& effect) {
  asked_ = &effect;
  return effect.finite() != nullptr ? effect.finite()->fault(*this) : std::string();
}

void ConstraintCollector::addContactRows(ContactSetup& setup, double extent) {
  const std::vector<ContactPoint>& points = contacts_.all();
  setup.rows = contact::contactRows(points, scene_.components(), extent);
  const bool isScalar = scene_.components() == 1;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Effect& effect = contacts_.effect(k);
    costs_.addRows(effect.kind(), 1);
    costs_.addBytes(effect.kind(), bytesOf(setup.rows[k]));
    setup.origins.push_back(
        {&effect, points[k].position, isScalar ? directionOf(scene_, 0) : points[k].normal, points[k].area});
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

// Of a point that is bound, or null.
const ContactSetup::Pairing* ConstraintCollector::pairingOf(const Effect& contact,
                                                            const ContactPoint& point) const {
  if (!places_.bound)
    return nullptr;
  const auto bound = places_.bound->find({&contact, point.node, point.side});
  return bound == places_.bound->end() ? nullptr : bound->second;
}

// What is bound keeps its tangents, turned with the normal: slips along them go on.
std::vector<fem::Point> ConstraintCollector::tangentsOf(std::size_t point) const {
  const ContactPoint& at = contacts_.all()[point];
  const ContactSetup::Pairing* pairing = pairingOf(contacts_.effect(point), at);
  if (pairing == nullptr)
    return contact::slipDirections(at, scene_.components(), held_);
  std::vector<fem::Point> tangents;
  for (const fem::Point& tangent : pairing->tangents)
    tangents.push_back(turned(pairing->point.normal, at.normal, tangent));
  return tangents;
}

bool ConstraintCollector::binds(std::size_t point, double extent) const {
  return places_.bound ? pairingOf(contacts_.effect(point), contacts_.all()[point]) != nullptr
                       : contact::touches(gapAtBegin(point), extent);
}

// Friction after friction, each with its points in their order.
void ConstraintCollector::findSlips(ContactSetup& setup) {
  const std::vector<ContactPoint>& points = contacts_.all();
  const std::vector<std::vector<std::size_t>> own = pointsOf(frictions_, contacts_, points.size());
  for (std::size_t f = 0; f < frictions_.size(); ++f)
    for (std::size_t k : own[f]) {
      contact::SlipPoint slip;
      slip.point = k;
      slip.tangents = tangentsOf(k);
      if (slip.tangents.empty())
        continue;
      slip.firstPlace = setup.slipRows();
      slip.follows = frictions_[f].isByPressure;
      const double value = frictions_[f].value(points[k].position);
      (slip.follows ? slip.coefficient : slip.limit) = slip.follows ? value : value * points[k].area;
      setup.slips.push_back(slip);
      setup.frictions.push_back(frictions_[f].effect);
      slipOrder_.push_back(f);
    }
}

// Likewise, after all friction.
// When the run begins.
double ConstraintCollector::gapAtBegin(std::size_t point) const {
  const ContactPoint& at = contacts_.all()[point];
  return at.gap + (1.0 - scene_.timeline.factor(contacts_.effect(point), 0.0)) * at.interference;
}

// Which of two gaps is the smaller one would change over time.
void ConstraintCollector::requireOneInterference() const {
  agree(comm_, [&] {
    for (std::size_t k = 0; k < contacts_.all().size(); ++k) {
      const std::vector<const Effect*> effects = contacts_.effectsAt(k);
      const auto moves =
          std::find_if(effects.begin(), effects.end(), [](const Effect* e) { return e->hasMagnitude(); });
      if (effects.size() < 2 || moves == effects.end())
        continue;
      throw InputError((*moves)->label() + " has an interference where " +
                       (moves == effects.begin() ? effects.back() : effects.front())->label() +
                       " has the same point, at " + placeText(contacts_.all()[k].position) +
                       "; let one contact act there");
    }
  });
}

void ConstraintCollector::findBonds(ContactSetup& setup, double extent) {
  const std::vector<ContactPoint>& points = contacts_.all();
  std::unordered_map<std::size_t, std::size_t> slipAt;
  for (std::size_t s = 0; s < setup.slips.size() && !adhesions_.empty(); ++s)
    slipAt.emplace(setup.slips[s].point, s);
  const std::vector<std::vector<std::size_t>> own = pointsOf(adhesions_, contacts_, points.size());
  for (std::size_t a = 0; a < adhesions_.size(); ++a) {
    const Adhesion& adhesion = adhesions_[a];
    const std::size_t before = setup.bonds.size();
    double area = 0.0;
    for (std::size_t k : own[a]) {
      if (!binds(k, extent))
        continue;
      ContactSetup::Bond bond = {adhesion.effect, k, ContactSetup::Bond::none,
                                 1.0 / (adhesion.glue.normal * points[k].area),
                                 1.0 / (adhesion.glue.tangential * points[k].area)};
      if (const auto shared = slipAt.find(k); shared != slipAt.end()) {
        bond.slip = shared->second;
      } else if (std::vector<fem::Point> tangents = tangentsOf(k); !tangents.empty()) {
        bond.slip = setup.slips.size();
        contact::SlipPoint slip;
        slip.point = k;
        slip.tangents = std::move(tangents);
        slip.firstPlace = setup.slipRows();
        slip.hasFriction = false;
        setup.slips.push_back(slip);
        setup.frictions.push_back(adhesion.effect);
        slipOrder_.push_back(frictions_.size() + a);
      }
      setup.bonds.push_back(bond);
      area += points[k].area;
    }
    const long long bound = globalSum(comm_, static_cast<long long>(setup.bonds.size() - before)),
                    all = globalSum(comm_, static_cast<long long>(own[a].size()));
    note(adhesion.effect->label() + " binds " + std::to_string(bound) + " of the " + std::to_string(all) +
         " points of " + adhesion.contact->label() +
         (bound == all ? std::string()
                       : "; the other " + std::to_string(all - bound) +
                             " are apart or overlap: contact without adhesion"));
    tellOfProcessZone(adhesion, bound, globalSum(comm_, area));
  }
}

// Over all ranks, as the effects that ask for them follow each other, then by points.
void ConstraintCollector::numberSlips(ContactSetup& setup) const {
  std::vector<OrderKey> keys;
  std::vector<long long> rows;
  for (std::size_t s = 0; s < setup.slips.size(); ++s) {
    keys.push_back({static_cast<long long>(slipOrder_[s]), setup.points[setup.slips[s].point].number});
    rows.push_back(static_cast<long long>(setup.slips[s].tangents.size()));
  }
  const std::vector<long long> first = sumsBefore(comm_, keys, rows);
  for (std::size_t s = 0; s < setup.slips.size(); ++s)
    setup.slips[s].firstRow = first[s];
}

void ConstraintCollector::addSlipRows(ContactSetup& setup, double extent) {
  if (frictions_.empty() && adhesions_.empty())
    return;
  agree(comm_, [&] { findSlips(setup); });
  findBonds(setup, extent);
  numberSlips(setup);
  for (const Effect* friction : setup.frictions)
    costs_.addBytes(friction->kind(), sizeof(contact::SlipPoint));
  const std::vector<ContactPoint>& points = setup.points;
  const std::vector<ConstraintRow> rows = contact::slipRows(points, setup.slips, scene_.components(), extent);
  std::size_t row = 0;
  for (std::size_t s = 0; s < setup.slips.size(); ++s)
    for (const fem::Point& tangent : setup.slips[s].tangents) {
      const std::string& kind = setup.frictions[s]->kind();
      costs_.addRows(kind, 1);
      costs_.addBytes(kind, bytesOf(rows[row]));
      setup.rows.push_back(rows[row++]);
      const std::size_t point = setup.slips[s].point;
      setup.origins.push_back(
          {setup.effects[point], points[point].position, tangent, points[point].area, true});
    }
}

// The springs of what is bound.
void ConstraintCollector::soften(ContactSetup& setup) const {
  if (setup.bonds.empty())
    return;
  std::unordered_map<long long, double> ofPoint, ofSlip;
  for (const ContactSetup::Bond& bond : setup.bonds) {
    costs_.addBytes(bond.effect->kind(), sizeof(ContactSetup::Bond));
    ofPoint.emplace(setup.points[bond.point].number, bond.softness);
    if (bond.slip == ContactSetup::Bond::none)
      continue;
    const contact::SlipPoint& slip = setup.slips[bond.slip];
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      ofSlip.emplace(slip.firstRow + static_cast<long long>(t), bond.tangentialSoftness);
  }
  for (ConstraintRow& row : setup.rows) {
    if (row.kind == ConstraintRow::Kind::Equality)
      continue;
    const auto& known = row.kind == ConstraintRow::Kind::Inequality ? ofPoint : ofSlip;
    if (const auto found = known.find(row.number); found != known.end())
      row.softness = found->second;
  }
}

// Where both sides of deformed bodies are held a row says what solves are accurate to, and has no force; the
// audit sees what is wrong with it.
void ConstraintCollector::loosenHeldRows(ContactSetup& setup, double extent) const {
  if (!places_.atRest || held_.empty())
    return;
  const contact::HeldDofs& held = held_.begin()->second;
  constexpr double loose = 1e-3;
  for (ConstraintRow& row : setup.rows)
    if (std::all_of(row.terms.begin(), row.terms.end(),
                    [&](const ConstraintRow::Term& term) { return held.count(term.dof) > 0; }))
      row.rounding = loose * extent;
}

// The points of ties are not kept.
void ConstraintCollector::addTieRows(ContactSetup& setup) {
  const std::vector<ContactPoint>& points = ties_.all();
  const int components = scene_.components();
  std::vector<std::vector<int>> tied;
  std::vector<OrderKey> keys;
  std::vector<long long> counts;
  agree(comm_, [&] {
    for (const ContactPoint& point : points) {
      std::vector<int> here;
      for (const auto& timed : held_) // the same rows each time, or a contradiction
        here = contact::tiedComponents(point, components, timed.second);
      keys.push_back({point.number, 0});
      counts.push_back(static_cast<long long>(here.size()));
      tied.push_back(std::move(here));
    }
  });
  const std::vector<long long> first = sumsBefore(comm_, keys, counts);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Effect& effect = ties_.effect(k);
    long long number = first[k];
    for (int component : tied[k]) {
      setup.rows.push_back(contact::tieRow(points[k], component, components, number++));
      costs_.addRows(effect.kind(), 1);
      costs_.addBytes(effect.kind(), bytesOf(setup.rows.back()));
      setup.origins.push_back({&effect, points[k].position, directionOf(scene_, component), points[k].area});
    }
  }
}

std::vector<ConstraintCollector::Node> ConstraintCollector::nodesOf(const std::vector<Part>& parts) {
  askForHeldDofs(parts);
  struct Found {
    std::size_t part;
    Node node;
  };
  std::vector<Found> found;
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (const OwnedSubdomain* item : partsOfAsked().withNodes(parts[k]))
      for (int node : item->mesh.sets.at(parts[k].second))
        found.push_back({k, {item->mesh.number(node), item->mesh.position(node)}});
  std::vector<Node> nodes(parts.size(), Node{-1, {}});
  for (const Found& item : gatherAll(comm_, found)) {
    Node& node = nodes[item.part];
    if (node.number >= 0 && node.number != item.node.number)
      throw InputError(asked_->label() + ": the boundary part \"" + parts[item.part].second +
                           "\" of body \"" +
                           scene_.bodies[static_cast<std::size_t>(parts[item.part].first)].name +
                           "\" has several nodes; a term of an equation needs a part of one node",
                       {{"set", parts[item.part].second}});
    node = item.node;
  }
  return nodes;
}

namespace {

PartMeasure measureIn(const Teuchos::Comm<int>& comm, const PartsOfRank& parts,
                      const PartsOfRank::Part& part) {
  std::vector<PartMeasure> mine;
  for (const OwnedSubdomain* item : parts.withNodes(part))
    if (mine.empty())
      mine.push_back(item->measures.at(part.second));
  mine = gatherAll(comm, mine);
  HARMOS_REQUIRE(!mine.empty(), "a part that an effect measures has no nodes");
  return mine.front();
}

using Node = ConstraintCollector::Node;

std::vector<Node> allNodesIn(const Teuchos::Comm<int>& comm, const PartsOfRank& parts,
                             const PartsOfRank::Part& part) {
  std::vector<Node> nodes;
  for (const OwnedSubdomain* item : parts.withNodes(part))
    for (int node : item->mesh.sets.at(part.second))
      nodes.push_back({item->mesh.number(node), item->mesh.position(node)});
  nodes = gatherAll(comm, nodes);
  const auto isBefore = [](const Node& a, const Node& b) {
    return std::tie(a.number, a.position) < std::tie(b.number, b.position);
  };
  std::sort(nodes.begin(), nodes.end(), isBefore);
  nodes.erase(std::unique(nodes.begin(), nodes.end(),
                          [](const Node& a, const Node& b) { return a.number == b.number; }),
              nodes.end());
  return nodes;
}

} // namespace

PartMeasure ConstraintCollector::measureOf(int body, const std::string& set) const {
  return measureIn(comm_, partsOfAsked(), {body, set});
}

PartMeasure ConstraintCollector::measureAtRest(int body, const std::string& set) const {
  return measureIn(comm_, partsAtRest(), {body, set});
}

std::vector<ConstraintCollector::Node> ConstraintCollector::allNodesOf(int body, const std::string& set) {
  askForHeldDofs({{body, set}});
  return allNodesIn(comm_, partsOfAsked(), {body, set});
}

std::vector<ConstraintCollector::Node> ConstraintCollector::allNodesAtRest(int body,
                                                                           const std::string& set) const {
  return allNodesIn(comm_, partsAtRest(), {body, set});
}

bool ConstraintCollector::isHeldAnywhere(int body, const std::string& set, int component) {
  long long found = 0;
  agree(comm_, [&] {
    for (const OwnedSubdomain* item : partsAtRest().withNodes({body, set})) {
      const std::vector<int>& nodes = item->mesh.sets.at(set);
      for (const auto& timed : held_)
        for (const feti::FixedDof& fixed : effects_.prescribed(*item, timed.first))
          if (fixed.dof % scene_.components() == component &&
              std::binary_search(nodes.begin(), nodes.end(), fixed.dof / scene_.components()))
            found = 1;
    }
  });
  return globalMax(comm_, found) > 0;
}

// On rank 0, behind the ties, and behind the slips.
void ConstraintCollector::addEquationRows(ContactSetup& setup) {
  const std::vector<EquationRows::Row> rows = equations_.rows(scene_, held_);
  if (rows.empty())
    return;
  long long number = 0;
  for (const ConstraintRow& row : setup.rows)
    number += row.kind == ConstraintRow::Kind::Equality ? 1 : 0;
  number = globalSum(comm_, number);
  long long limited = globalSum(comm_, static_cast<long long>(setup.slipRows()));
  for (const EquationRows::Row& item : rows) {
    if (item.lockedFrom)
      setup.locks.push_back({item.effect, *item.lockedFrom, setup.rows.size(), item.row.terms});
    if (comm_.getRank() != 0)
      continue;
    setup.rows.push_back(item.row);
    setup.rows.back().number = item.lockedFrom ? limited++ : number++;
    setup.origins.push_back({item.effect, item.position, item.direction, 0.0, false, item.counter});
    costs_.addRows(item.effect->kind(), 1);
    costs_.addBytes(item.effect->kind(), bytesOf(item.row));
  }
}

// Over all ranks.
void ConstraintCollector::count(ContactSetup& setup) const {
  setup.pointCount = contacts_.count();
  setup.limitedRows = globalSum(comm_, static_cast<long long>(setup.slipRows()));
  setup.bondCount = globalSum(comm_, static_cast<long long>(setup.bonds.size()));
  if (setup.limitedRows == 0)
    return;
  std::vector<double> has(scene_.effects.size() + 1, 0.0); // of each effect whether it has tangential rows
  std::map<const Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene_.effects.size(); ++k)
    places[scene_.effects[k].get()] = k;
  for (const contact::SlipPoint& slip : setup.slips) {
    has[places.at(setup.effects[slip.point])] = 1.0;
    has.back() = slip.hasFriction ? 1.0 : has.back();
  }
  globalSum(comm_, has);
  setup.hasFriction = has.back() > 0.0;
  for (std::size_t k = 0; k < scene_.effects.size(); ++k)
    if (has[k] > 0.0)
      setup.tangential.insert(scene_.effects[k].get());
}

namespace {

// Effects whose magnitude is that of rows, not of loads or of prescribed values of bodies.
bool movesRows(const Effect& effect) {
  return effect.hasMagnitude() && effect.bodies().empty() && effect.exertsForce();
}

// Of equations their value, of contacts the interference, as a gap that gets smaller.
std::vector<double> movingParts(const ContactSetup& setup) {
  std::unordered_map<long long, double> interference; // by the number of the row
  for (const ContactPoint& point : setup.points)
    interference[point.number] = point.interference;
  std::vector<double> moving(setup.rows.size(), 0.0);
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const ConstraintRow& row = setup.rows[k];
    if (row.kind == ConstraintRow::Kind::Inequality)
      moving[k] = -interference.at(row.number);
    else if (row.kind == ConstraintRow::Kind::Equality && movesRows(*setup.origins[k].effect))
      moving[k] = row.bound;
  }
  return moving;
}

} // namespace

ContactSetup ConstraintCollector::finish() {
  ContactSetup result;
  contacts_.finish(comm_);
  requireOneInterference();
  ties_.finish(comm_);
  findHeldDofs();
  const double extent = contact::extentOf(comm_, contacts_.all());
  addContactRows(result, extent);
  for (std::size_t k = 0; k < contacts_.all().size(); ++k) {
    costs_.addBytes(contacts_.effect(k).kind(), bytesOf(contacts_.all()[k]));
    result.effects.push_back(&contacts_.effect(k));
  }
  result.points = contacts_.all();
  addSlipRows(result, extent);
  soften(result);
  loosenHeldRows(result, extent);
  addTieRows(result);
  addEquationRows(result);
  count(result);
  result.moving = movingParts(result);
  result.notes = std::move(notes_);
  return result;
}

} // namespace Harmos::scene
