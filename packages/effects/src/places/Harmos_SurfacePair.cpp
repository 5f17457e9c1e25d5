// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SurfacePair.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace Harmos::effects {

std::vector<scene::Effect::BoundaryPart> SurfacePair::parts() const {
  return {{first.body, first.set, true}, {second.body, second.set, true}};
}

namespace {

using Taken = std::optional<scene::ConstraintCollector::Taken>;

// Whether a point with one of the normals that the surface has at a node would hold the same jump.
bool holdsSame(const Taken& taken, const std::vector<fem::Point>& normals, bool isTie) {
  constexpr double parallel = 0.64; // within contact::sharpestAngle
  if (!taken || (isTie && !taken->isTied))
    return false;
  return taken->isTied || std::any_of(normals.begin(), normals.end(), [&](const fem::Point& normal) {
           return std::abs(dot(normal, taken->normal)) > parallel;
         });
}

// What effects before have of a surface.
struct Belonging {
  std::vector<char> nodes; // of each that is here
  bool overlaps = true;    // all facets are those of one other effect each
};

// Where effects overlap, as a contact that is named twice, all nodes of a facet are those of one other
// effect, and rows that are the same are left out later (scene::DistinctPoints), unless a tie holds what a
// contact would.
Belonging belongToOthers(const contact::Surface& surface, const std::vector<Taken>& taken, bool isTie) {
  std::vector<std::vector<fem::Point>> normals(surface.numbers.size());
  const std::vector<fem::Point>& ofFacets = surface.sideNormals;
  for (std::size_t k = 0; k < surface.facets.size(); ++k) {
    const auto i = static_cast<std::size_t>(surface.facets[k]);
    normals[i].push_back(ofFacets.empty() ? surface.normals[i] : ofFacets[k]);
  }
  Belonging result;
  result.nodes.assign(surface.numbers.size(), 0);
  std::vector<char> holds;
  for (std::size_t i = 0; i < taken.size(); ++i)
    holds.push_back(holdsSame(taken[i], normals[i], isTie) ? 1 : 0);
  const auto size = static_cast<std::size_t>(surface.nodesPerFacet());
  for (std::size_t k = 0; k < surface.facets.size(); k += size) {
    const auto placeOf = [&](std::size_t j) { return static_cast<std::size_t>(surface.facets[k + j]); };
    bool isOverlap = true;
    for (std::size_t j = 0; j < size; ++j)
      isOverlap =
          isOverlap && holds[placeOf(j)] != 0 && taken[placeOf(j)]->effect == taken[placeOf(0)]->effect;
    for (std::size_t j = 0; j < size; ++j)
      if (const std::size_t i = placeOf(j); holds[i] != 0 && (!isOverlap || (!isTie && taken[i]->isTied)))
        result.nodes[i] = 1;
    result.overlaps = result.overlaps && isOverlap;
  }
  return result;
}

// Nodes of the surface over all ranks. @note Collective.
long long countOf(const contact::Surface& surface, const std::vector<char>& nodes) {
  long long own = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    own += nodes[i] != 0 && surface.isOwnNode[i] != 0 ? 1 : 0;
  return globalSum(*surface.comm, own);
}

// A surface between others, a facet wide, may have no node for itself. @note Collective.
void requireOwn(const contact::Surface& one, const contact::Surface& other, const Belonging& others) {
  if (globalMax(*one.comm, others.overlaps ? 0LL : 1LL) == 0)
    return;
  const std::string message = one.name + " on " + other.name +
                              ": every node of the first surface belongs to an adjacent contact or tie, so "
                              "no node can carry a multiplier; make the surface wider than one facet, name "
                              "the finer surface first, or merge it with one of those";
  throw InputError(message, {{"first", one.name}, {"second", other.name}});
}

std::vector<long long> numbersOf(const contact::Surface& surface, const std::vector<char>& nodes) {
  std::vector<long long> result;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i] != 0)
      result.push_back(surface.numbers[i]);
  return result;
}

// @param points by node number. @note Collective.
void tellOfLone(scene::ConstraintCollector& collector, const contact::Surface& one,
                const contact::Surface& other, const std::vector<contact::ContactPoint>& points,
                long long without) {
  long long found = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
    found += k == 0 || points[k].node != points[k - 1].node ? 1 : 0;
  const long long lone = one.wholeNodes - without - globalSum(*one.comm, found);
  if (lone > 0)
    collector.note(std::to_string(lone) + " of the " + std::to_string(one.wholeNodes) + " nodes of " +
                   one.name + " have no counterpart on " + other.name + " within reach and can penetrate it");
}

// A press fit is as exact as the surfaces: what straight facets leave out is missing in the overlap.
// @note Collective.
void tellOfFacets(scene::ConstraintCollector& collector, const contact::Surface& one,
                  const contact::Surface& other, const std::vector<contact::ContactPoint>& points,
                  double gap) {
  double overlap = 0.0;
  for (const contact::ContactPoint& point : points)
    overlap = std::max(overlap, -(point.gap + gap));
  overlap = globalMax(*one.comm, overlap);
  const double behind = contact::sagitta(one) + contact::sagitta(other);
  // Two rings, fitted, of linear triangles: pressures up to 10 % off at 22 %, less than 1 % at 15 %. Surfaces
  // that but touch overlap by as much as the facets stay behind.
  constexpr double enough = 0.2, touching = 2.0;
  if (behind > enough * overlap && overlap > (gap < 0.0 ? 0.0 : touching * behind))
    collector.note(one.name + " on " + other.name + " overlap by " + scientific(overlap) +
                   ", their straight facets deviate by up to " + scientific(behind) +
                   " from the curved geometry: the relative error of pressures can reach the ratio of both. "
                   "Use second-order cells (harmos-mesh --order 2), matching nodes or smaller cells (half "
                   "the size: a quarter of the error)");
}

} // namespace

std::vector<contact::ContactPoint> SurfacePair::points(scene::ConstraintCollector& collector, Purpose purpose,
                                                       double gap) const {
  // Normals that are known are those of bodies at rest.
  const bool isMoved = collector.isOfMoved();
  const contact::Surface one = collector.surface(first.body, first.set, isMoved ? nullptr : normal);
  const contact::Surface other = collector.surface(second.body, second.set);
  const bool isTie = purpose == Purpose::Tie, joinsEdges = isTie || collector.isScalar();
  Belonging others = belongToOthers(one, collector.taken(first.body, second.body, one.numbers), isTie);
  std::vector<char>& without = others.nodes;
  if (countOf(one, without) == one.wholeNodes) {
    requireOwn(one, other, others);
    without.assign(without.size(), 0); // a contact on a tie: the rows of the tie hold
  }
  if (first.body == second.body) {
    const std::vector<char> isOfBoth = contact::isShared(one, other);
    for (std::size_t i = 0; i < without.size(); ++i)
      without[i] = std::max(without[i], isOfBoth[i]);
  }
  // Node to node cannot pass on what a node without a row has: mortar coupling can. Nor are forces of a
  // constant pressure positive at all corners of each facet, which inequalities need.
  const bool canMatch = isTie || !contact::hasCarrierRows(one);
  if (coupling == Coupling::Nodes && !canMatch)
    throw InputError(one.name + " on " + other.name +
                         ": contact node to node needs elements whose corner nodes bear pressure, which "
                         "quadrilaterals of eight nodes, and lines of three nodes around an axis, lack; use "
                         "the coupling \"mortar\" or \"automatic\"",
                     {{"first", one.name}, {"second", other.name}});
  std::optional<std::vector<contact::ContactPoint>> matched;
  if (coupling == Coupling::Nodes && !isMoved)
    matched = contact::matchNodes(one, other, contact::samePlace, joinsEdges);
  else if (coupling == Coupling::Automatic && !isMoved && canMatch && countOf(one, without) == 0)
    matched = contact::matchNodesIfAll(one, other, contact::samePlace, joinsEdges);
  std::vector<contact::ContactPoint> points =
      matched ? std::move(*matched)
              : contact::mortarPoints(one, other,
                                      {isMoved ? reachFor(one, other, gap) : reach, joinsEdges,
                                       numbersOf(one, without), isMoved});
  if (normal && !isMoved) // exact where it is known, not averaged with the other side's facets
    for (contact::ContactPoint& point : points) {
      const auto at = std::lower_bound(one.numbers.begin(), one.numbers.end(), point.node);
      point.normal = one.normals[static_cast<std::size_t>(at - one.numbers.begin())];
    }
  tellOfLone(collector, one, other, points, countOf(one, without));
  if (!isTie && !matched)
    tellOfFacets(collector, one, other, points, gap);
  return points;
}

double SurfacePair::reachFor(const contact::Surface& one, const contact::Surface& other, double gap) const {
  return contact::reachOf(one, other, reach) + std::abs(gap);
}

std::map<std::pair<long long, int>, double>
SurfacePair::gapsAtRest(scene::ConstraintCollector& collector) const {
  contact::MortarOptions options;
  options.reach = reach;
  options.mayBeApart = true;
  std::map<std::pair<long long, int>, double> gaps;
  for (const contact::ContactPoint& point :
       contact::mortarPoints(collector.surfaceAtRest(first.body, first.set),
                             collector.surfaceAtRest(second.body, second.set), options))
    gaps[{point.node, point.side}] = point.gap;
  return gaps;
}

void SurfacePair::requireNear(scene::ConstraintCollector& collector, double largest,
                              const std::string& what) const {
  const contact::Surface surface = collector.surfaceAtRest(first.body, first.set);
  largest = globalMax(*surface.comm, largest);
  constexpr double share = 1e-4;
  const fem::Point size = difference(surface.wholeBox.high, surface.wholeBox.low);
  const double allowed = share * std::max({size[0], size[1], size[2]});
  if (largest > allowed)
    throw InputError(what + " distances of up to " + scientific(largest) +
                     " to be zero; with \"Model/Kinematics\" = \"finite\" at most " + scientific(allowed) +
                     ", a share of the surface's extent: move the mesh");
}

void SurfacePair::addTo(ParameterSpec& spec) {
  spec.text("First", "", "\"body/boundary part\" with the multipliers: the finer or softer one. Required.");
  spec.text("Second", "", "\"body/boundary part\" opposite to the first one. Required.");
  spec.choice("Coupling", "automatic",
              {{"automatic", "nodes if they match, else mortar"},
               {"nodes", "node to node; the nodes must match"},
               {"mortar", "dual Lagrange multipliers; the meshes need not match"}},
              "Coupling of the two meshes.");
  spec.real(
      "Reach", 0.0, Range::atLeast(0.0),
      "Mortar: largest distance of opposite surfaces, a length. 0: a tenth of the smaller surface's extent.");
}

SurfacePair SurfacePair::fromList(const Teuchos::ParameterList& list, const std::string& path,
                                  const scene::Scene& scene) {
  SurfacePair pair;
  pair.first = partIn(scene, list, "First", path);
  pair.second = partIn(scene, list, "Second", path);
  if (pair.first.body == pair.second.body && pair.first.set == pair.second.set)
    throw InputError("\"" + path +
                         "\": \"First\" and \"Second\" are the same boundary part; name two that face "
                         "each other",
                     {{"path", path}});
  const std::string coupling = list.get<std::string>("Coupling");
  pair.coupling = coupling == "nodes"    ? Coupling::Nodes
                  : coupling == "mortar" ? Coupling::Mortar
                                         : Coupling::Automatic;
  pair.reach = list.get<double>("Reach");
  return pair;
}

} // namespace Harmos::effects
