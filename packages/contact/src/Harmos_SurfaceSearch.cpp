// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_Surface.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace Harmos::contact {
namespace {

using fem::Box;
using fem::Point;

constexpr double infinity = std::numeric_limits<double>::infinity();
// Touches nothing.
const Box noBox = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};

Box around(const std::vector<Box>& boxes) {
  Box all = noBox;
  for (const Box& box : boxes)
    for (std::size_t d = 0; d < 3; ++d) {
      all.low[d] = std::min(all.low[d], box.low[d]);
      all.high[d] = std::max(all.high[d], box.high[d]);
    }
  return all;
}

// A facet with all that is known of its nodes.
struct WholeFacet {
  std::array<long long, maxFacetNodes> numbers;
  std::array<Point, maxFacetNodes> positions, normals, sideNormals;
  std::array<double, maxFacetNodes> areas;
};

WholeFacet wholeFacet(const Surface& surface, int f) {
  const Facet facet(surface, f);
  WholeFacet item{};
  for (std::size_t k = 0; k < facet.size(); ++k) {
    const std::size_t i = facet.node(k);
    item.numbers[k] = surface.numbers[i];
    item.positions[k] = surface.positions[i];
    item.normals[k] = surface.normals[i];
    item.areas[k] = surface.areas[i];
    if (!surface.sideNormals.empty())
      item.sideNormals[k] = surface.sideNormals[static_cast<std::size_t>(f) * facet.size() + k];
  }
  return item;
}

// A surface of these facets, none of them this rank's own.
void setFacets(Surface& surface, const std::vector<WholeFacet>& items, bool isSharp) {
  struct Node {
    Point position, normal;
    double area;
  };
  const auto count = static_cast<std::size_t>(surface.nodesPerFacet());
  std::map<long long, Node> nodes;
  for (const WholeFacet& item : items)
    for (std::size_t k = 0; k < count; ++k)
      nodes.emplace(item.numbers[k], Node{item.positions[k], item.normals[k], item.areas[k]});
  for (const auto& [number, node] : nodes) {
    surface.numbers.push_back(number);
    surface.positions.push_back(node.position);
    surface.normals.push_back(node.normal);
    surface.areas.push_back(node.area);
  }
  std::vector<std::pair<std::vector<int>, const WholeFacet*>> facets;
  for (const WholeFacet& item : items) {
    std::vector<int>& places = facets.emplace_back(std::vector<int>(), &item).first;
    for (std::size_t k = 0; k < count; ++k)
      places.push_back(
          static_cast<int>(std::lower_bound(surface.numbers.begin(), surface.numbers.end(), item.numbers[k]) -
                           surface.numbers.begin()));
  }
  std::sort(facets.begin(), facets.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [places, item] : facets) {
    surface.facets.insert(surface.facets.end(), places.begin(), places.end());
    if (isSharp)
      surface.sideNormals.insert(surface.sideNormals.end(), item->sideNormals.begin(),
                                 item->sideNormals.begin() + surface.nodesPerFacet());
  }
  surface.isOwnFacet.assign(facets.size(), 0);
  surface.isOwnNode.assign(surface.numbers.size(), 0);
}

} // namespace

Box boxOfFacet(const Surface& surface, int f, std::vector<Point> points) {
  const Facet facet(surface, f);
  std::vector<Point> nodes;
  for (std::size_t k = 0; k < facet.size(); ++k)
    nodes.push_back(facet.position(k));
  const Box own = fem::boxAround(nodes);
  const double bulge = fem::shapeOf(surface.facetType).order == 2 ? 0.25 : 1e-9;
  points.insert(points.end(), nodes.begin(), nodes.end());
  return fem::widened(fem::boxAround(points), bulge * norm(difference(own.high, own.low)));
}

Surface facetsTouching(const Surface& surface, const std::vector<Box>& boxes) {
  const Teuchos::Comm<int>& comm = *surface.comm;
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  struct Extent {
    Box asked, held;
  };
  std::vector<int> own;
  std::vector<Box> ownBoxes;
  agree(comm, [&] {
    for (int f = 0; f < surface.numberOfFacets(); ++f)
      if (surface.isOwnFacet[static_cast<std::size_t>(f)] != 0) {
        own.push_back(f);
        ownBoxes.push_back(boxOfFacet(surface, f));
      }
  });
  const std::vector<Extent> extents = gatherAll(comm, std::vector<Extent>{{around(boxes), around(ownBoxes)}});
  std::vector<std::vector<Box>> questions(ranks);
  agree(comm, [&] {
    const Box asked = around(boxes);
    for (std::size_t r = 0; r < ranks; ++r)
      if (asked.touches(extents[r].held))
        std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(questions[r]),
                     [&](const Box& box) { return box.touches(extents[r].held); });
  });
  questions = exchangeItems(comm, questions);
  std::vector<std::vector<WholeFacet>> answers(ranks);
  agree(comm, [&] {
    const fem::BoxTree tree(ownBoxes);
    for (std::size_t r = 0; r < ranks; ++r) {
      std::vector<int> places;
      for (const Box& box : questions[r])
        for (int place : tree.touching(box))
          places.push_back(place);
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      for (int place : places)
        answers[r].push_back(wholeFacet(surface, own[static_cast<std::size_t>(place)]));
    }
  });
  answers = exchangeItems(comm, answers);
  Surface found;
  found.name = surface.name;
  found.dimension = surface.dimension;
  found.facetType = surface.facetType;
  found.isAxisymmetric = surface.isAxisymmetric;
  found.comm = surface.comm;
  found.wholeNodes = surface.wholeNodes;
  found.wholeBox = surface.wholeBox;
  agree(comm, [&] {
    std::vector<WholeFacet> items;
    for (const std::vector<WholeFacet>& part : answers)
      items.insert(items.end(), part.begin(), part.end());
    setFacets(found, items, !surface.sideNormals.empty());
  });
  return found;
}

} // namespace Harmos::contact
