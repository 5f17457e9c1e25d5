// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactFields.hpp"

#include "Harmos_Exchange.hpp"

#include <unordered_map>

namespace Harmos::run {

std::vector<ContactState> contactStates(const Teuchos::Comm<int>& comm,
                                        const std::vector<contact::ContactPoint>& points,
                                        const feti::ContactState& state) {
  struct Item {
    long long row;
    double gap;
    double force;
  };
  std::vector<Item> mine;
  for (std::size_t k = 0; k < state.row.size(); ++k)
    mine.push_back({state.row[k], state.gap[k], state.force[k]});
  std::vector<ContactState> result(points.size());
  for (const Item& item : gatherAll(comm, mine)) {
    const double area = points[static_cast<std::size_t>(item.row)].area;
    ContactState& point = result[static_cast<std::size_t>(item.row)];
    point.pressure = item.force / area;
    point.force = item.force;
    point.gap = item.gap;
    point.closed = item.force > 0.0;
  }
  return result;
}

ContactFields contactFields(const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states, ContactFieldKinds kinds) {
  struct Shown {
    const ContactState* state = nullptr;
    double sign = 1.0;
  };
  std::unordered_map<long long, Shown> atNode;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::vector<contact::ContactPoint::Term>& terms = points[k].terms;
    const bool nodeToNode = terms.size() == 2 && terms[0].weight * terms[1].weight == -1.0;
    for (const contact::ContactPoint::Term& term : terms)
      if (term.node == points[k].node || nodeToNode) {
        // A node of two interfaces shows the one that is closed.
        Shown& shown = atNode[term.node];
        if (shown.state == nullptr || !shown.state->closed)
          shown = {&states[k], term.node == points[k].node ? 1.0 : -1.0};
      }
  }
  ContactFields fields;
  for (const scene::OwnedSubdomain& subdomain : owned) {
    const auto nodes = static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes());
    std::vector<double> pressure(nodes, 0.0), gap(nodes, 0.0);
    std::vector<unsigned char> active(nodes, 0), friction(kinds.friction ? nodes : 0, 0);
    std::vector<double> traction(3 * friction.size(), 0.0), slip = traction;
    std::vector<double> damage(kinds.adhesion ? nodes : 0, 0.0), jump(3 * damage.size(), 0.0), whole = jump;
    for (std::size_t place = 0; place < subdomain.mesh.boundaryNumbers.size(); ++place) {
      const auto k = static_cast<std::size_t>(subdomain.mesh.mesh->boundary[place]);
      const auto found = atNode.find(subdomain.mesh.boundaryNumbers[place]);
      if (found == atNode.end())
        continue;
      const auto& [state, sign] = found->second;
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
      damage[k] = state->damage;
      for (std::size_t d = 0; d < 3; ++d) {
        jump[3 * k + d] = sign * state->jump[d];
        whole[3 * k + d] = sign * state->wholeTraction[d];
      }
    }
    if (kinds.adhesion) {
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
