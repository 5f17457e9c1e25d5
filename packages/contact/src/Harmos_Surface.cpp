// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Surface.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <numeric>

namespace Harmos::contact {
namespace {

using fem::CellType;
using fem::Point;

struct NumberedNode {
  long long number;
  Point position;
  bool operator<(const NumberedNode& other) const {
    return std::tie(number, position) < std::tie(other.number, other.position);
  }
};

// What the subdomains of this rank see of the surface.
struct Part {
  std::vector<int> types; // of facets, where there are any
  std::vector<long long> facets;
  std::vector<NumberedNode> nodes;
};

Part partOf(const std::vector<const fem::PlacedMesh*>& meshes, const std::string& set,
            const std::string& name) {
  Part part;
  for (const fem::PlacedMesh* placed : meshes) {
    const auto found = placed->sides.find(set);
    if (found == placed->sides.end() || found->second.empty())
      continue;
    const fem::Mesh& mesh = *placed->mesh;
    part.types.push_back(static_cast<int>(fem::shapeOf(mesh.cellType).side));
    for (const fem::Side& side : found->second)
      for (int node : mesh.nodesOf(side)) {
        HARMOS_REQUIRE(std::binary_search(mesh.boundary.begin(), mesh.boundary.end(), node),
                       "surface " + name + ": a node of a side is not on the boundary of its subdomain");
        part.facets.push_back(placed->number(node));
        part.nodes.push_back({placed->number(node), placed->position(node)});
      }
  }
  std::sort(part.types.begin(), part.types.end());
  part.types.erase(std::unique(part.types.begin(), part.types.end()), part.types.end());
  // Copies of other subdomains stay: which of them is taken must not depend on the rank they are on.
  std::sort(part.nodes.begin(), part.nodes.end());
  part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end(),
                               [](const NumberedNode& a, const NumberedNode& b) {
                                 return a.number == b.number && a.position == b.position;
                               }),
                   part.nodes.end());
  return part;
}

void setNodes(Surface& surface, std::vector<NumberedNode> nodes) {
  std::sort(nodes.begin(), nodes.end());
  for (const NumberedNode& node : nodes)
    if (surface.numbers.empty() || surface.numbers.back() != node.number) {
      surface.numbers.push_back(node.number);
      surface.positions.push_back(node.position);
    }
}

void setFacets(Surface& surface, const std::vector<long long>& numbers) {
  const auto width = static_cast<std::size_t>(surface.nodesPerFacet());
  std::vector<std::vector<int>> facets(numbers.size() / width);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto place = std::lower_bound(surface.numbers.begin(), surface.numbers.end(), numbers[k]);
    facets[k / width].push_back(static_cast<int>(place - surface.numbers.begin()));
  }
  std::sort(facets.begin(), facets.end());
  for (const std::vector<int>& facet : facets)
    surface.facets.insert(surface.facets.end(), facet.begin(), facet.end());
}

// Where facets join: edges in space, nodes in the plane (first = second).
struct Joint {
  int low, high;
  bool rises; // the facet runs from low to high; in the plane: begins there
  bool operator<(const Joint& other) const {
    return std::tie(low, high, rises) < std::tie(other.low, other.high, other.rises);
  }
};

std::vector<Joint> jointsOf(const Surface& surface) {
  std::vector<Joint> joints;
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    for (std::size_t k = 0; k < facet.corners(); ++k) {
      const auto from = static_cast<int>(facet.node(k));
      const auto to = static_cast<int>(facet.node((k + 1) % facet.corners()));
      if (surface.dimension == 2)
        joints.push_back({from, from, k == 0});
      else
        joints.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(joints.begin(), joints.end());
  return joints;
}

void requireManifold(const Surface& surface) {
  const std::vector<Joint> joints = jointsOf(surface);
  for (std::size_t k = 0; k < joints.size();) {
    std::size_t end = k, rising = 0;
    for (; end < joints.size() && joints[end].low == joints[k].low && joints[end].high == joints[k].high;
         ++end)
      rising += joints[end].rises ? 1 : 0;
    const std::size_t count = end - k;
    if (count > 2 || rising > 1 || count - rising > 1) {
      const Point middle = scaled(0.5, sum(surface.positions[static_cast<std::size_t>(joints[k].low)],
                                           surface.positions[static_cast<std::size_t>(joints[k].high)]));
      const std::string joint = surface.dimension == 2 ? "node" : "edge";
      throw InputError(
          "surface " + surface.name + ": it is not a manifold: " + std::to_string(count) +
              " facets meet at the " + joint + " at " + placeText(middle) +
              (count > 2 ? ", more than two" : " and look to opposite sides, or are the same facet twice") +
              "; make it of outer sides of one body, each given once, and give parts that "
              "touch each other names of their own",
          {{"surface", surface.name}});
    }
    k = end;
  }
}

void setAreasAndNormals(Surface& surface) {
  const fem::Quadrature rule =
      fem::quadratureOn(surface.facetType, 2 * fem::shapeOf(surface.facetType).order + 4);
  const std::vector<Point>& reference = fem::shapeOf(surface.facetType).nodeCoordinates;
  surface.areas.assign(surface.numbers.size(), 0.0);
  surface.normals.assign(surface.numbers.size(), Point{});
  std::vector<double> around(surface.numbers.size(), 0.0); // areas of all facets of a node
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    double area = 0.0, size = 0.0;
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      const Facet::State state = facet.at({rule.points[q][0], rule.points[q][1]});
      const double weight = rule.weights[q] * norm(state.areaNormal);
      area += weight;
      for (std::size_t k = 0; k < facet.size(); ++k)
        surface.areas[facet.node(k)] += weight * state.basis.values[k];
    }
    for (std::size_t k = 1; k < facet.size(); ++k)
      size = std::max(size, norm(difference(facet.position(k), facet.position(0))));
    if (!(area > 1e-12 * std::pow(size, surface.dimension - 1)))
      throw InputError("surface " + surface.name + ": the facet at " + placeText(facet.position(0)) +
                           " has no area: nodes coincide or lie on a line; mend the mesh there",
                       {{"surface", surface.name}});
    for (std::size_t k = 0; k < facet.size(); ++k) {
      const Facet::State state = facet.at({reference[k][0], reference[k][1]});
      const double length = norm(state.areaNormal);
      around[facet.node(k)] += area;
      if (length > 0.0)
        surface.normals[facet.node(k)] =
            sum(surface.normals[facet.node(k)], scaled(area / length, state.areaNormal));
    }
  }
  for (std::size_t i = 0; i < surface.numbers.size(); ++i) {
    const double length = norm(surface.normals[i]);
    // The cancellation of a fold, against the rounding of a sum of unit vectors.
    if (!(length > 1e-8 * around[i]))
      throw InputError("surface " + surface.name + ": it is folded at node " +
                           std::to_string(surface.numbers[i]) + " at " + placeText(surface.positions[i]) +
                           ", where the normals of its facets cancel each other; name the two sides "
                           "separately",
                       {{"surface", surface.name}, {"node", std::to_string(surface.numbers[i])}});
    surface.normals[i] = scaled(1.0 / length, surface.normals[i]);
  }
}

void takeNormalsFrom(const NormalField& field, Surface& surface) {
  for (std::size_t i = 0; i < surface.numbers.size(); ++i) {
    const Point given = field(surface.positions[i]);
    const double length = norm(given);
    const Point normal = scaled(1.0 / length, given);
    if (!(dot(normal, surface.normals[i]) > 0.0) || !(length > 0.0))
      throw InputError("surface " + surface.name + ": the given normal " + placeText(given) + " at node " +
                           std::to_string(surface.numbers[i]) + " at " + placeText(surface.positions[i]) +
                           " does not look outward; turn it round, or leave it away for averaged normals",
                       {{"surface", surface.name}, {"node", std::to_string(surface.numbers[i])}});
    surface.normals[i] = normal;
  }
}

} // namespace

Surface gatherSurface(const Teuchos::Comm<int>& comm, const std::vector<const fem::PlacedMesh*>& parts,
                      const std::string& set, const std::string& name, const NormalField& field) {
  Part mine;
  agree(comm, [&] { mine = partOf(parts, set, name); });
  std::vector<int> types = gatherAll(comm, mine.types);
  const std::vector<long long> facets = gatherAll(comm, mine.facets);
  std::vector<NumberedNode> nodes = gatherAll(comm, mine.nodes);
  Surface surface;
  // Every rank has the same data from here on; a user's field may still fail on one of them alone.
  agree(comm, [&] {
    if (types.empty())
      throw InputError("surface " + name + ": the part \"" + set +
                           "\" has no sides of cells; name a boundary part of the body",
                       {{"surface", name}, {"part", set}});
    std::sort(types.begin(), types.end());
    if (types.front() != types.back())
      throw InputError("surface " + name + ": it has facets of different types, " +
                           fem::shapeOf(static_cast<CellType>(types.front())).name + " and " +
                           fem::shapeOf(static_cast<CellType>(types.back())).name +
                           "; give the parts of each type a name of their own",
                       {{"surface", name}});
    surface.name = name;
    surface.facetType = static_cast<CellType>(types.front());
    surface.dimension = fem::shapeOf(surface.facetType).dimension + 1;
    setNodes(surface, std::move(nodes));
    setFacets(surface, facets);
    requireManifold(surface);
    setAreasAndNormals(surface);
    if (field)
      takeNormalsFrom(field, surface);
  });
  return surface;
}

std::vector<double> tributaryAreas(const Surface& surface) {
  if (surface.facetType != CellType::Triangle6)
    return surface.areas;
  constexpr std::array<std::array<std::size_t, 3>, 4> pieces = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  std::vector<double> areas(surface.numbers.size(), 0.0);
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    for (const auto& [a, b, c] : pieces) {
      const double area = 0.5 * norm(cross(difference(facet.position(b), facet.position(a)),
                                           difference(facet.position(c), facet.position(a))));
      for (std::size_t k : {a, b, c})
        areas[facet.node(k)] += area / 3.0;
    }
  }
  return areas;
}

} // namespace Harmos::contact
