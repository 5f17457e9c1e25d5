// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FacetMultipliers.hpp"

namespace Harmos::contact {
namespace {

// Nodes of a facet next to one of them: corners next to corners on facets of first order, else corners and
// the middles of their edges; beside the node in the middle of a quadrilateral those of the edges.
std::vector<std::size_t> neighboursOf(std::size_t node, std::size_t corners, std::size_t size) {
  if (corners == 2) // a line
    return size == 2 ? std::vector<std::size_t>{1 - node}
                     : (node == 2 ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{2});
  if (size == corners)
    return {(node + 1) % corners, (node + corners - 1) % corners};
  if (node < corners)
    return {corners + node, corners + (node + corners - 1) % corners};
  if (node < 2 * corners)
    return {node - corners, (node - corners + 1) % corners};
  return {4, 5, 6, 7};
}

} // namespace

FacetMultipliers::FacetMultipliers(const Facet& facet, const std::vector<char>& without) {
  std::array<std::size_t, maxFacetNodes> place{};
  std::array<char, maxFacetNodes> bears{};
  for (std::size_t k = 0; k < facet.size(); ++k)
    if (without[facet.node(k)] == 0) {
      bears[k] = 1;
      place[k] = bearing_.size();
      bearing_.push_back(k);
    } else {
      lacking_.push_back(k);
    }
  if (bearing_.empty())
    return;
  for (const std::size_t x : lacking_) {
    std::vector<std::size_t> heirs;
    for (const std::size_t k : neighboursOf(x, facet.corners(), facet.size()))
      if (bears[k] != 0)
        heirs.push_back(k);
    if (heirs.empty())
      heirs = bearing_;
    for (const std::size_t k : heirs)
      shares_[x][place[k]] += 1.0 / static_cast<double>(heirs.size());
  }
}

FacetMultipliers::Values FacetMultipliers::values(const Values& carriers) const {
  if (isWhole())
    return carriers;
  Values result{};
  for (std::size_t j = 0; j < bearing_.size(); ++j) {
    result[j] = carriers[bearing_[j]];
    for (const std::size_t x : lacking_)
      result[j] += shares_[x][j] * carriers[x];
  }
  return result;
}

} // namespace Harmos::contact
