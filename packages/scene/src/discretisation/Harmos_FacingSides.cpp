// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FacingSides.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoxTree.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_OuterSides.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_SideGeometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace Harmos::scene {
namespace {

using fem::Point;

constexpr double leastOpposed = 0.5; // normals that look at each other: 60 degrees
constexpr std::size_t mostNodes = 9; // of a side

// A side as it goes from rank to rank.
struct SideItem {
  std::array<Point, mostNodes> nodes;
  Point middle, normal;
  double radius;    // of the corners around the middle
  double thickness; // of its body behind it, as far as it is known
  int count;        // of nodes
  int body;
};

SideItem itemOf(const OwnedSubdomain& owner, const fem::Side& side) {
  const fem::SideGeometry geometry = fem::geometryOf(owner.mesh, side);
  SideItem item{};
  for (int node : owner.mesh.mesh->nodesOf(side))
    item.nodes[at(item.count++)] = owner.mesh.position(node);
  item.middle = geometry.middle;
  item.normal = geometry.normal;
  for (const Point& corner : geometry.corners)
    item.radius = std::max(item.radius, norm(difference(corner, item.middle)));
  item.thickness = std::numeric_limits<double>::infinity();
  item.body = owner.body;
  return item;
}

fem::Box boxOf(const SideItem& side) {
  return fem::boxAround({side.nodes.begin(), side.nodes.begin() + side.count});
}

// How far the nodes of another side are above this one along its normal, below zero beneath: that which is
// nearest, 0 where they are on both sides of it.
double heightAbove(const SideItem& side, const SideItem& other) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int k = 0; k < other.count; ++k) {
    const double height = dot(difference(other.nodes[at(k)], side.middle), side.normal);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return low > 0.0 ? low : high < 0.0 ? high : 0.0;
}

// Along one of the normals, by which they are nearer.
double gapBetween(const SideItem& a, const SideItem& b) {
  const double first = heightAbove(a, b), second = heightAbove(b, a);
  return std::abs(first) < std::abs(second) ? first : second;
}

// Whether normals look at each other, and sides are one above the other.
bool areOpposite(const SideItem& a, const SideItem& b) {
  if (dot(a.normal, b.normal) > -leastOpposed)
    return false;
  const Point between = difference(b.middle, a.middle);
  const double along = dot(between, a.normal);
  return norm(difference(between, scaled(along, a.normal))) <= a.radius + b.radius;
}

// Overlaps of more than half of what is behind a side are none: the far sides of two sheets on each other
// look at each other, too.
bool areFacing(const SideItem& a, const SideItem& b, double distance) {
  if (!areOpposite(a, b))
    return false;
  const double gap = gapBetween(a, b);
  return std::abs(gap) <= distance && -gap <= 0.5 * std::min(a.thickness, b.thickness);
}

// Whether a side of a third body is between two that face each other.
bool isBetween(const SideItem& third, const SideItem& a, const SideItem& b) {
  if (third.body == a.body || third.body == b.body || dot(a.normal, third.normal) > -leastOpposed)
    return false;
  const double whole = dot(difference(b.middle, a.middle), a.normal),
               height = dot(difference(third.middle, a.middle), a.normal);
  constexpr double rounding = 1e-9;
  if (!(height > -rounding * whole && height < (1.0 - rounding) * whole))
    return false;
  const Point on = sum(a.middle, scaled(height / whole, difference(b.middle, a.middle)));
  const Point aside = difference(third.middle, on);
  return norm(difference(aside, scaled(dot(aside, third.normal), third.normal))) <= third.radius;
}

// The distance of each pair of bodies.
class Nearness {
 public:
  Nearness(std::vector<double> diagonals, double distance)
      : diagonals_(std::move(diagonals)), distance_(distance) {}

  double of(int a, int b) const {
    return distance_ > 0.0 ? distance_ : share_ * std::min(diagonals_[at(a)], diagonals_[at(b)]);
  }
  double ofAll() const {
    return distance_ > 0.0 ? distance_ : share_ * *std::max_element(diagonals_.begin(), diagonals_.end());
  }
  Nearness twice() const {
    Nearness result = *this;
    result.distance_ *= 2.0;
    result.share_ *= 2.0;
    return result;
  }

 private:
  std::vector<double> diagonals_;
  double distance_, share_ = usualNearness;
};

// The boxes around the sides that a rank has of a body.
struct RankBox {
  fem::Box box;
  int rank, body;
};

std::vector<RankBox> boxesOfRanks(const Teuchos::Comm<int>& comm, const std::vector<SideItem>& sides) {
  std::map<int, RankBox> mine;
  for (const SideItem& side : sides) {
    const fem::Box box = boxOf(side);
    const auto [known, isNew] = mine.emplace(side.body, RankBox{box, comm.getRank(), side.body});
    for (std::size_t d = 0; d < 3 && !isNew; ++d) {
      known->second.box.low[d] = std::min(known->second.box.low[d], box.low[d]);
      known->second.box.high[d] = std::max(known->second.box.high[d], box.high[d]);
    }
  }
  std::vector<RankBox> boxes;
  for (const auto& entry : mine)
    boxes.push_back(entry.second);
  return gatherAll(comm, boxes);
}

// The sides of all ranks that are near one of this rank's: of other bodies, or of its own.
std::vector<SideItem> sidesNear(const Teuchos::Comm<int>& comm, const std::vector<SideItem>& mine,
                                const Nearness& nearness, bool isOwn) {
  const std::vector<RankBox> boxes = boxesOfRanks(comm, mine);
  std::vector<std::vector<SideItem>> sends(at(comm.getSize()));
  agree(comm, [&] {
    std::vector<fem::Box> only;
    for (const RankBox& box : boxes)
      only.push_back(box.box);
    const fem::BoxTree tree(only);
    for (const SideItem& side : mine) {
      std::vector<char> isSent(sends.size(), 0);
      for (int k : tree.touching(fem::widened(boxOf(side), nearness.ofAll()))) {
        const RankBox& box = boxes[at(k)];
        if ((box.body == side.body) != isOwn || isSent[at(box.rank)] != 0 ||
            !fem::widened(boxOf(side), nearness.of(side.body, box.body)).touches(box.box))
          continue;
        isSent[at(box.rank)] = 1;
        sends[at(box.rank)].push_back(side);
      }
    }
  });
  std::vector<SideItem> near;
  for (const std::vector<SideItem>& part : exchangeItems(comm, sends))
    near.insert(near.end(), part.begin(), part.end());
  return near;
}

} // namespace

std::vector<double> bodyDiagonals(const Teuchos::Comm<int>& comm, std::size_t bodies,
                                  const std::vector<OwnedSubdomain>& owned) {
  std::vector<double> ends(6 * bodies, -std::numeric_limits<double>::infinity()); // −low, high
  for (const OwnedSubdomain& item : owned)
    for (int node : item.mesh.mesh->boundary) {
      const Point x = item.mesh.position(node);
      double* own = &ends[6 * at(item.body)];
      for (std::size_t d = 0; d < 3; ++d) {
        own[d] = std::max(own[d], -x[d]);
        own[3 + d] = std::max(own[3 + d], x[d]);
      }
    }
  globalMax(comm, ends);
  std::vector<double> diagonals;
  for (std::size_t b = 0; b < bodies; ++b) {
    const double* own = &ends[6 * b];
    diagonals.push_back(norm({own[0] + own[3], own[1] + own[4], own[2] + own[5]}));
  }
  return diagonals;
}

namespace {

// How thick bodies are behind sides, as far as that is less than what matters.
void findThickness(const Teuchos::Comm<int>& comm, std::vector<SideItem>& mine, const Nearness& nearness) {
  const std::vector<SideItem> near = sidesNear(comm, mine, nearness, true);
  agree(comm, [&] {
    std::vector<fem::Box> boxes;
    for (const SideItem& side : near)
      boxes.push_back(boxOf(side));
    const fem::BoxTree tree(std::move(boxes));
    for (SideItem& side : mine)
      for (int place : tree.touching(fem::widened(boxOf(side), nearness.of(side.body, side.body)))) {
        const SideItem& other = near[at(place)];
        if (other.body != side.body || !areOpposite(side, other))
          continue;
        if (const double depth = -gapBetween(side, other); depth > 0.0)
          side.thickness = std::min(side.thickness, depth);
      }
  });
}

// Of a side, the bodies that it faces.
std::vector<int> bodiesFacedBy(const SideItem& side, const std::vector<SideItem>& near,
                               const fem::BoxTree& tree, const Nearness& nearness) {
  const std::vector<int> places = tree.touching(fem::widened(boxOf(side), nearness.ofAll()));
  std::vector<int> found;
  for (int place : places) {
    const SideItem& other = near[at(place)];
    if (other.body == side.body || std::find(found.begin(), found.end(), other.body) != found.end() ||
        !areFacing(side, other, nearness.of(side.body, other.body)))
      continue;
    const bool isHidden = std::any_of(places.begin(), places.end(),
                                      [&](int third) { return isBetween(near[at(third)], side, other); });
    if (!isHidden)
      found.push_back(other.body);
  }
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace

FacedBodies facedBodies(const Teuchos::Comm<int>& comm, std::size_t bodies,
                        const std::vector<OwnedSubdomain>& owned,
                        const std::vector<std::vector<fem::Side>>& sides, double distance) {
  const Nearness nearness(bodyDiagonals(comm, bodies, owned), distance);
  std::vector<SideItem> mine;
  agree(comm, [&] {
    for (std::size_t i = 0; i < owned.size(); ++i)
      for (const fem::Side& side : sides[i])
        mine.push_back(itemOf(owned[i], side));
  });
  // Of overlaps up to the distance, twice that is half of.
  findThickness(comm, mine, nearness.twice());
  const std::vector<SideItem> near = sidesNear(comm, mine, nearness, false);
  FacedBodies faced(owned.size());
  agree(comm, [&] {
    std::vector<fem::Box> boxes;
    for (const SideItem& side : near)
      boxes.push_back(boxOf(side));
    const fem::BoxTree tree(std::move(boxes));
    std::size_t next = 0;
    for (std::size_t i = 0; i < owned.size(); ++i)
      for (std::size_t k = 0; k < sides[i].size(); ++k)
        faced[i].push_back(bodiesFacedBy(mine[next++], near, tree, nearness));
  });
  return faced;
}

std::map<std::pair<int, int>, FacingCounts> facingPairs(const Teuchos::Comm<int>& comm, std::size_t bodies,
                                                        const std::vector<OwnedSubdomain>& owned,
                                                        double distance) {
  struct Count {
    int body, other;
    std::size_t corners;
    long long sides;
  };
  const std::vector<std::vector<fem::Side>> outer = outerSides(comm, owned);
  const FacedBodies faced = facedBodies(comm, bodies, owned, outer, distance);
  std::map<std::tuple<int, int, std::size_t>, long long> mine;
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < outer[i].size(); ++k)
      for (int other : faced[i][k])
        ++mine[{owned[i].body, other, at(fem::shapeOf(owned[i].mesh.mesh->typeOf(outer[i][k])).corners)}];
  std::vector<Count> items;
  for (const auto& [key, sides] : mine)
    items.push_back({std::get<0>(key), std::get<1>(key), std::get<2>(key), sides});
  std::map<std::pair<int, int>, FacingCounts> all;
  for (const Count& item : gatherAll(comm, items)) {
    FacingCounts& counts = all[std::minmax(item.body, item.other)];
    (item.body < item.other ? counts.first : counts.second)[item.corners] += item.sides;
  }
  return all;
}

} // namespace Harmos::scene
