// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>

namespace Harmos::contact {
namespace {

using fem::Point;

// Rounding errors of a position grow with its distance from the origin, which is why that counts too.
double magnitude(const Surface& surface) {
  double result = 1e-100;
  for (std::size_t d = 0; d < 3; ++d) {
    const double least = surface.wholeBox.low[d], most = surface.wholeBox.high[d];
    if (least <= most)
      result = std::max({result, most - least, std::abs(least), std::abs(most)});
  }
  return result;
}

// Cells of twice the tolerance; a partner lies in the same or in a neighbouring cell.
using Cell = std::array<long long, 3>;
Cell cellOf(const Point& x, double size) {
  return {std::llround(x[0] / size), std::llround(x[1] / size), std::llround(x[2] / size)};
}

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

// Of this rank's own nodes of the first surface.
struct Matching {
  Surface near;                      // what is near them of the second surface
  std::vector<std::size_t> own;      // their places
  std::vector<std::size_t> partners; // of each: place in near, or nobody
  long long matched = 0;             // over all ranks
  bool hasDisputes = false;          // several nodes of a surface are at one place, on any rank
};

struct Pair {
  long long first, second; // node numbers
};

// Nodes of near that are where each of the own nodes is.
std::vector<std::vector<std::size_t>> candidatesOf(const Surface& first, const Matching& matching,
                                                   double size) {
  const std::vector<Point>& there = matching.near.positions;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < there.size(); ++k)
    cells[cellOf(there[k], size)].push_back(k);
  std::vector<std::vector<std::size_t>> result;
  for (std::size_t i : matching.own) {
    std::vector<std::size_t>& candidates = result.emplace_back();
    const Point& x = first.positions[i];
    const Cell centre = cellOf(x, size);
    for (long long dx = -1; dx <= 1; ++dx)
      for (long long dy = -1; dy <= 1; ++dy)
        for (long long dz = -1; dz <= 1; ++dz) {
          const auto found = cells.find({centre[0] + dx, centre[1] + dy, centre[2] + dz});
          if (found == cells.end())
            continue;
          for (std::size_t k : found->second)
            if (norm(difference(x, there[k])) <= 0.5 * size)
              candidates.push_back(k);
        }
  }
  return result;
}

// Whether somebody else, too, may be the partner of the candidates of each own node, or of it.
std::vector<char> areDisputed(const Surface& first, const Matching& matching,
                              const std::vector<std::vector<std::size_t>>& candidates) {
  struct Claims {
    long long least, most; // first nodes that claim a second one
  };
  std::vector<std::pair<long long, Claims>> claims;
  std::vector<long long> asked;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    for (std::size_t c : candidates[k]) {
      const long long own = first.numbers[matching.own[k]];
      asked.push_back(matching.near.numbers[c]);
      claims.emplace_back(asked.back(), Claims{own, own});
    }
  const auto all = lookUpMerged(*first.comm, claims, asked, [](Claims& present, const Claims& next) {
    present = {std::min(present.least, next.least), std::max(present.most, next.most)};
  });
  std::vector<char> result;
  std::size_t next = 0;
  for (const std::vector<std::size_t>& list : candidates) {
    bool isDisputed = list.size() > 1;
    for (std::size_t c = 0; c < list.size(); ++c, ++next)
      isDisputed = isDisputed || all[next]->least != all[next]->most;
    result.push_back(isDisputed ? 1 : 0);
  }
  return result;
}

// Where several nodes of a surface are at one place, as at a crack, each takes one: first come, first served.
// These are few, and all ranks see them.
std::map<long long, long long> settled(const Teuchos::Comm<int>& comm, const std::vector<Pair>& disputed) {
  std::map<long long, std::vector<long long>> wishes;
  for (const Pair& pair : gatherAll(comm, disputed))
    wishes[pair.first].push_back(pair.second);
  std::set<long long> taken;
  std::map<long long, long long> result;
  for (const auto& [first, candidates] : wishes) {
    const auto last = std::find_if(candidates.rbegin(), candidates.rend(),
                                   [&](long long second) { return taken.count(second) == 0; });
    if (last == candidates.rend())
      continue;
    result[first] = *last;
    taken.insert(*last);
  }
  return result;
}

Matching match(const Surface& first, const Surface& second, double tolerance) {
  const Teuchos::Comm<int>& comm = *first.comm;
  const double size = 2.0 * tolerance * std::max(magnitude(first), magnitude(second));
  Matching matching;
  std::vector<fem::Box> places;
  for (std::size_t i = 0; i < first.numbers.size(); ++i)
    if (first.isOwnNode[i] != 0) {
      matching.own.push_back(i);
      places.push_back(fem::widened({first.positions[i], first.positions[i]}, size));
    }
  matching.near = facetsTouching(second, places);
  std::vector<std::vector<std::size_t>> candidates;
  agree(comm, [&] { candidates = candidatesOf(first, matching, size); });
  const std::vector<char> isDisputed = areDisputed(first, matching, candidates);
  std::vector<Pair> disputed;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    for (std::size_t c : candidates[k])
      if (isDisputed[k] != 0)
        disputed.push_back({first.numbers[matching.own[k]], matching.near.numbers[c]});
  const std::map<long long, long long> served = settled(comm, disputed);
  matching.hasDisputes = globalMax(comm, static_cast<long long>(disputed.size())) > 0;
  long long matched = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    std::size_t partner = candidates[k].empty() ? nobody : candidates[k].front();
    if (isDisputed[k] != 0) {
      const auto found = served.find(first.numbers[matching.own[k]]);
      partner = nobody;
      for (std::size_t c : candidates[k])
        if (found != served.end() && matching.near.numbers[c] == found->second)
          partner = c;
    }
    matching.partners.push_back(partner);
    matched += partner == nobody ? 0 : 1;
  }
  matching.matched = globalSum(comm, matched);
  return matching;
}

[[noreturn]] void throwUnmatched(const Surface& first, const Surface& second, bool isFirst, std::size_t k) {
  const Surface& surface = isFirst ? first : second;
  const std::string number = std::to_string(surface.numbers[k]);
  throw InputError(first.name + " and " + second.name + ": the surfaces do not match: node " + number +
                       " at " + placeText(surface.positions[k]) + " of the " +
                       (isFirst ? "first surface has no partner on the second one"
                                : "second surface has no partner on the first one") +
                       "; use matching meshes or mortar coupling",
                   {{"node", number}});
}

// Of those without a partner the lowest number is named. @param alone this rank's, places of the surface,
// rising.
void requireNone(const Surface& first, const Surface& second, bool isFirst,
                 const std::vector<std::size_t>& alone) {
  const Surface& surface = isFirst ? first : second;
  const long long mine =
      alone.empty() ? std::numeric_limits<long long>::max() : surface.numbers[alone.front()];
  const long long least = globalMin(*surface.comm, mine);
  agree(*surface.comm, [&] {
    if (!alone.empty() && mine == least)
      throwUnmatched(first, second, isFirst, alone.front());
  });
}

void requireAllMatched(const Surface& first, const Surface& second, const Matching& matching) {
  if (matching.matched == first.wholeNodes && matching.matched == second.wholeNodes)
    return;
  std::vector<std::size_t> alone;
  for (std::size_t k = 0; k < matching.own.size(); ++k)
    if (matching.partners[k] == nobody)
      alone.push_back(matching.own[k]);
  requireNone(first, second, true, alone);
  std::vector<std::pair<long long, char>> taken;
  for (std::size_t partner : matching.partners)
    taken.emplace_back(matching.near.numbers[partner], 1);
  std::vector<std::size_t> own;
  std::vector<long long> asked;
  for (std::size_t i = 0; i < second.numbers.size(); ++i)
    if (second.isOwnNode[i] != 0) {
      own.push_back(i);
      asked.push_back(second.numbers[i]);
    }
  const auto answers = lookUp(*second.comm, taken, asked);
  alone.clear();
  for (std::size_t k = 0; k < own.size(); ++k)
    if (!answers[k])
      alone.push_back(own[k]);
  requireNone(first, second, false, alone);
}

// A node as its smooth sides see it: places in the surface with its sides apart.
using Sides = std::pair<std::size_t, std::size_t>;

Sides sidesOf(const Surface& apart, long long number) {
  const auto range = std::equal_range(apart.numbers.begin(), apart.numbers.end(), number);
  return {range.first - apart.numbers.begin(), range.second - apart.numbers.begin()};
}

// The normals of those sides of two nodes that face each other most.
struct FacingSides {
  std::size_t first, second;
  double cosine;
};

FacingSides mostFacing(const Surface& first, std::size_t i, const Surface& second, Sides others) {
  FacingSides result = {i, others.first, dot(first.normals[i], second.normals[others.first])};
  for (std::size_t k = others.first + 1; k < others.second; ++k)
    if (const double cosine = dot(first.normals[i], second.normals[k]); cosine < result.cosine)
      result = {i, k, cosine};
  return result;
}

ContactPoint pointOf(const Surface& first, const Surface& second, const FacingSides& sides, double area) {
  const std::size_t i = sides.first, k = sides.second;
  ContactPoint point;
  point.node = first.numbers[i];
  point.position = first.positions[i];
  point.terms = {{first.numbers[i], 1.0}, {second.numbers[k], -1.0}};
  std::sort(point.terms.begin(), point.terms.end(),
            [](const ContactPoint::Term& a, const ContactPoint::Term& b) { return a.node < b.node; });
  const Point normal = difference(first.normals[i], second.normals[k]);
  const double length = norm(normal); // 2 where the surfaces face each other
  if (!(length > 1e-8))
    throw InputError(
        first.name + " and " + second.name + ": at node " + std::to_string(point.node) + " at " +
            placeText(first.positions[i]) +
            " the normals of both surfaces point the same way; contact needs surfaces that face each other",
        {{"node", std::to_string(point.node)}});
  point.normal = scaled(1.0 / length, normal);
  point.gap = dot(difference(second.positions[k], first.positions[i]), point.normal);
  point.area = area;
  return point;
}

// With the sides of both surfaces apart: each side of a node that faces one of its partner; at least one.
void addPoints(const Surface& first, const Surface& second, Sides own, Sides others,
               const std::vector<double>& areas, std::vector<ContactPoint>& points) {
  FacingSides most = mostFacing(first, own.first, second, others);
  bool isAny = false;
  for (std::size_t i = own.first; i < own.second; ++i) {
    const FacingSides sides = mostFacing(first, i, second, others);
    most = sides.cosine < most.cosine ? sides : most;
    if (own.second - own.first == 1 || sides.cosine < -leastFacing) {
      points.push_back(pointOf(first, second, sides, areas[i]));
      points.back().side = static_cast<int>(i - own.first);
      isAny = true;
    }
  }
  if (!isAny) {
    points.push_back(pointOf(first, second, most, areas[most.first]));
    points.back().side = static_cast<int>(most.first - own.first);
  }
}

std::vector<ContactPoint> pointsOf(const Surface& first, const Matching& matching, bool joinsEdges) {
  std::vector<ContactPoint> points;
  agree(*first.comm, [&] {
    const Surface ownSides = joinsEdges ? first : splitAtEdges(first);
    const Surface otherSides = joinsEdges ? matching.near : splitAtEdges(matching.near);
    const std::vector<double> areas = tributaryAreas(ownSides);
    for (std::size_t k = 0; k < matching.own.size(); ++k) {
      const std::size_t i = matching.own[k], partner = matching.partners[k];
      const long long own = first.numbers[i], other = matching.near.numbers[partner];
      // A node that looks both ways is in contact with itself.
      if (own != other || dot(first.normals[i], matching.near.normals[partner]) > 0.0)
        addPoints(ownSides, otherSides, sidesOf(ownSides, own), sidesOf(otherSides, other), areas, points);
    }
    setPressures(ownSides, {}, points);
  });
  return points;
}

// Of nodes in any order.
long long keyOf(std::vector<long long> nodes) {
  std::sort(nodes.begin(), nodes.end());
  std::uint64_t key = 1469598103934665603ULL; // Fowler, Noll, Vo
  for (const long long node : nodes)
    key = (key ^ static_cast<std::uint64_t>(node)) * 1099511628211ULL;
  return static_cast<long long>(key >> 1);
}

// Whether facets have the same nodes too. Where they do not, as triangles of other diagonals, a constant
// pressure has other forces at the nodes of either side. @note Collective.
bool facetsMatch(const Surface& first, const Surface& second, const Matching& matching) {
  // Where several nodes are at one place facets may go by any of them.
  if (matching.hasDisputes)
    return true;
  std::vector<std::pair<long long, long long>> partners;
  for (std::size_t k = 0; k < matching.own.size(); ++k)
    partners.emplace_back(first.numbers[matching.own[k]], matching.near.numbers[matching.partners[k]]);
  const auto partnerOf = lookUp(*first.comm, partners, first.numbers);
  const auto ownFacets = [](const Surface& surface, auto&& numberOf) {
    std::vector<long long> keys;
    for (int f = 0; f < surface.numberOfFacets(); ++f) {
      const Facet facet(surface, f);
      std::vector<long long> nodes;
      for (std::size_t k = 0; k < facet.size(); ++k)
        nodes.push_back(numberOf(facet.node(k)));
      if (surface.isOwnFacet[static_cast<std::size_t>(f)] != 0)
        keys.push_back(keyOf(nodes));
    }
    return keys;
  };
  std::vector<std::pair<long long, char>> known;
  for (const long long key : ownFacets(second, [&](std::size_t i) { return second.numbers[i]; }))
    known.emplace_back(key, 1);
  const auto found =
      lookUp(*first.comm, known, ownFacets(first, [&](std::size_t i) { return partnerOf[i].value_or(-1); }));
  long long missing = 0;
  for (const auto& answer : found)
    missing += answer ? 0 : 1;
  return globalSum(*first.comm, missing) == 0;
}

} // namespace

std::optional<std::vector<ContactPoint>> matchNodesIfAll(const Surface& first, const Surface& second,
                                                         double tolerance, bool joinsEdges) {
  if (first.wholeNodes != second.wholeNodes)
    return std::nullopt;
  if (first.facetType != second.facetType)
    return std::nullopt;
  const Matching matching = match(first, second, tolerance);
  if (matching.matched != first.wholeNodes || !facetsMatch(first, second, matching))
    return std::nullopt;
  return pointsOf(first, matching, joinsEdges);
}

std::vector<char> isShared(const Surface& first, const Surface& second) {
  std::vector<std::pair<long long, char>> known;
  for (std::size_t i = 0; i < second.numbers.size(); ++i)
    if (second.isOwnNode[i] != 0)
      known.emplace_back(second.numbers[i], 1);
  std::vector<char> result;
  for (const auto& answer : lookUp(*first.comm, known, first.numbers))
    result.push_back(answer.has_value() ? 1 : 0);
  return result;
}

std::vector<ContactPoint> matchNodes(const Surface& first, const Surface& second, double tolerance,
                                     bool joinsEdges) {
  const Matching matching = match(first, second, tolerance);
  requireAllMatched(first, second, matching);
  return pointsOf(first, matching, joinsEdges);
}

} // namespace Harmos::contact
