// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactFields.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <unordered_map>

namespace Harmos::run {

std::vector<fem::Point> tractions(const Teuchos::Comm<int>& comm,
                                  const std::vector<contact::ContactPoint>& points,
                                  const std::vector<fem::Point>& forces) {
  std::vector<std::pair<long long, fem::Point>> known;
  std::vector<long long> asked;
  for (std::size_t k = 0; k < points.size(); ++k) {
    known.emplace_back(points[k].number, forces[k]);
    for (const contact::ContactPoint::PressureTerm& term : points[k].pressure)
      asked.push_back(term.number);
  }
  std::vector<std::optional<fem::Point>> answers;
  if (globalMax(comm, static_cast<long long>(asked.size())) > 0)
    answers = lookUp(comm, known, asked);
  std::vector<fem::Point> result;
  std::size_t next = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    fem::Point& traction = result.emplace_back();
    for (std::size_t d = 0; d < 3 && points[k].pressure.empty(); ++d)
      traction[d] = forces[k][d] / points[k].area;
    for (const contact::ContactPoint::PressureTerm& term : points[k].pressure) {
      const fem::Point force = answers[next++].value_or(fem::Point{});
      for (std::size_t d = 0; d < 3; ++d)
        traction[d] += term.weight * force[d];
    }
  }
  return result;
}

std::vector<ContactState> contactStates(const Teuchos::Comm<int>& comm,
                                        const std::vector<contact::ContactPoint>& points,
                                        const feti::ContactState& state) {
  struct Answer {
    double gap, force;
  };
  std::vector<std::pair<long long, Answer>> known;
  for (std::size_t k = 0; k < state.row.size(); ++k)
    known.emplace_back(state.row[k], Answer{state.gap[k], state.force[k]});
  std::vector<long long> asked;
  for (const contact::ContactPoint& point : points)
    asked.push_back(point.number);
  const std::vector<std::optional<Answer>> answers = lookUp(comm, known, asked);
  std::vector<fem::Point> forces;
  for (const std::optional<Answer>& answer : answers)
    forces.push_back({answer ? answer->force : 0.0, 0.0, 0.0});
  const std::vector<fem::Point> pressures = tractions(comm, points, forces);
  std::vector<ContactState> result(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Answer answer = answers[k].value_or(Answer{0.0, 0.0});
    ContactState& point = result[k];
    point.pressure = pressures[k][0];
    point.force = answer.force;
    point.gap = answer.gap;
    point.closed = answer.force > 0.0;
  }
  return result;
}

ContactCounts countContact(const Teuchos::Comm<int>& comm, const std::vector<ContactState>& states) {
  std::vector<double> counts(6, 0.0);
  for (const ContactState& state : states) {
    const bool kinds[] = {true,
                          state.closed,
                          state.friction == Friction::Sticks,
                          state.friction == Friction::Slips,
                          state.isBound && state.damage == 1.0,
                          state.damage > 0.0};
    for (std::size_t k = 0; k < counts.size(); ++k)
      counts[k] += kinds[k] ? 1.0 : 0.0;
  }
  globalSum(comm, counts);
  const auto at = [&](std::size_t k) { return static_cast<long long>(counts[k]); };
  return {at(0), at(1), at(2), at(3), at(4), at(5)};
}

WholeContact gatherContact(const Teuchos::Comm<int>& comm, const std::vector<contact::ContactPoint>& points,
                           const std::vector<ContactState>& states) {
  struct Numbered {
    long long number;
    ContactState state;
  };
  std::vector<Numbered> mine;
  for (std::size_t k = 0; k < states.size(); ++k)
    mine.push_back({points[k].number, states[k]});
  std::vector<Numbered> all = gatherAll(comm, mine);
  std::sort(all.begin(), all.end(), [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  WholeContact result{contact::gatherPoints(comm, points), {}};
  for (const Numbered& item : all)
    result.states.push_back(item.state);
  return result;
}

namespace {

// Of a point at one of its nodes.
struct Shown {
  long long number = -1;
  ContactState state{};
  double sign = 1.0;
};

std::unordered_map<long long, Shown> shownAt(const Teuchos::Comm<int>& comm,
                                             const std::vector<scene::OwnedSubdomain>& owned,
                                             const std::vector<contact::ContactPoint>& points,
                                             const std::vector<ContactState>& states) {
  std::vector<std::pair<long long, Shown>> known;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::vector<contact::ContactPoint::Term>& terms = points[k].terms;
    const bool nodeToNode = terms.size() == 2 && terms[0].weight * terms[1].weight == -1.0;
    for (const contact::ContactPoint::Term& term : terms)
      if (term.node == points[k].node || nodeToNode)
        known.emplace_back(term.node,
                           Shown{points[k].number, states[k], term.node == points[k].node ? 1.0 : -1.0});
  }
  std::vector<long long> nodes;
  for (const scene::OwnedSubdomain& subdomain : owned)
    nodes.insert(nodes.end(), subdomain.mesh.boundaryNumbers.begin(), subdomain.mesh.boundaryNumbers.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  // A node of several interfaces shows the first one that is closed; none is: the last one.
  const auto answers = lookUp(comm, known, nodes, [](const Shown& next, const Shown& present) {
    if (next.state.closed != present.state.closed)
      return next.state.closed;
    return next.state.closed ? next.number < present.number : next.number > present.number;
  });
  std::unordered_map<long long, Shown> result;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (answers[k])
      result.emplace(nodes[k], *answers[k]);
  return result;
}

// Pressures at nodes beside points, which have none of their own: means by weights. @note Collective.
std::unordered_map<long long, double> pressuresBeside(const Teuchos::Comm<int>& comm,
                                                      const std::vector<contact::ContactPoint>& points,
                                                      const std::vector<ContactState>& states) {
  struct Part {
    long long node, number;
    double weight, pressure;
  };
  std::vector<Part> parts;
  for (std::size_t k = 0; k < points.size(); ++k)
    for (const contact::ContactPoint::Term& term : points[k].beside)
      parts.push_back({term.node, points[k].number, term.weight, states[k].pressure});
  parts = gatherAll(comm, parts); // few: at ends of interfaces
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.number < b.number; });
  std::unordered_map<long long, double> weights, result;
  for (const Part& part : parts) {
    weights[part.node] += part.weight;
    result[part.node] += part.weight * part.pressure;
  }
  for (auto& [node, pressure] : result)
    pressure /= weights[node];
  return result;
}

} // namespace

ContactFields contactFields(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states, ContactFieldKinds kinds) {
  const std::unordered_map<long long, Shown> atNode = shownAt(comm, owned, points, states);
  const std::unordered_map<long long, double> beside = pressuresBeside(comm, points, states);
  ContactFields fields;
  for (const scene::OwnedSubdomain& subdomain : owned) {
    const auto nodes = static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes());
    std::vector<double> pressure(nodes, 0.0), gap(nodes, 0.0);
    std::vector<unsigned char> active(nodes, 0), friction(kinds.friction ? nodes : 0, 0),
        bound(kinds.adhesion ? nodes : 0, 0);
    std::vector<double> traction(3 * friction.size(), 0.0), slip = traction;
    std::vector<double> damage(kinds.adhesion ? nodes : 0, 0.0), jump(3 * damage.size(), 0.0), whole = jump;
    for (std::size_t place = 0; place < subdomain.mesh.boundaryNumbers.size(); ++place) {
      const auto k = static_cast<std::size_t>(subdomain.mesh.mesh->boundary[place]);
      const auto found = atNode.find(subdomain.mesh.boundaryNumbers[place]);
      if (found == atNode.end()) {
        if (const auto next = beside.find(subdomain.mesh.boundaryNumbers[place]); next != beside.end())
          pressure[k] = next->second;
        continue;
      }
      const ContactState* state = &found->second.state;
      const double sign = found->second.sign;
      pressure[k] = state->pressure;
      gap[k] = state->gap;
      active[k] = state->closed ? 2 : 1;
      if (kinds.friction)
        friction[k] = static_cast<unsigned char>(state->friction);
      for (std::size_t d = 0; d < 3 && kinds.friction; ++d) {
        traction[3 * k + d] = sign * state->traction[d];
        slip[3 * k + d] = sign * state->slip[d];
      }
      if (!kinds.adhesion || !state->isBound)
        continue;
      bound[k] = 1;
      damage[k] = state->damage;
      for (std::size_t d = 0; d < 3; ++d) {
        jump[3 * k + d] = sign * state->jump[d];
        whole[3 * k + d] = sign * state->wholeTraction[d];
      }
    }
    if (kinds.adhesion) {
      fields.bound.push_back(std::move(bound));
      fields.damage.push_back(std::move(damage));
      fields.jump.push_back(std::move(jump));
      fields.interfaceTraction.push_back(std::move(whole));
    }
    if (kinds.friction) {
      fields.friction.push_back(std::move(friction));
      fields.traction.push_back(std::move(traction));
      fields.slip.push_back(std::move(slip));
    }
    fields.pressure.push_back(std::move(pressure));
    fields.gap.push_back(std::move(gap));
    fields.activeSet.push_back(std::move(active));
  }
  return fields;
}

} // namespace Harmos::run
