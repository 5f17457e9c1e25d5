// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ConstraintCollector.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GlobalOrder.hpp"
#include "Harmos_Log.hpp"
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

void DistinctPoints::add(const std::vector<ContactPoint>& more, const Effect& effect) {
  for (const ContactPoint& point : more) {
    all_.push_back(point);
    effects_.push_back({batches_.size()});
  }
  batches_.push_back(&effect);
}

namespace {

// Of points that came from all ranks, in the order in which their effects gave them.
struct Arrival {
  std::size_t batch, rank, place;
  const ContactPoint* point;
};

// What a rank is told of a point of its own: that it is kept, or, with a gap of no meaning, of one more
// effect.
struct Verdict {
  std::size_t point, batch;
  double gap;
  bool isFirst;
};

} // namespace

std::vector<DistinctPoints::Kept> DistinctPoints::distinct(const Teuchos::Comm<int>& comm) const {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<ContactPoint>> points(ranks);
  std::vector<std::vector<std::array<std::size_t, 2>>> places(ranks); // batch, and place here
  agree(comm, [&] {
    for (std::size_t k = 0; k < all_.size(); ++k) {
      const std::size_t home = homeOf(all_[k].terms.front().node, comm);
      points[home].push_back(all_[k]);
      places[home].push_back({effects_[k].front(), k});
    }
  });
  points = contact::exchangePoints(comm, points);
  places = exchangeItems(comm, places);
  std::vector<std::vector<Verdict>> verdicts(ranks);
  agree(comm, [&] {
    std::vector<Arrival> arrivals;
    for (std::size_t r = 0; r < ranks; ++r)
      for (std::size_t k = 0; k < points[r].size(); ++k)
        arrivals.push_back({places[r][k][0], r, places[r][k][1], &points[r][k]});
    std::sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) {
      return std::tie(a.batch, a.point->node, a.rank, a.place) <
             std::tie(b.batch, b.point->node, b.rank, b.place);
    });
    struct Survivor {
      const Arrival* first;
      std::size_t verdict; // of its rank
    };
    std::unordered_map<long long, std::vector<Survivor>> withNode; // by the lowest node
    for (const Arrival& item : arrivals) {
      std::vector<Survivor>& here = withNode[item.point->terms.front().node];
      const auto twin = std::find_if(here.begin(), here.end(), [&](const Survivor& survivor) {
        return sameRow(*survivor.first->point, *item.point);
      });
      if (twin == here.end()) {
        here.push_back({&item, verdicts[item.rank].size()});
        verdicts[item.rank].push_back({item.place, item.batch, item.point->gap, true});
        continue;
      }
      const Arrival& first = *twin->first;
      double& gap = verdicts[first.rank][twin->verdict].gap;
      if (std::isnan(item.point->gap) || item.point->gap < gap) // a NaN is kept, to be refused
        gap = item.point->gap;
      if (batches_[first.batch] != batches_[item.batch])
        verdicts[first.rank].push_back({first.place, item.batch, 0.0, false});
    }
  });
  std::map<std::size_t, Kept> kept;
  for (const std::vector<Verdict>& part : exchangeItems(comm, verdicts))
    for (const Verdict& verdict : part) {
      Kept& point = kept[verdict.point];
      point.point = verdict.point;
      point.batches.push_back(verdict.batch);
      if (verdict.isFirst)
        point.gap = verdict.gap;
    }
  std::vector<Kept> result;
  for (auto& [place, point] : kept)
    result.push_back(std::move(point));
  return result;
}

void DistinctPoints::finish(const Teuchos::Comm<int>& comm) {
  std::vector<Kept> kept = distinct(comm);
  const auto keyOf = [&](const Kept& point) {
    return OrderKey{static_cast<long long>(point.batches.front()), all_[point.point].node};
  };
  std::stable_sort(kept.begin(), kept.end(),
                   [&](const Kept& a, const Kept& b) { return keyOf(a) < keyOf(b); });
  std::vector<OrderKey> keys;
  std::vector<ContactPoint> points;
  effects_.clear();
  for (Kept& point : kept) {
    keys.push_back(keyOf(point));
    points.push_back(std::move(all_[point.point]));
    points.back().gap = point.gap;
    effects_.push_back(std::move(point.batches));
  }
  const std::vector<long long> numbers = sumsBefore(comm, keys, std::vector<long long>(keys.size(), 1));
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k].number = numbers[k];
  all_ = std::move(points);
  numberPressures(comm);
  count_ = globalSum(comm, static_cast<long long>(all_.size()));
}

// Terms of pressures name points of the same effect by node and side. Where one of them is another effect's,
// and goes by that one's node, the force of the row per area is what is left.
void DistinctPoints::numberPressures(const Teuchos::Comm<int>& comm) {
  const auto keyOf = [this](long long node, int side, std::size_t batch) {
    constexpr long long mostSides = 64;
    return (node * mostSides + side) * static_cast<long long>(batches_.size()) +
           static_cast<long long>(batch);
  };
  std::vector<std::pair<long long, long long>> known;
  std::vector<long long> asked;
  for (std::size_t k = 0; k < all_.size(); ++k) {
    for (const std::size_t batch : effects_[k])
      known.emplace_back(keyOf(all_[k].node, all_[k].side, batch), all_[k].number);
    for (const ContactPoint::PressureTerm& term : all_[k].pressure)
      asked.push_back(keyOf(term.node, term.side, effects_[k].front()));
  }
  if (globalMax(comm, static_cast<long long>(asked.size())) == 0)
    return;
  const std::vector<std::optional<long long>> numbers = lookUp(comm, known, asked);
  std::size_t next = 0;
  for (ContactPoint& point : all_) {
    bool isComplete = true;
    for (ContactPoint::PressureTerm& term : point.pressure) {
      term.number = numbers[next].value_or(-1);
      isComplete = isComplete && numbers[next++].has_value();
    }
    if (!isComplete)
      point.pressure.clear();
  }
}

std::vector<const Effect*> DistinctPoints::effectsAt(std::size_t point) const {
  std::vector<const Effect*> result;
  for (std::size_t batch : effects_[point])
    result.push_back(batches_[batch]);
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
      here_.withSides[{item.body, set.first}].push_back(&item.mesh);
    for (const auto& set : item.mesh.sets)
      here_.withNodes[{item.body, set.first}].push_back(&item);
  }
}

contact::Surface ConstraintCollector::surface(int body, const std::string& set,
                                              const contact::NormalField& normal) const {
  const auto found = here_.withSides.find({body, set});
  return contact::gatherSurface(
      comm_, found == here_.withSides.end() ? std::vector<const fem::PlacedMesh*>() : found->second, set,
      scene_.bodies[static_cast<std::size_t>(body)].name + "/" + set, normal);
}

void ConstraintCollector::addContacts(const std::vector<ContactPoint>& points,
                                      const std::vector<Part>& surfaces) {
  contacts_.add(points, *asked_);
  take(points, surfaces, false);
  surfacesOf_[asked_] = surfaces;
  if (isAlong(asked_))
    askForHeldDofs(surfaces);
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
      const auto subdomains = here_.withNodes.find(part);
      if (subdomains == here_.withNodes.end())
        continue;
      for (const OwnedSubdomain* item : subdomains->second) {
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
    for (const auto& [equation, effect] : equations_)
      for (const Equation::Term& term : equation.terms)
        asked.push_back(term.node.number * components + term.component);
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
      if (!contact::touches(points[k], extent))
        continue;
      ContactSetup::Bond bond = {adhesion.effect, k, ContactSetup::Bond::none,
                                 1.0 / (adhesion.glue.normal * points[k].area),
                                 1.0 / (adhesion.glue.tangential * points[k].area)};
      if (const auto shared = slipAt.find(k); shared != slipAt.end()) {
        bond.slip = shared->second;
      } else if (std::vector<fem::Point> tangents =
                     contact::slipDirections(points[k], scene_.components(), held_);
                 !tangents.empty()) {
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
    if (const auto subdomains = here_.withNodes.find(parts[k]); subdomains != here_.withNodes.end())
      for (const OwnedSubdomain* item : subdomains->second)
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

// On rank 0, behind the ties.
void ConstraintCollector::addEquationRows(ContactSetup& setup) {
  if (equations_.empty())
    return;
  const int components = scene_.components();
  long long number = 0;
  for (const ConstraintRow& row : setup.rows)
    number += row.kind == ConstraintRow::Kind::Equality ? 1 : 0;
  number = globalSum(comm_, number);
  for (const auto& [equation, effect] : equations_) {
    ConstraintRow row;
    row.bound = equation.value;
    for (const Equation::Term& term : equation.terms)
      row.terms.push_back({term.node.number * components + term.component, term.coefficient});
    if (isHeld(row, effect->label()) || row.terms.empty())
      continue;
    row.number = number++;
    if (comm_.getRank() != 0)
      continue;
    const Equation::Term& first = equation.terms.front();
    fem::Point direction = directionOf(scene_, first.component);
    for (double& x : direction)
      x *= first.coefficient;
    costs_.addRows(effect->kind(), 1);
    costs_.addBytes(effect->kind(), bytesOf(row));
    setup.rows.push_back(row);
    setup.origins.push_back({effect, first.node.position, direction, 0.0});
  }
}

// Whether all of its dofs are prescribed.
bool ConstraintCollector::isHeld(const ConstraintRow& row, const std::string& label) const {
  for (const auto& [time, held] : held_) {
    double sum = 0.0, size = std::abs(row.bound);
    for (const ConstraintRow::Term& term : row.terms) {
      const auto value = held.find(term.dof);
      if (value == held.end())
        return false;
      sum += term.coefficient * value->second;
      size = std::max(size, std::abs(term.coefficient * value->second));
    }
    constexpr double rounding = 1e-9;
    if (std::abs(sum - row.bound) > rounding * size)
      throw InputError(label +
                       " contradicts prescribed displacements: all displacements of an equation are "
                       "prescribed, and they make " +
                       scientific(sum) + " in the place of " + scientific(row.bound) +
                       "; prescribe other values or release one of them");
  }
  return true;
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

ContactSetup ConstraintCollector::finish() {
  ContactSetup result;
  contacts_.finish(comm_);
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
  addTieRows(result);
  addEquationRows(result);
  count(result);
  result.notes = std::move(notes_);
  return result;
}

} // namespace Harmos::scene
