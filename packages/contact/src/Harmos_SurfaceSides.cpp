// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SurfaceSides.hpp"

#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos::contact {
namespace {

using fem::Point;

// A facet at one of its nodes.
struct Corner {
  int facet;
  std::size_t place; // of the node among those of the facet
  Point normal;      // of the facet there, of length one
  double area;       // of the facet
};

fem::Quadrature ruleOn(const Surface& surface) {
  return fem::quadratureOn(surface.facetType, 2 * fem::shapeOf(surface.facetType).order + 4);
}

// Nodes with a facet that turns away from the averaged normal by more than half of the angle: between any two
// others there is no sharp edge.
std::vector<char> maySplit(const Surface& surface, const std::vector<char>& inside) {
  const std::vector<Point>& reference = fem::shapeOf(surface.facetType).nodeCoordinates;
  const double least = std::cos(0.5 * sharpestAngle);
  std::vector<char> result(surface.numbers.size(), 0);
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    for (std::size_t k = 0; k < facet.size(); ++k) {
      const Point normal = facet.at({reference[k][0], reference[k][1]}).areaNormal;
      const std::size_t i = facet.node(k);
      if (inside[i] != 0 && dot(normal, surface.normals[i]) < least * norm(normal))
        result[i] = 1;
    }
  }
  return result;
}

std::vector<std::vector<Corner>> cornersAt(const Surface& surface, const std::vector<char>& nodes) {
  const std::vector<Point>& reference = fem::shapeOf(surface.facetType).nodeCoordinates;
  const fem::Quadrature rule = ruleOn(surface);
  std::vector<std::vector<Corner>> result(surface.numbers.size());
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    double area = 0.0;
    for (std::size_t k = 0; k < facet.size(); ++k) {
      if (nodes[facet.node(k)] == 0)
        continue;
      const Point normal = facet.at({reference[k][0], reference[k][1]}).areaNormal;
      const double length = norm(normal);
      area = area > 0.0 ? area : integralsOn(facet, rule).area;
      if (length > 0.0)
        result[facet.node(k)].push_back({f, k, scaled(1.0 / length, normal), area});
    }
  }
  return result;
}

// Whether two facets at a node have a joint there: in the plane the node, in space an edge.
bool haveJoint(const Surface& surface, const Corner& a, const Corner& b) {
  if (surface.dimension == 2)
    return true;
  const Facet one(surface, a.facet), other(surface, b.facet);
  int common = 0;
  for (std::size_t j = 0; j < one.size(); ++j)
    for (std::size_t k = 0; k < other.size(); ++k)
      common += one.node(j) == other.node(k) ? 1 : 0;
  return common > 1;
}

// The side of each corner: the least place of those that hang together.
std::vector<std::size_t> sidesOf(const Surface& surface, const std::vector<Corner>& corners) {
  const double least = std::cos(sharpestAngle);
  std::vector<std::size_t> side(corners.size());
  std::iota(side.begin(), side.end(), std::size_t{0});
  for (std::size_t a = 0; a < corners.size(); ++a)
    for (std::size_t b = a + 1; b < corners.size(); ++b)
      if (side[a] != side[b] && dot(corners[a].normal, corners[b].normal) > least &&
          haveJoint(surface, corners[a], corners[b])) {
        const auto [to, from] = std::minmax(side[a], side[b]);
        std::replace(side.begin(), side.end(), std::size_t{from}, std::size_t{to});
      }
  return side;
}

} // namespace

std::vector<Point> Details::sideNormalsOf(const Surface& surface, const std::vector<char>& inside) {
  const std::vector<char> candidates = maySplit(surface, inside);
  if (std::none_of(candidates.begin(), candidates.end(), [](char c) { return c != 0; }))
    return {};
  const auto size = static_cast<std::size_t>(surface.nodesPerFacet());
  std::vector<Point> result;
  for (int node : surface.facets)
    result.push_back(surface.normals[static_cast<std::size_t>(node)]);
  bool isAnySharp = false;
  for (const std::vector<Corner>& corners : cornersAt(surface, candidates)) {
    const std::vector<std::size_t> side = sidesOf(surface, corners);
    if (std::all_of(side.begin(), side.end(), [](std::size_t s) { return s == 0; }))
      continue;
    isAnySharp = true;
    std::vector<Point> sums(corners.size());
    for (std::size_t c = 0; c < corners.size(); ++c)
      sums[side[c]] = sum(sums[side[c]], scaled(corners[c].area, corners[c].normal));
    for (std::size_t c = 0; c < corners.size(); ++c)
      result[static_cast<std::size_t>(corners[c].facet) * size + corners[c].place] =
          scaled(1.0 / norm(sums[side[c]]), sums[side[c]]);
  }
  return isAnySharp ? result : std::vector<Point>();
}

Surface splitAtEdges(const Surface& surface) {
  if (surface.sideNormals.empty())
    return surface;
  std::vector<std::vector<Point>> sides(surface.numbers.size()); // of each node, in the order of facets
  std::vector<std::size_t> sideOf;                               // of each node of each facet
  for (std::size_t k = 0; k < surface.facets.size(); ++k) {
    std::vector<Point>& known = sides[static_cast<std::size_t>(surface.facets[k])];
    const auto found = std::find(known.begin(), known.end(), surface.sideNormals[k]);
    sideOf.push_back(static_cast<std::size_t>(found - known.begin()));
    if (found == known.end())
      known.push_back(surface.sideNormals[k]);
  }
  Surface result = surface;
  for (auto* list : {&result.positions, &result.normals, &result.sideNormals})
    list->clear();
  result.numbers.clear();
  result.areas.clear();
  result.isOwnNode.clear();
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    first.push_back(result.numbers.size());
    for (const Point& normal : sides[i]) {
      result.numbers.push_back(surface.numbers[i]);
      result.positions.push_back(surface.positions[i]);
      result.normals.push_back(normal);
      result.areas.push_back(sides[i].size() == 1 ? surface.areas[i] : 0.0);
      result.isOwnNode.push_back(surface.isOwnNode[i]);
    }
  }
  for (std::size_t k = 0; k < surface.facets.size(); ++k)
    result.facets[k] = static_cast<int>(first[static_cast<std::size_t>(surface.facets[k])] + sideOf[k]);
  const fem::Quadrature rule = ruleOn(surface);
  for (int f = 0; f < result.numberOfFacets(); ++f) {
    const Facet facet(result, f);
    const auto isSplit = [&](std::size_t k) {
      const auto place =
          static_cast<std::size_t>(surface.facets[static_cast<std::size_t>(f) * facet.size() + k]);
      return sides[place].size() > 1;
    };
    FacetIntegrals integrals; // made if needed
    for (std::size_t k = 0; k < facet.size(); ++k)
      if (isSplit(k)) {
        integrals = integrals.area > 0.0 ? integrals : integralsOn(facet, rule);
        result.areas[facet.node(k)] += integrals.ofNodes[k];
      }
  }
  return result;
}

} // namespace Harmos::contact
