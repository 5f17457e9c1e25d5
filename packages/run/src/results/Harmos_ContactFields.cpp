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
    result[static_cast<std::size_t>(item.row)] = {item.force / area, item.force, item.gap, item.force > 0.0};
  }
  return result;
}

ContactFields contactFields(const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states) {
  std::unordered_map<long long, const ContactState*> atNode;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::vector<contact::ContactPoint::Term>& terms = points[k].terms;
    const bool nodeToNode = terms.size() == 2 && terms[0].weight * terms[1].weight == -1.0;
    for (const contact::ContactPoint::Term& term : terms)
      if (term.node == points[k].node || nodeToNode) {
        // A node of two interfaces shows the one that is closed.
        const ContactState*& shown = atNode[term.node];
        if (shown == nullptr || !shown->closed)
          shown = &states[k];
      }
  }
  ContactFields fields;
  for (const scene::OwnedSubdomain& subdomain : owned) {
    const auto nodes = static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes());
    std::vector<double> pressure(nodes, 0.0), gap(nodes, 0.0);
    std::vector<unsigned char> active(nodes, 0);
    for (std::size_t place = 0; place < subdomain.mesh.boundaryNumbers.size(); ++place) {
      const auto k = static_cast<std::size_t>(subdomain.mesh.mesh->boundary[place]);
      const auto found = atNode.find(subdomain.mesh.boundaryNumbers[place]);
      if (found == atNode.end())
        continue;
      pressure[k] = found->second->pressure;
      gap[k] = found->second->gap;
      active[k] = found->second->closed ? 2 : 1;
    }
    fields.pressure.push_back(std::move(pressure));
    fields.gap.push_back(std::move(gap));
    fields.activeSet.push_back(std::move(active));
  }
  return fields;
}

} // namespace Harmos::run
