// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactFields.hpp"

#include "Harmos_Exchange.hpp"

#include <unordered_map>

namespace Harmos::scene {

ContactFields contactFields(const Teuchos::Comm<int>& comm, const std::vector<OwnedSubdomain>& owned,
                            const std::vector<contact::NodePair>& pairs, const feti::ContactState& state) {
  struct Item {
    long long row;
    double gap;
    double force;
  };
  std::vector<Item> mine;
  for (std::size_t k = 0; k < state.row.size(); ++k)
    mine.push_back({state.row[k], state.gap[k], state.force[k]});
  struct Value {
    double pressure, gap;
    bool closed;
  };
  std::unordered_map<long long, Value> atNode;
  for (const Item& item : gatherAll(comm, mine)) {
    const contact::NodePair& pair = pairs[static_cast<std::size_t>(item.row)];
    const Value value = {item.force / pair.length, item.gap, item.force > 0.0};
    atNode[pair.first] = value;
    atNode[pair.second] = value;
  }

  ContactFields fields;
  for (const OwnedSubdomain& subdomain : owned) {
    const auto nodes = static_cast<std::size_t>(subdomain.mesh.mesh->numberOfNodes());
    std::vector<double> pressure(nodes, 0.0), gap(nodes, 0.0);
    std::vector<unsigned char> active(nodes, 0);
    for (std::size_t place = 0; place < subdomain.mesh.boundaryNumbers.size(); ++place) {
      const auto k = static_cast<std::size_t>(subdomain.mesh.mesh->boundary[place]);
      const auto found = atNode.find(subdomain.mesh.boundaryNumbers[place]);
      if (found == atNode.end())
        continue;
      pressure[k] = found->second.pressure;
      gap[k] = found->second.gap;
      active[k] = found->second.closed ? 2 : 1;
    }
    fields.pressure.push_back(std::move(pressure));
    fields.gap.push_back(std::move(gap));
    fields.activeSet.push_back(std::move(active));
  }
  return fields;
}

} // namespace Harmos::scene
