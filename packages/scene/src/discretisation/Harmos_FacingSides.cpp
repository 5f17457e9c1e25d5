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

namespace Harmos::scene {
namespace {

using fem::Point;

// A side as it goes from rank to rank.
struct SideItem {
  std::array<Point, 4> corners;
  Point middle, normal;
  int count; // of corners
  int body;
};

SideItem itemOf(const OwnedSubdomain& owner, const fem::Side& side) {
  const fem::SideGeometry geometry = fem::geometryOf(owner.mesh, side);
  SideItem item{};
  item.count = static_cast<int>(geometry.corners.size());
  std::copy(geometry.corners.begin(), geometry.corners.end(), item.corners.begin());
  item.middle = geometry.middle;
  item.normal = geometry.normal;
  item.body = owner.body;
  return item;
}

fem::Box boxOf(const SideItem& side) {
  return fem::boxAround({side.corners.begin(), side.corners.begin() + side.count});
}

// Of the corners around the middle.
double radiusOf(const SideItem& side) {
  double radius = 0.0;
  for (int k = 0; k < side.count; ++k)
    radius = std::max(radius, norm(difference(side.corners[at(k)], side.middle)));
  return radius;
}

// How far the corners of another side are above this one along its normal: the least, 0 where they are on
// both sides of it.
double heightAbove(const SideItem& side, const SideItem& other) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int k = 0; k < other.count; ++k) {
    const double height = dot(difference(other.corners[at(k)], side.middle), side.normal);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return low > 0.0 ? low : high < 0.0 ? -high : 0.0;
}

bool areFacing(const SideItem& a, const SideItem& b, double distance) {
  constexpr double leastOpposed = 0.5; // 60 degrees
  if (dot(a.normal, b.normal) > -leastOpposed)
    return false;
  const Point between = difference(b.middle, a.middle);
  const double along = dot(between, a.normal);
  if (norm(difference(between, scaled(along, a.normal))) > radiusOf(a) + radiusOf(b))
    return false;
  return std::min(heightAbove(a, b), heightAbove(b, a)) <= distance;
}

// The distance of each pair of bodies.
class Nearness {
 public:
  Nearness(std::vector<double> diagonals, double distance)
      : diagonals_(std::move(diagonals)), distance_(distance) {}

  double of(int a, int b) const {
    return distance_ > 0.0 ? distance_ : usualNearness * std::min(diagonals_[at(a)], diagonals_[at(b)]);
  }
  double ofAll() const {
    return distance_ > 0.0 ? distance_
                           : usualNearness * *std::max_element(diagonals_.begin(), diagonals_.end());
  }

 private:
  std::vector<double> diagonals_;
  double distance_;
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

// The sides of all ranks that may face one of this rank's.
std::vector<SideItem> sidesNear(const Teuchos::Comm<int>& comm, const std::vector<SideItem>& mine,
                                const Nearness& nearness) {
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
        if (box.body == side.body || isSent[at(box.rank)] != 0 ||
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
  const std::vector<SideItem> near = sidesNear(comm, mine, nearness);
  FacedBodies faced(owned.size());
  agree(comm, [&] {
    std::vector<fem::Box> boxes;
    for (const SideItem& side : near)
      boxes.push_back(boxOf(side));
    const fem::BoxTree tree(std::move(boxes));
    std::size_t next = 0;
    for (std::size_t i = 0; i < owned.size(); ++i)
      for (std::size_t k = 0; k < sides[i].size(); ++k) {
        const SideItem& side = mine[next++];
        std::vector<int>& found = faced[i].emplace_back();
        for (int place : tree.touching(fem::widened(boxOf(side), nearness.ofAll()))) {
          const SideItem& other = near[at(place)];
          if (other.body != side.body && std::find(found.begin(), found.end(), other.body) == found.end() &&
              areFacing(side, other, nearness.of(side.body, other.body)))
            found.push_back(other.body);
        }
        std::sort(found.begin(), found.end());
      }
  });
  return faced;
}

std::map<std::pair<int, int>, std::pair<long long, long long>>
facingPairs(const Teuchos::Comm<int>& comm, std::size_t bodies, const std::vector<OwnedSubdomain>& owned,
            double distance) {
  struct Count {
    int first, second; // bodies
    long long ofFirst, ofSecond;
  };
  const std::vector<std::vector<fem::Side>> outer = outerSides(comm, owned);
  std::map<std::pair<int, int>, std::pair<long long, long long>> mine, all;
  const FacedBodies faced = facedBodies(comm, bodies, owned, outer, distance);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (const std::vector<int>& others : faced[i])
      for (int other : others) {
        const int own = owned[i].body;
        auto& counts = mine[{std::min(own, other), std::max(own, other)}];
        (own < other ? counts.first : counts.second) += 1;
      }
  std::vector<Count> items;
  for (const auto& [pair, counts] : mine)
    items.push_back({pair.first, pair.second, counts.first, counts.second});
  for (const Count& item : gatherAll(comm, items)) {
    auto& counts = all[{item.first, item.second}];
    counts.first += item.ofFirst;
    counts.second += item.ofSecond;
  }
  return all;
}

} // namespace Harmos::scene
