// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DistinctPoints.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GlobalOrder.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>

namespace Harmos::scene {

using contact::ContactPoint;

void DistinctPoints::add(const std::vector<ContactPoint>& more, const Effect& effect) {
  for (const ContactPoint& point : more) {
    all_.push_back(point);
    effects_.push_back({batches_.size()});
  }
  batches_.push_back(&effect);
}

namespace {

// Of points that came from all ranks, in the order in which their effects gave them.
struct Arrival {
  std::size_t batch, rank, place;
  const ContactPoint* point;
};

using Places = std::vector<std::vector<std::array<std::size_t, 2>>>; // batch, and place on its rank

std::vector<Arrival> inOrder(const std::vector<std::vector<ContactPoint>>& points, const Places& places) {
  std::vector<Arrival> arrivals;
  for (std::size_t r = 0; r < points.size(); ++r)
    for (std::size_t k = 0; k < points[r].size(); ++k)
      arrivals.push_back({places[r][k][0], r, places[r][k][1], &points[r][k]});
  std::sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) {
    return std::tie(a.batch, a.point->node, a.rank, a.place) <
           std::tie(b.batch, b.point->node, b.rank, b.place);
  });
  return arrivals;
}

// What a rank is told of a point of its own: that it is kept, or, with a gap of no meaning, of one more
// effect.
struct Verdict {
  std::size_t point, batch;
  double gap;
  bool isFirst;
};

} // namespace

std::vector<DistinctPoints::Kept> DistinctPoints::distinct(const Teuchos::Comm<int>& comm) const {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<ContactPoint>> points(ranks);
  Places places(ranks);
  agree(comm, [&] {
    for (std::size_t k = 0; k < all_.size(); ++k) {
      const std::size_t home = homeOf(all_[k].terms.front().node, comm);
      points[home].push_back(all_[k]);
      places[home].push_back({effects_[k].front(), k});
    }
  });
  points = contact::exchangePoints(comm, points);
  places = exchangeItems(comm, places);
  std::vector<std::vector<Verdict>> verdicts(ranks);
  agree(comm, [&] {
    const std::vector<Arrival> arrivals = inOrder(points, places);
    struct Survivor {
      const Arrival* first;
      std::size_t verdict; // of its rank
    };
    std::unordered_map<long long, std::vector<Survivor>> withNode; // by the lowest node
    for (const Arrival& item : arrivals) {
      std::vector<Survivor>& here = withNode[item.point->terms.front().node];
      const auto twin = std::find_if(here.begin(), here.end(), [&](const Survivor& survivor) {
        return sameRow(*survivor.first->point, *item.point);
      });
      if (twin == here.end()) {
        here.push_back({&item, verdicts[item.rank].size()});
        verdicts[item.rank].push_back({item.place, item.batch, item.point->gap, true});
        continue;
      }
      const Arrival& first = *twin->first;
      double& gap = verdicts[first.rank][twin->verdict].gap;
      if (std::isnan(item.point->gap) || item.point->gap < gap) // a NaN is kept, to be refused
        gap = item.point->gap;
      if (batches_[first.batch] != batches_[item.batch])
        verdicts[first.rank].push_back({first.place, item.batch, 0.0, false});
    }
  });
  std::map<std::size_t, Kept> kept;
  for (const std::vector<Verdict>& part : exchangeItems(comm, verdicts))
    for (const Verdict& verdict : part) {
      Kept& point = kept[verdict.point];
      point.point = verdict.point;
      point.batches.push_back(verdict.batch);
      if (verdict.isFirst)
        point.gap = verdict.gap;
    }
  std::vector<Kept> result;
  for (auto& [place, point] : kept)
    result.push_back(std::move(point));
  return result;
}

void DistinctPoints::finish(const Teuchos::Comm<int>& comm) {
  std::vector<Kept> kept = distinct(comm);
  const auto keyOf = [&](const Kept& point) {
    return OrderKey{static_cast<long long>(point.batches.front()), all_[point.point].node};
  };
  std::stable_sort(kept.begin(), kept.end(),
                   [&](const Kept& a, const Kept& b) { return keyOf(a) < keyOf(b); });
  std::vector<OrderKey> keys;
  std::vector<ContactPoint> points;
  effects_.clear();
  for (Kept& point : kept) {
    keys.push_back(keyOf(point));
    points.push_back(std::move(all_[point.point]));
    points.back().gap = point.gap;
    effects_.push_back(std::move(point.batches));
  }
  const std::vector<long long> numbers = sumsBefore(comm, keys, std::vector<long long>(keys.size(), 1));
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k].number = numbers[k];
  all_ = std::move(points);
  numberPressures(comm);
  count_ = globalSum(comm, static_cast<long long>(all_.size()));
}

// Terms of pressures name points of the same effect by node and side. Where one of them is another effect's,
// and goes by that one's node, the force of the row per area is what is left.
void DistinctPoints::numberPressures(const Teuchos::Comm<int>& comm) {
  const auto keyOf = [this](long long node, int side, std::size_t batch) {
    constexpr long long mostSides = 64;
    return (node * mostSides + side) * static_cast<long long>(batches_.size()) +
           static_cast<long long>(batch);
  };
  std::vector<std::pair<long long, long long>> known;
  std::vector<long long> asked;
  for (std::size_t k = 0; k < all_.size(); ++k) {
    for (const std::size_t batch : effects_[k])
      known.emplace_back(keyOf(all_[k].node, all_[k].side, batch), all_[k].number);
    for (const ContactPoint::PressureTerm& term : all_[k].pressure)
      asked.push_back(keyOf(term.node, term.side, effects_[k].front()));
  }
  if (globalMax(comm, static_cast<long long>(asked.size())) == 0)
    return;
  const std::vector<std::optional<long long>> numbers = lookUp(comm, known, asked);
  std::size_t next = 0;
  for (ContactPoint& point : all_) {
    bool isComplete = true;
    for (ContactPoint::PressureTerm& term : point.pressure) {
      term.number = numbers[next].value_or(-1);
      isComplete = isComplete && numbers[next++].has_value();
    }
    if (!isComplete)
      point.pressure.clear();
  }
}

std::vector<const Effect*> DistinctPoints::effectsAt(std::size_t point) const {
  std::vector<const Effect*> result;
  for (std::size_t batch : effects_[point])
    result.push_back(batches_[batch]);
  return result;
}

bool DistinctPoints::sameRow(const ContactPoint& a, const ContactPoint& b) const {
  constexpr double rounding = 1e-12;
  if (a.terms.size() != b.terms.size())
    return false;
  for (double sign : {1.0, -1.0}) {
    bool same = true;
    for (std::size_t d = 0; d < 3 && normalsMatter_; ++d)
      same = same && std::abs(a.normal[d] - sign * b.normal[d]) <= rounding;
    for (std::size_t k = 0; same && k < a.terms.size(); ++k)
      same = a.terms[k].node == b.terms[k].node &&
             std::abs(a.terms[k].weight - sign * b.terms[k].weight) <= rounding;
    if (same)
      return true;
  }
  return false;
}

} // namespace Harmos::scene
