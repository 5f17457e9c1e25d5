// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Surface.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_SurfaceSides.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <unordered_map>

namespace Harmos::contact {
namespace {

using fem::CellType;
using fem::Point;

constexpr long long noNode = -1;

struct FacetItem {
  std::array<long long, maxFacetNodes> nodes; // those it lacks are noNode
};

struct NodeCopy {
  long long number;
  Point position;
  bool operator<(const NodeCopy& other) const {
    return std::tie(number, position) < std::tie(other.number, other.position);
  }
};

// What the subdomains of this rank see of the surface.
struct Part {
  long long leastType = std::numeric_limits<long long>::max(), largestType = -1; // of facets
  bool isAxisymmetric = false;
  std::vector<FacetItem> facets;
  std::vector<NodeCopy> nodes; // once each
};

Part partOf(const std::vector<const fem::PlacedMesh*>& meshes, const std::string& set,
            const std::string& name) {
  Part part;
  for (const fem::PlacedMesh* placed : meshes) {
    const auto found = placed->sides.find(set);
    if (found == placed->sides.end() || found->second.empty())
      continue;
    const fem::Mesh& mesh = *placed->mesh;
    part.isAxisymmetric = part.isAxisymmetric || mesh.isAxisymmetric;
    for (const fem::Side& side : found->second) {
      const auto type = static_cast<long long>(mesh.typeOf(side));
      part.leastType = std::min(part.leastType, type);
      part.largestType = std::max(part.largestType, type);
      FacetItem& facet = part.facets.emplace_back();
      facet.nodes.fill(noNode);
      std::size_t k = 0;
      for (int node : mesh.nodesOf(side)) {
        HARMOS_REQUIRE(std::binary_search(mesh.boundary.begin(), mesh.boundary.end(), node),
                       "surface " + name + ": a node of a side is not on the boundary of its subdomain");
        facet.nodes[k++] = placed->number(node);
        part.nodes.push_back({placed->number(node), placed->position(node)});
      }
    }
  }
  // Of the copies of a node, which differ by rounding, the one that does not depend on the ranks they are on.
  std::sort(part.nodes.begin(), part.nodes.end());
  part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end(),
                               [](const NodeCopy& a, const NodeCopy& b) { return a.number == b.number; }),
                   part.nodes.end());
  return part;
}

// What a rank learns of one of its nodes.
struct Meeting {
  Point position;
  int owner;  // the lowest rank that has it
  int others; // how many ranks have it beside this one
};

// All nodes of the surface, each at the rank of its number.
struct Meetings {
  std::vector<Meeting> of;               // of this rank's nodes, in their order
  std::vector<std::vector<int>> sharers; // of these
  long long wholeNodes = 0;
};

Meetings meet(const Teuchos::Comm<int>& comm, const std::vector<NodeCopy>& nodes) {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<NodeCopy>> sends(ranks);
  agree(comm, [&] {
    for (const NodeCopy& node : nodes)
      sends[homeOf(node.number, comm)].push_back(node);
  });
  const std::vector<std::vector<NodeCopy>> arrived = exchangeItems(comm, sends);
  std::vector<std::vector<Meeting>> answers(ranks);
  std::vector<std::vector<int>> lists(ranks);
  long long here = 0;
  agree(comm, [&] {
    struct All {
      Point position;
      std::vector<int> ranks;
    };
    std::unordered_map<long long, All> known;
    for (std::size_t r = 0; r < ranks; ++r)
      for (const NodeCopy& node : arrived[r]) {
        const auto [place, isNew] = known.emplace(node.number, All{node.position, {}});
        if (!isNew)
          place->second.position = std::min(place->second.position, node.position);
        place->second.ranks.push_back(static_cast<int>(r));
      }
    here = static_cast<long long>(known.size());
    for (std::size_t r = 0; r < ranks; ++r)
      for (const NodeCopy& node : arrived[r]) {
        const All& all = known.at(node.number);
        answers[r].push_back({all.position, all.ranks.front(), static_cast<int>(all.ranks.size()) - 1});
        for (int other : all.ranks)
          if (other != static_cast<int>(r))
            lists[r].push_back(other);
      }
  });
  answers = exchangeItems(comm, answers);
  lists = exchangeItems(comm, lists);
  Meetings result;
  result.wholeNodes = globalSum(comm, here);
  std::vector<std::size_t> next(ranks, 0), nextOther(ranks, 0);
  for (const NodeCopy& node : nodes) {
    const std::size_t home = homeOf(node.number, comm);
    result.of.push_back(answers[home][next[home]++]);
    std::vector<int>& others = result.sharers.emplace_back();
    for (int k = 0; k < result.of.back().others; ++k)
      others.push_back(lists[home][nextOther[home]++]);
  }
  return result;
}

std::size_t placeIn(const std::vector<NodeCopy>& nodes, long long number) {
  const auto at = std::lower_bound(nodes.begin(), nodes.end(), number,
                                   [](const NodeCopy& node, long long n) { return node.number < n; });
  return static_cast<std::size_t>(at - nodes.begin());
}

// Places of this rank's facets that other ranks need beside theirs: those that have a node in common.
std::vector<std::vector<std::size_t>> facetsForOthers(const Part& part, const Meetings& meetings,
                                                      std::size_t ranks) {
  std::vector<std::vector<std::size_t>> result(ranks);
  for (std::size_t f = 0; f < part.facets.size(); ++f)
    for (const long long number : part.facets[f].nodes)
      if (number != noNode)
        for (int other : meetings.sharers[placeIn(part.nodes, number)])
          if (std::vector<std::size_t>& list = result[static_cast<std::size_t>(other)];
              list.empty() || list.back() != f)
            list.push_back(f);
  return result;
}

// A facet on its way to another rank: with the nodes' positions, or their normals.
struct PlacedFacet {
  FacetItem facet;
  std::array<Point, maxFacetNodes> positions;
};
struct NodeResult {
  long long number;
  Point normal;
  double area;
};
struct FacetSides {
  FacetItem facet;
  std::array<Point, maxFacetNodes> normals;
};

void setNodes(Surface& surface, std::vector<NodeCopy> nodes) {
  std::sort(nodes.begin(), nodes.end());
  for (const NodeCopy& node : nodes)
    if (surface.numbers.empty() || surface.numbers.back() != node.number) {
      surface.numbers.push_back(node.number);
      surface.positions.push_back(node.position);
    }
}

int placeOf(const Surface& surface, long long number) {
  return static_cast<int>(std::lower_bound(surface.numbers.begin(), surface.numbers.end(), number) -
                          surface.numbers.begin());
}

// By their node numbers.
void setFacets(Surface& surface, const std::vector<FacetItem>& items, std::size_t own) {
  std::vector<std::pair<std::vector<int>, char>> facets;
  for (std::size_t f = 0; f < items.size(); ++f) {
    auto& [nodes, isOwn] = facets.emplace_back(std::vector<int>(), f < own ? 1 : 0);
    for (int k = 0; k < surface.nodesPerFacet(); ++k)
      nodes.push_back(placeOf(surface, items[f].nodes[static_cast<std::size_t>(k)]));
  }
  std::sort(facets.begin(), facets.end());
  for (const auto& [nodes, isOwn] : facets) {
    surface.facets.insert(surface.facets.end(), nodes.begin(), nodes.end());
    surface.isOwnFacet.push_back(isOwn);
  }
}

// Nodes of this rank's own facets, around which all facets are here.
std::vector<char> isInside(const Surface& surface) {
  std::vector<char> result(surface.numbers.size(), 0);
  for (int f = 0; f < surface.numberOfFacets(); ++f)
    if (surface.isOwnFacet[static_cast<std::size_t>(f)] != 0)
      for (std::size_t k = 0; k < Facet(surface, f).size(); ++k)
        result[Facet(surface, f).node(k)] = 1;
  return result;
}

// Where facets join: edges in space, nodes in the plane (first = second).
struct Joint {
  int low, high;
  bool rises; // the facet runs from low to high; in the plane: begins there
  bool isOwn; // of this rank's facets: all facets that meet there are here
  bool operator<(const Joint& other) const {
    return std::tie(low, high, rises) < std::tie(other.low, other.high, other.rises);
  }
};

std::vector<Joint> jointsOf(const Surface& surface) {
  std::vector<Joint> joints;
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    const bool isOwn = surface.isOwnFacet[static_cast<std::size_t>(f)] != 0;
    for (std::size_t k = 0; k < facet.corners(); ++k) {
      const auto from = static_cast<int>(facet.node(k));
      const auto to = static_cast<int>(facet.node((k + 1) % facet.corners()));
      if (surface.dimension == 2)
        joints.push_back({from, from, k == 0, isOwn});
      else
        joints.push_back({std::min(from, to), std::max(from, to), from < to, isOwn});
    }
  }
  std::sort(joints.begin(), joints.end());
  return joints;
}

void requireManifold(const Surface& surface) {
  const std::vector<Joint> joints = jointsOf(surface);
  for (std::size_t k = 0; k < joints.size();) {
    std::size_t end = k, rising = 0;
    bool isOwn = false;
    for (; end < joints.size() && joints[end].low == joints[k].low && joints[end].high == joints[k].high;
         ++end) {
      rising += joints[end].rises ? 1 : 0;
      isOwn = isOwn || joints[end].isOwn;
    }
    const std::size_t count = end - k;
    if (isOwn && (count > 2 || rising > 1 || count - rising > 1)) {
      const Point middle = scaled(0.5, sum(surface.positions[static_cast<std::size_t>(joints[k].low)],
                                           surface.positions[static_cast<std::size_t>(joints[k].high)]));
      const std::string joint = surface.dimension == 2 ? "node" : "edge";
      throw InputError(
          "surface " + surface.name + ": not a manifold: " + std::to_string(count) + " facets meet at the " +
              joint + " at " + placeText(middle) +
              (count > 2 ? ", more than two" : " with opposite orientation or as duplicates") +
              "; use outer sides of one body, each once, and separate names for parts that touch each other",
          {{"surface", surface.name}});
    }
    k = end;
  }
}

// Right at nodes that are inside.
void setAreasAndNormals(Surface& surface, const std::vector<char>& inside) {
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
      const double weight = rule.weights[q] * state.measure;
      area += weight;
      for (std::size_t k = 0; k < facet.size(); ++k)
        surface.areas[facet.node(k)] += weight * state.basis.values[k];
    }
    for (std::size_t k = 1; k < facet.size(); ++k)
      size = std::max(size, norm(difference(facet.position(k), facet.position(0))));
    if (surface.isOwnFacet[static_cast<std::size_t>(f)] != 0 &&
        !(area > 1e-12 * std::pow(size, surface.dimension - 1)))
      throw InputError("surface " + surface.name + ": the facet at " + placeText(facet.position(0)) +
                           " has zero area: its nodes coincide or are collinear; repair the mesh there",
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
    if (inside[i] == 0)
      continue;
    const double length = norm(surface.normals[i]);
    // The cancellation of a fold, against the rounding of a sum of unit vectors.
    if (!(length > 1e-8 * around[i]))
      throw InputError("surface " + surface.name + ": folded at node " + std::to_string(surface.numbers[i]) +
                           " at " + placeText(surface.positions[i]) +
                           ", where facet normals cancel; name the two sides separately",
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
                           " does not point outward; reverse it or omit it to use averaged normals",
                       {{"surface", surface.name}, {"node", std::to_string(surface.numbers[i])}});
    surface.normals[i] = normal;
  }
}

// The same on every rank.
void setType(Surface& surface, const std::string& set, long long least, long long largest) {
  if (largest < 0)
    throw InputError("surface " + surface.name + ": the part \"" + set +
                         "\" has no sides of cells; name a boundary part of the body",
                     {{"surface", surface.name}, {"part", set}});
  if (least != largest)
    throw InputError("surface " + surface.name + ": facets of different types, " +
                         fem::shapeOf(static_cast<CellType>(least)).name + " and " +
                         fem::shapeOf(static_cast<CellType>(largest)).name +
                         "; give the parts of each type separate names",
                     {{"surface", surface.name}});
  surface.facetType = static_cast<CellType>(least);
  surface.dimension = fem::shapeOf(surface.facetType).dimension + 1;
}

// Own facets and those around.
void setPiece(Surface& surface, const Part& mine, const Meetings& meetings, int rank,
              const std::vector<std::vector<PlacedFacet>>& around) {
  std::vector<NodeCopy> nodes = mine.nodes;
  std::vector<FacetItem> facets = mine.facets;
  for (const std::vector<PlacedFacet>& part : around)
    for (const PlacedFacet& item : part) {
      facets.push_back(item.facet);
      for (std::size_t k = 0; k < maxFacetNodes && item.facet.nodes[k] != noNode; ++k)
        nodes.push_back({item.facet.nodes[k], item.positions[k]});
    }
  setNodes(surface, std::move(nodes));
  setFacets(surface, facets, mine.facets.size());
  surface.isOwnNode.assign(surface.numbers.size(), 0);
  for (std::size_t k = 0; k < mine.nodes.size(); ++k)
    if (meetings.of[k].owner == rank)
      surface.isOwnNode[static_cast<std::size_t>(placeOf(surface, mine.nodes[k].number))] = 1;
}

// Facets of this surface by their nodes.
int facetWith(const Surface& surface, const FacetItem& item) {
  std::vector<int> places;
  for (int k = 0; k < surface.nodesPerFacet(); ++k)
    places.push_back(placeOf(surface, item.nodes[static_cast<std::size_t>(k)]));
  const auto size = static_cast<std::ptrdiff_t>(places.size());
  std::ptrdiff_t low = 0, high = surface.numberOfFacets();
  while (low < high) {
    const std::ptrdiff_t middle = (low + high) / 2;
    const auto begin = surface.facets.begin() + middle * size;
    if (std::lexicographical_compare(begin, begin + size, places.begin(), places.end()))
      low = middle + 1;
    else
      high = middle;
  }
  return static_cast<int>(low);
}

// What is outside here is inside where the facet comes from. @note Collective.
void setSideNormals(Surface& surface, const Part& mine,
                    const std::vector<std::vector<std::size_t>>& forOthers) {
  const Teuchos::Comm<int>& comm = *surface.comm;
  std::vector<Point> normals;
  agree(comm, [&] { normals = Details::sideNormalsOf(surface, isInside(surface)); });
  if (globalMax(comm, normals.empty() ? 0LL : 1LL) == 0)
    return;
  if (normals.empty())
    for (int node : surface.facets)
      normals.push_back(surface.normals[static_cast<std::size_t>(node)]);
  const auto size = static_cast<std::size_t>(surface.nodesPerFacet());
  const auto at = [&](const FacetItem& facet) {
    return static_cast<std::ptrdiff_t>(facetWith(surface, facet)) * static_cast<std::ptrdiff_t>(size);
  };
  std::vector<std::vector<FacetSides>> sends(forOthers.size());
  for (std::size_t r = 0; r < forOthers.size(); ++r)
    for (std::size_t f : forOthers[r]) {
      FacetSides& item = sends[r].emplace_back();
      item.facet = mine.facets[f];
      std::copy_n(normals.begin() + at(item.facet), size, item.normals.begin());
    }
  for (const std::vector<FacetSides>& part : exchangeItems(comm, sends))
    for (const FacetSides& item : part)
      std::copy_n(item.normals.begin(), size, normals.begin() + at(item.facet));
  surface.sideNormals = std::move(normals);
}

void setBox(Surface& surface) {
  std::vector<double> ends(6, -std::numeric_limits<double>::infinity()); // −x, −y, −z, x, y, z at most
  for (const Point& x : surface.positions)
    for (std::size_t d = 0; d < 3; ++d) {
      ends[d] = std::max(ends[d], -x[d]);
      ends[3 + d] = std::max(ends[3 + d], x[d]);
    }
  globalMax(*surface.comm, ends);
  for (std::size_t d = 0; d < 3; ++d) {
    surface.wholeBox.low[d] = -ends[d];
    surface.wholeBox.high[d] = ends[3 + d];
  }
}

} // namespace

Surface gatherSurface(const Teuchos::Comm<int>& comm, const std::vector<const fem::PlacedMesh*>& parts,
                      const std::string& set, const std::string& name, const NormalField& field) {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  Part mine;
  agree(comm, [&] { mine = partOf(parts, set, name); });
  Surface surface;
  surface.name = name;
  surface.comm = &comm;
  setType(surface, set, globalMin(comm, mine.leastType), globalMax(comm, mine.largestType));
  surface.isAxisymmetric = globalMax(comm, mine.isAxisymmetric ? 1LL : 0LL) > 0;
  const Meetings meetings = meet(comm, mine.nodes);
  surface.wholeNodes = meetings.wholeNodes;
  std::vector<std::vector<std::size_t>> forOthers;
  std::vector<std::vector<PlacedFacet>> around(ranks);
  agree(comm, [&] {
    for (std::size_t k = 0; k < mine.nodes.size(); ++k)
      mine.nodes[k].position = meetings.of[k].position;
    forOthers = facetsForOthers(mine, meetings, ranks);
    for (std::size_t r = 0; r < ranks; ++r)
      for (std::size_t f : forOthers[r]) {
        PlacedFacet& item = around[r].emplace_back();
        item.facet = mine.facets[f];
        for (std::size_t k = 0; k < maxFacetNodes && item.facet.nodes[k] != noNode; ++k)
          item.positions[k] = mine.nodes[placeIn(mine.nodes, item.facet.nodes[k])].position;
      }
  });
  around = exchangeItems(comm, around);
  std::vector<std::vector<NodeResult>> results(ranks);
  agree(comm, [&] {
    setPiece(surface, mine, meetings, comm.getRank(), around);
    const std::vector<char> inside = isInside(surface);
    requireManifold(surface);
    setAreasAndNormals(surface, inside);
    for (std::size_t r = 0; r < ranks; ++r)
      for (std::size_t f : forOthers[r])
        for (const long long number : mine.facets[f].nodes)
          if (number != noNode) {
            const auto i = static_cast<std::size_t>(placeOf(surface, number));
            results[r].push_back({number, surface.normals[i], surface.areas[i]});
          }
  });
  // What is outside here is inside there.
  for (const std::vector<NodeResult>& part : exchangeItems(comm, results))
    for (const NodeResult& node : part) {
      const auto i = static_cast<std::size_t>(placeOf(surface, node.number));
      surface.normals[i] = node.normal;
      surface.areas[i] = node.area;
    }
  if (field)
    agree(comm, [&] { takeNormalsFrom(field, surface); });
  else
    setSideNormals(surface, mine, forOthers);
  setBox(surface);
  return surface;
}

namespace {

// Of triangles of six nodes from functions that are linear on four pieces, else of the carriers.
FacetIntegrals tributaryOn(const Surface& surface, const Facet& facet, const fem::Quadrature& rule) {
  if (hasCarrierRows(surface)) {
    FacetIntegrals result = integralsOn(facet, rule);
    result.ofNodes = Carriers(facet.type(), surface.isAxisymmetric).values(result.ofNodes);
    return result;
  }
  if (facet.type() != CellType::Triangle6)
    return integralsOn(facet, rule);
  constexpr std::array<std::array<std::size_t, 3>, 4> pieces = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  FacetIntegrals result;
  for (const auto& [a, b, c] : pieces) {
    const double area = 0.5 * norm(cross(difference(facet.position(b), facet.position(a)),
                                         difference(facet.position(c), facet.position(a))));
    result.area += area;
    for (std::size_t k : {a, b, c})
      result.ofNodes[k] += area / 3.0;
  }
  return result;
}

} // namespace

double sagitta(const Surface& surface) {
  constexpr double corner = 30.0 / 180.0 * 3.14159265358979323846, rounding = 1e-12;
  const fem::CellShape& shape = fem::shapeOf(surface.facetType);
  double most = 0.0;
  const auto size = static_cast<std::size_t>(shape.nodes);
  for (std::size_t f = 0; shape.order == 1 && f < surface.isOwnFacet.size(); ++f)
    for (std::size_t k = 0; surface.isOwnFacet[f] != 0 && k < size; ++k) {
      const std::size_t at = f * size + k, next = f * size + (k + 1) % size;
      const auto a = static_cast<std::size_t>(surface.facets[at]),
                 b = static_cast<std::size_t>(surface.facets[next]);
      const bool hasSides = !surface.sideNormals.empty();
      const Point turn = difference(hasSides ? surface.sideNormals[next] : surface.normals[b],
                                    hasSides ? surface.sideNormals[at] : surface.normals[a]);
      const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * norm(turn)));
      if (angle > rounding && angle < corner)
        most = std::max(most, norm(difference(surface.positions[b], surface.positions[a])) * angle / 8.0);
    }
  return globalMax(*surface.comm, most);
}

std::vector<double> tributaryAreas(const Surface& surface, const std::vector<Point>& towards) {
  const bool areFunctions = Carriers::usualShare(surface.facetType, surface.isAxisymmetric) == 0.0;
  if (areFunctions && towards.empty())
    return surface.areas;
  const fem::Quadrature rule =
      fem::quadratureOn(surface.facetType, 2 * fem::shapeOf(surface.facetType).order + 4);
  std::vector<double> whole(surface.numbers.size(), 0.0), facing = whole;
  std::vector<char> isPartial(surface.numbers.size(), 0);
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    const FacetIntegrals integrals = tributaryOn(surface, facet, rule);
    for (std::size_t k = 0; k < facet.size(); ++k) {
      const std::size_t i = facet.node(k);
      whole[i] += integrals.ofNodes[k];
      if (towards.empty() || facesAt(facet, k, towards[i]))
        facing[i] += integrals.ofNodes[k];
      else
        isPartial[i] = 1;
    }
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (isPartial[i] != 0 && facing[i] > 0.0)
      whole[i] = facing[i];
    else if (areFunctions)
      whole[i] = surface.areas[i];
  }
  return whole;
}

} // namespace Harmos::contact
