// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NodePairs.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Harmos::contact {
namespace {

// Copies merged, every node once, by number.
std::vector<SurfaceNode> merged(const std::vector<SurfaceNode>& nodes) {
  std::map<long long, SurfaceNode> unique;
  for (const SurfaceNode& node : nodes) {
    const auto [place, isNew] = unique.emplace(node.node, node);
    if (!isNew)
      place->second.length += node.length;
  }
  std::vector<SurfaceNode> result;
  for (const auto& item : unique)
    result.push_back(item.second);
  return result;
}

double extent(const std::vector<SurfaceNode>& nodes) {
  double result = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const SurfaceNode& node : nodes) {
      least = std::min(least, node.position[d]);
      most = std::max(most, node.position[d]);
    }
    // Rounding errors of a position grow with its distance from the origin.
    result = std::max({result, most - least, std::abs(least), std::abs(most)});
  }
  return result;
}

std::string placeText(const SurfaceNode& node) {
  return "(" + std::to_string(node.position[0]) + ", " + std::to_string(node.position[1]) + ", " +
         std::to_string(node.position[2]) + ")";
}

// Cells of the size of the tolerance; a partner lies in the same or in a neighbouring cell.
using Cell = std::array<long long, 3>;
Cell cellOf(const SurfaceNode& node, double size) {
  return {std::llround(node.position[0] / size), std::llround(node.position[1] / size),
          std::llround(node.position[2] / size)};
}

double distance(const SurfaceNode& a, const SurfaceNode& b) {
  return std::hypot(a.position[0] - b.position[0], a.position[1] - b.position[1],
                    a.position[2] - b.position[2]);
}

std::vector<ConstraintRow> rows(const Teuchos::Comm<int>& comm, const std::vector<NodePair>& pairs,
                                ConstraintRow::Kind kind) {
  std::vector<ConstraintRow> result;
  for (std::size_t k = static_cast<std::size_t>(comm.getRank()); k < pairs.size();
       k += static_cast<std::size_t>(comm.getSize())) {
    ConstraintRow row;
    row.kind = kind;
    row.number = static_cast<long long>(k);
    row.terms = {{pairs[k].first, 1.0}, {pairs[k].second, -1.0}};
    row.bound = kind == ConstraintRow::Kind::Inequality ? pairs[k].gap : 0.0;
    result.push_back(row);
  }
  return result;
}

} // namespace

std::vector<SurfaceNode> surfaceNodes(const fem::PlacedMesh& placed, const std::string& set) {
  const auto found = placed.sets.find(set);
  if (found == placed.sets.end())
    return {};
  const std::vector<int>& nodes = found->second;
  std::vector<SurfaceNode> result;
  std::vector<int> place(static_cast<std::size_t>(placed.mesh->numberOfNodes()), -1); // in the result
  for (int node : nodes) {
    const fem::Point x = placed.position(node);
    place[static_cast<std::size_t>(node)] = static_cast<int>(result.size());
    result.push_back({placed.number(node), {x[0], x[1], x[2]}, 0.0});
  }
  // Each cell edge with both ends on the surface gives half of its length to either. An edge inside the
  // subdomain would be met in two cells; a boundary edge is met in one.
  const std::vector<int>& cells = placed.mesh->cells;
  constexpr std::size_t corners = 4;
  for (std::size_t c = 0; c < cells.size(); c += corners)
    for (std::size_t i = 0; i < corners; ++i) {
      const int a = place[static_cast<std::size_t>(cells[c + i])];
      const int b = place[static_cast<std::size_t>(cells[c + (i + 1) % corners])];
      if (a < 0 || b < 0)
        continue;
      SurfaceNode& first = result[static_cast<std::size_t>(a)];
      SurfaceNode& second = result[static_cast<std::size_t>(b)];
      const double half = 0.5 * distance(first, second);
      first.length += half;
      second.length += half;
    }
  return result;
}

std::vector<NodePair> pairNodes(const Teuchos::Comm<int>& comm, const std::vector<SurfaceNode>& first,
                                const std::vector<SurfaceNode>& second, const std::string& what,
                                double tolerance) {
  const std::vector<SurfaceNode> a = merged(gatherAll(comm, first));
  const std::vector<SurfaceNode> b = merged(gatherAll(comm, second));
  // From here on every rank has the same data and meets the same errors.
  if (a.empty() || b.empty())
    throw InputError(what + ": the " + (a.empty() ? "first" : "second") + " surface has no nodes");
  const double size = 2.0 * tolerance * std::max({extent(a), extent(b), 1e-100});
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < b.size(); ++k)
    cells[cellOf(b[k], size)].push_back(k);
  std::vector<bool> taken(b.size(), false);
  struct Placed {
    NodePair pair;
    const SurfaceNode* node;
  };
  std::vector<Placed> pairs;
  for (const SurfaceNode& node : a) {
    const Cell centre = cellOf(node, size);
    std::size_t partner = b.size();
    for (long long dx = -1; dx <= 1; ++dx)
      for (long long dy = -1; dy <= 1; ++dy)
        for (long long dz = -1; dz <= 1; ++dz) {
          const auto found = cells.find({centre[0] + dx, centre[1] + dy, centre[2] + dz});
          if (found == cells.end())
            continue;
          for (std::size_t k : found->second)
            if (!taken[k] && distance(node, b[k]) <= 0.5 * size)
              partner = k;
        }
    if (partner == b.size())
      throw InputError(what + ": the surfaces do not match: node " + std::to_string(node.node) + " at " +
                           placeText(node) + " of the first surface has no partner on the second one",
                       {{"node", std::to_string(node.node)}});
    taken[partner] = true;
    pairs.push_back({{node.node, b[partner].node, 0.0, node.length}, &node});
  }
  const auto left = std::find(taken.begin(), taken.end(), false);
  if (left != taken.end()) {
    const SurfaceNode& node = b[static_cast<std::size_t>(left - taken.begin())];
    throw InputError(what + ": the surfaces do not match: node " + std::to_string(node.node) + " at " +
                         placeText(node) + " of the second surface has no partner on the first one",
                     {{"node", std::to_string(node.node)}});
  }
  std::vector<NodePair> result;
  for (const Placed& placed : pairs)
    result.push_back(placed.pair);
  return result;
}

std::vector<ConstraintRow> contactRows(const Teuchos::Comm<int>& comm, const std::vector<NodePair>& pairs) {
  return rows(comm, pairs, ConstraintRow::Kind::Inequality);
}

std::vector<ConstraintRow> tieRows(const Teuchos::Comm<int>& comm, const std::vector<NodePair>& pairs) {
  return rows(comm, pairs, ConstraintRow::Kind::Equality);
}

} // namespace Harmos::contact
