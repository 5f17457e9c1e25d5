// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MovedBonds.hpp"

#include "Harmos_PointAlgebra.hpp"

#include <cmath>

namespace Harmos::run {

using Bond = scene::ContactSetup::Bond;

MovedBonds::MovedBonds(const std::vector<scene::OwnedSubdomain>& owned, const scene::ContactSetup& atRest,
                       const DeformedBodies& bodies)
    : bodies_(bodies) {
  points_.bondCount = atRest.bondCount;
  points_.pointCount = atRest.pointCount;
  points_.limitedRows = atRest.limitedRows;
  for (Bond bond : atRest.bonds) {
    const contact::ContactPoint& point = atRest.points[bond.point];
    AtRest& its = atRest_.emplace_back();
    its.normal = point.normal;
    placeOf_.emplace(Key(atRest.effects[bond.point], point.node, point.side), points_.points.size());
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Inequality;
    row.number = point.number;
    points_.rows.push_back(row);
    if (bond.slip != Bond::none) {
      contact::SlipPoint slip = atRest.slips[bond.slip];
      its.tangents = slip.tangents;
      slip.point = points_.points.size();
      slip.firstPlace = points_.slipRows();
      slip.hasFriction = false;
      bond.slip = points_.slips.size();
      points_.slips.push_back(slip);
      points_.frictions.push_back(bond.effect);
    }
    points_.effects.push_back(atRest.effects[bond.point]);
    bond.point = points_.points.size();
    points_.points.push_back(point);
    points_.bonds.push_back(bond);
  }
  for (const contact::SlipPoint& slip : points_.slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
      ConstraintRow row;
      row.kind = ConstraintRow::Kind::Limited;
      row.number = slip.firstRow + static_cast<long long>(t);
      points_.rows.push_back(row);
    }
  findJumps(owned);
}

// j₀; nothing on obstacles.
void MovedBonds::findJumps(const std::vector<scene::OwnedSubdomain>& owned) {
  if (!any())
    return;
  const auto components = static_cast<std::size_t>(bodies_.components());
  feti::TornVector places;
  for (const scene::OwnedSubdomain& item : owned) {
    std::vector<double>& own = places.emplace_back();
    for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node) {
      const fem::Point x = item.mesh.position(node);
      own.insert(own.end(), x.begin(), x.begin() + static_cast<std::ptrdiff_t>(components));
    }
  }
  std::vector<ConstraintRow> rows;
  std::vector<char> hasTwoSides;
  for (const contact::ContactPoint& point : points_.points) {
    double sum = 0.0;
    for (const contact::ContactPoint::Term& term : point.terms)
      sum += term.weight;
    constexpr double half = 0.5; // 0, or 1 on an obstacle
    hasTwoSides.push_back(std::abs(sum) < half ? 1 : 0);
    for (std::size_t c = 0; c < components; ++c)
      rows.push_back(contact::tieRow(point, static_cast<int>(c), bodies_.components(), 0));
  }
  const std::vector<double> products = bodies_.products(rows, places);
  for (std::size_t k = 0; k < atRest_.size(); ++k)
    for (std::size_t c = 0; c < components && hasTwoSides[k] != 0; ++c)
      atRest_[k].jump[c] = products[k * components + c];
}

std::vector<scene::ContactSetup::Pairing> MovedBonds::pairings() const {
  std::vector<scene::ContactSetup::Pairing> result;
  if (!any())
    return result;
  const std::vector<char> broken = states_->broken();
  for (std::size_t k = 0; k < atRest_.size(); ++k)
    if (broken[k] == 0) {
      result.push_back({points_.effects[k], points_.points[k], atRest_[k].tangents});
      result.back().point.normal = atRest_[k].normal;
    }
  return result;
}

void MovedBonds::release(scene::ContactSetup& contact) const {
  if (!any())
    return;
  const std::vector<char> broken = states_->broken();
  std::vector<Bond> held;
  for (std::size_t k = 0; k < contact.bonds.size(); ++k) {
    const Bond& bond = contact.bonds[k];
    if (broken[k] == 0) {
      held.push_back(bond);
      continue;
    }
    contact.rows[bond.point].softness.reset();
    for (std::size_t t = 0; bond.slip != Bond::none && t < contact.slips[bond.slip].tangents.size(); ++t)
      contact.rows[contact.points.size() + contact.slips[bond.slip].firstPlace + t].softness.reset();
  }
  contact.bonds = std::move(held);
}

std::vector<MovedBonds::Place> MovedBonds::placesIn(const scene::ContactSetup& contact) const {
  std::vector<Place> places;
  for (const Bond& bond : contact.bonds) {
    const contact::ContactPoint& point = contact.points[bond.point];
    places.push_back(
        {placeOf_.at(Key(contact.effects[bond.point], point.node, point.side)), bond.point, bond.slip});
  }
  return places;
}

void MovedBonds::hold(scene::ContactSetup& contact, const feti::TornVector& displacement) const {
  if (!any())
    return;
  const std::vector<Place> places = placesIn(contact);
  const std::size_t points = contact.points.size();
  std::vector<ConstraintRow> asked; // of each place the normal row, then its slips
  for (const Place& place : places) {
    asked.push_back(contact.rows[place.point]);
    asked.back().kind = ConstraintRow::Kind::Equality;
    if (place.slip != Bond::none)
      for (std::size_t t = 0; t < contact.slips[place.slip].tangents.size(); ++t)
        asked.push_back(contact.rows[points + contact.slips[place.slip].firstPlace + t]);
  }
  const std::vector<double> products = bodies_.products(asked, displacement);
  const std::vector<ConstraintRow> springs = states_->rows();
  std::size_t next = 0;
  for (const Place& place : places) {
    const AtRest& rest = atRest_[place.own];
    const contact::ContactPoint& point = contact.points[place.point];
    ConstraintRow& row = contact.rows[place.point];
    row.bound += points_.points[place.own].gap - point.gap + springs[place.own].bound -
                 (products[next++] + dot(point.normal, rest.jump) - dot(rest.normal, rest.jump));
    row.softness = springs[place.own].softness;
    if (place.slip == Bond::none)
      continue;
    const contact::SlipPoint& slip = contact.slips[place.slip];
    const std::size_t first = points_.points.size() + points_.slips[points_.bonds[place.own].slip].firstPlace;
    for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
      const ConstraintRow& spring = springs[first + t];
      ConstraintRow& along = contact.rows[points + slip.firstPlace + t];
      const double now =
          products[next++] + dot(slip.tangents[t], rest.jump) - dot(rest.tangents[t], rest.jump);
      along.softness = spring.softness;
      if (takesOver(place.own, spring))
        along.bound = spring.bound - now;
    }
  }
}

// Whether a spring says where its row has no force: else it broke at once, and friction begins where the step
// did.
bool MovedBonds::takesOver(std::size_t own, const ConstraintRow& spring) const {
  return spring.softness || points_.bonds[own].effect->interfaceLaw()->softens();
}

void MovedBonds::addSlipsBefore(const scene::ContactSetup& contact, std::vector<double>& slips) const {
  if (!any())
    return;
  const std::vector<ConstraintRow> springs = states_->rows();
  for (const Place& place : placesIn(contact)) {
    if (place.slip == Bond::none)
      continue;
    const std::size_t first = points_.points.size() + points_.slips[points_.bonds[place.own].slip].firstPlace;
    const contact::SlipPoint& slip = contact.slips[place.slip];
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      if (takesOver(place.own, springs[first + t]))
        slips[slip.firstPlace + t] = springs[first + t].bound;
  }
}

MovedBonds::Answer MovedBonds::answer(const scene::ContactSetup& contact,
                                      const std::vector<ContactState>& states,
                                      const std::vector<RowSlip>& slips) const {
  Answer result = {std::vector<ContactState>(points_.points.size()),
                   std::vector<RowSlip>(points_.slipRows())};
  for (const Place& place : placesIn(contact)) {
    result.states[place.own] = states[place.point];
    if (place.slip == Bond::none)
      continue;
    const std::size_t first = points_.slips[points_.bonds[place.own].slip].firstPlace;
    const contact::SlipPoint& slip = contact.slips[place.slip];
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      result.slips[first + t] = slips[slip.firstPlace + t];
  }
  return result;
}

void MovedBonds::tell(scene::ContactSetup& contact, const std::vector<RowSlip>& slips,
                      std::vector<ContactState>& states) {
  if (!any())
    return;
  Answer own = answer(contact, states, slips);
  const std::vector<Place> places = placesIn(contact);
  for (const Place& place : places) {
    points_.points[place.own].normal = contact.points[place.point].normal;
    if (place.slip != Bond::none)
      points_.slips[points_.bonds[place.own].slip].tangents = contact.slips[place.slip].tangents;
  }
  states_->tell(own.slips, own.states);
  for (const Place& place : places)
    states[place.point] = own.states[place.own];
  // What has broken is a contact now.
  std::map<Key, std::size_t> pointOf;
  for (std::size_t k = 0; k < contact.points.size(); ++k)
    pointOf.emplace(Key(contact.effects[k], contact.points[k].node, contact.points[k].side), k);
  const std::vector<char> broken = states_->broken();
  for (const auto& [key, k] : placeOf_) {
    if (broken[k] == 0)
      continue;
    const auto found = pointOf.find(key);
    const std::size_t place = found != pointOf.end() ? found->second : contact.points.size();
    if (found == pointOf.end()) {
      contact.points.push_back(points_.points[k]);
      contact.effects.push_back(points_.effects[k]);
      states.emplace_back();
    }
    ContactState& state = states[place];
    state.isBound = true;
    state.damage = 1.0;
    for (std::size_t d = 0; d < 3; ++d) {
      state.jump[d] = state.slip[d] - state.gap * contact.points[place].normal[d];
      state.wholeTraction[d] = state.traction[d] - state.pressure * contact.points[place].normal[d];
    }
  }
}

} // namespace Harmos::run
