// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <set>

namespace Harmos::contact {
namespace {

// Of each node of the surface: ∫φ_k over the facets that face what it may touch, and of corners their edges.
struct NodeShares {
  double integral = 0.0;
  bool isCorner = false;
  std::set<std::size_t> edges; // places of their middle nodes
};

std::vector<NodeShares> sharesOf(const Surface& surface, const std::vector<fem::Point>& towards) {
  const fem::Quadrature rule =
      fem::quadratureOn(surface.facetType, 2 * fem::shapeOf(surface.facetType).order + 4);
  std::vector<NodeShares> shares(surface.numbers.size());
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    const FacetIntegrals integrals = integralsOn(facet, rule);
    for (std::size_t k = 0; k < facet.size(); ++k) {
      NodeShares& node = shares[facet.node(k)];
      if (!towards.empty() && !facesAt(facet, k, towards[facet.node(k)]))
        continue;
      node.integral += integrals.ofNodes[k];
      node.isCorner = k < facet.corners();
      if (node.isCorner)
        node.edges.insert({facet.node(facet.corners() + k),
                           facet.node(facet.corners() + (k + facet.corners() - 1) % facet.corners())});
    }
  }
  return shares;
}

} // namespace

void setPressures(const Surface& surface, const std::vector<fem::Point>& towards,
                  std::vector<ContactPoint>& points) {
  if (surface.facetType != fem::CellType::Triangle6)
    return;
  const double share = Carriers::usualShare(surface.facetType);
  const std::vector<NodeShares> shares = sharesOf(surface, towards);
  const auto firstOf = [&](long long number) {
    return static_cast<std::size_t>(std::lower_bound(surface.numbers.begin(), surface.numbers.end(), number) -
                                    surface.numbers.begin());
  };
  for (ContactPoint& point : points) {
    const std::size_t place = firstOf(point.node) + static_cast<std::size_t>(point.side);
    const NodeShares& node = shares[place];
    double whole = node.integral;
    for (const std::size_t e : node.edges)
      whole += share * shares[e].integral;
    if (!(whole > 0.0)) // nothing faces it: there is no pressure
      continue;
    point.pressure = {{point.node, point.side, -1, 1.0 / whole}};
    for (const std::size_t e : node.edges)
      point.pressure.push_back(
          {surface.numbers[e], static_cast<int>(e - firstOf(surface.numbers[e])), -1, share / whole});
  }
}

} // namespace Harmos::contact
