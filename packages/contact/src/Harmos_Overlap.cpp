// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Overlap.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_PointLocator.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::contact {
namespace {

using fem::Box;
using fem::Point;

// Of the depth: surfaces that touch overlap by rounding errors, and what lies in a slot has the body on both
// sides.
constexpr std::array<double, 5> wayShares = {0.001, 0.05, 0.25, 0.5, 1.0};
using Way = std::array<Point, wayShares.size()>;

bool holds(const Box& box, const Way& way) {
  return std::all_of(way.begin(), way.end(), [&](const Point& x) { return box.touches({x, x}); });
}

// Around the whole body. @note Collective.
Box boxOfBody(const Teuchos::Comm<int>& comm, const std::vector<const fem::PlacedMesh*>& body) {
  std::vector<double> sides(6, -std::numeric_limits<double>::max()); // -low, high
  for (const fem::PlacedMesh* part : body)
    for (int node = 0; node < part->mesh->numberOfNodes(); ++node) {
      const Point x = part->position(node);
      for (std::size_t d = 0; d < 3; ++d) {
        sides[d] = std::max(sides[d], -x[d]);
        sides[3 + d] = std::max(sides[3 + d], x[d]);
      }
    }
  globalMax(comm, sides);
  return {{-sides[0], -sides[1], -sides[2]}, {sides[3], sides[4], sides[5]}};
}

// From places of this rank's facets into the body that they bound, where the other one may be.
std::vector<Way> waysInto(const Surface& surface, const Box& box, double depth) {
  std::vector<Way> ways;
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    if (surface.isOwnFacet[static_cast<std::size_t>(f)] == 0)
      continue;
    const Facet facet(surface, f);
    const FacetPlace centre = facetCentre(facet.type());
    std::vector<FacetPlace> places = {centre};
    for (std::size_t c = 0; c < facet.corners(); ++c) {
      const Point& corner = facet.shape().nodeCoordinates[c];
      places.push_back({0.5 * (centre[0] + corner[0]), 0.5 * (centre[1] + corner[1])});
    }
    for (const FacetPlace& place : places) {
      const Facet::State at = facet.at(place);
      const double length = norm(at.areaNormal);
      Way way{};
      for (std::size_t k = 0; k < way.size() && length > 0.0; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          way[k][d] = at.position[d] - wayShares[k] * depth / length * at.areaNormal[d];
      if (length > 0.0 && holds(box, way))
        ways.push_back(way);
    }
  }
  return ways;
}

// The cells of a subdomain that may hold points; nothing without any.
std::optional<fem::PointLocator> cellsAt(const fem::PlacedMesh& part, const fem::BoxTree& points) {
  const fem::Mesh& mesh = *part.mesh;
  std::vector<Point> nodes;
  for (int node = 0; node < mesh.numberOfNodes(); ++node)
    nodes.push_back(part.position(node));
  std::vector<int> cells;
  constexpr double bulge = 0.25; // of cells of second order, see boxOfFacet()
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    std::vector<Point> corners;
    for (int k = 0; k < mesh.nodesPerCell(); ++k)
      corners.push_back(nodes[static_cast<std::size_t>(mesh.cell(c)[k])]);
    const Box box = fem::boxAround(corners);
    if (!points.touching(fem::widened(box, bulge * norm(difference(box.high, box.low)))).empty())
      cells.insert(cells.end(), mesh.cell(c), mesh.cell(c) + mesh.nodesPerCell());
  }
  if (cells.empty())
    return std::nullopt;
  return fem::PointLocator(mesh.cellType, nodes, cells);
}

} // namespace

std::optional<Point> deepOverlap(const Surface& surface, const std::vector<const fem::PlacedMesh*>& body,
                                 double depth) {
  const Teuchos::Comm<int>& comm = *surface.comm;
  const Box box = boxOfBody(comm, body);
  std::vector<Way> ways;
  agree(comm, [&] { ways = waysInto(surface, box, depth); });
  ways = gatherAll(comm, ways);
  if (ways.empty())
    return std::nullopt;
  std::vector<double> isFilled(ways.size() * wayShares.size(), 0.0);
  agree(comm, [&] {
    std::vector<Box> boxes;
    for (const Way& way : ways)
      for (const Point& x : way)
        boxes.push_back({x, x});
    const fem::BoxTree points(boxes);
    const double tolerance = 1e-9 * depth; // between two subdomains
    for (const fem::PlacedMesh* part : body)
      if (const std::optional<fem::PointLocator> cells = cellsAt(*part, points))
        for (std::size_t k = 0; k < boxes.size(); ++k)
          if (isFilled[k] == 0.0 && cells->nearest(boxes[k].low).distance <= tolerance)
            isFilled[k] = 1.0;
  });
  globalMax(comm, isFilled);
  for (std::size_t w = 0; w < ways.size(); ++w) {
    const auto first = isFilled.begin() + static_cast<std::ptrdiff_t>(w * wayShares.size());
    if (std::all_of(first, first + wayShares.size(), [](double filled) { return filled > 0.0; }))
      return ways[w].front();
  }
  return std::nullopt;
}

} // namespace Harmos::contact
