// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FollowingLimits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace Harmos::qp::Kernels {
namespace {

double radiusOf(const FollowingLimit& limit, const double* upper, const LocalDiscs* discs) {
  return limit.isDisc ? discs->discs()[static_cast<std::size_t>(limit.place)].radius
                      : upper[limit.place] - limit.centre;
}

void setRadius(const FollowingLimit& limit, double radius, double* lower, double* upper, LocalDiscs* discs) {
  if (limit.isDisc) {
    discs->setRadius(static_cast<std::size_t>(limit.place), radius);
    return;
  }
  lower[limit.place] = limit.centre - radius;
  upper[limit.place] = limit.centre + radius;
}

} // namespace

void follow(const FollowingLimits& limits, const double* x, const double* g, const FollowUpdate& how,
            double* lower, double* upper, LocalDiscs* discs) {
  for (const FollowingLimit& limit : limits) {
    const int k = limit.source;
    const double moved = g == nullptr ? 0.0 : how.stepLength * g[k];
    const double next = limit.factor * std::max(0.0, x[k] - moved - lower[k]);
    const double last = radiusOf(limit, upper, discs);
    const bool isFirst = !std::isfinite(last);
    setRadius(limit, isFirst || how.share == 1.0 ? next : last + how.share * (next - last), lower, upper,
              discs);
  }
}

FollowChange update(const FollowingLimits& limits, const double* x, const double* g, const double* lower,
                    const double* upper, const LocalDiscs* discs, double stepLength, double gradientNoise,
                    const LocalActiveSet& before, LocalActiveSet& set, std::vector<double>& excess) {
  FollowChange result;
  excess.clear();
  for (const FollowingLimit& limit : limits) {
    double distance = 0.0;
    if (limit.isDisc) {
      const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
      if (set[static_cast<std::size_t>(disc.first)] == LocalActiveSet::slips)
        distance = std::max(0.0, disc.radius - std::hypot(x[disc.first] - disc.centre[0],
                                                          x[disc.second] - disc.centre[1]));
      excess.push_back(std::hypot(x[disc.first] - stepLength * g[disc.first] - disc.centre[0],
                                  x[disc.second] - stepLength * g[disc.second] - disc.centre[1]) -
                       disc.radius);
    } else {
      const int i = limit.place;
      const auto place = static_cast<std::size_t>(i);
      const signed char was = before.empty() ? 0 : before[place], by = set[place];
      const double l = lower[i], u = upper[i], z = x[i] - stepLength * g[i];
      const double noise = stepLength * gradientNoise;
      signed char state = 0;
      if (was != 0 && -was * g[i] > gradientNoise)
        state = was;
      else if (l == u)
        state = z < l ? -1 : 1;
      else
        state = z < l - noise ? -1 : z > u + noise ? 1 : 0;
      set[place] = state;
      result.changed += (state != was) - (by != was);
      result.active += (state != 0) - (by != 0);
      distance = state < 0 ? x[i] - l : state > 0 ? u - x[i] : 0.0;
      excess.push_back(std::max(l - z, z - u));
    }
    result.distance2 += distance * distance;
  }
  return result;
}

namespace {

// Excess by what less of it does for −w: infinite where more is asked for, NaN where it takes no part.
double ratio(const FollowingLimit& limit, const LocalDiscs* discs, double excess, const Imbalance& w,
             const double* lower, const double* upper, const double* x, const LocalActiveSet& set) {
  double inwards = 0.0, radius = 0.0, size = 0.0;
  if (limit.isDisc) {
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
    const double arm[] = {x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]};
    const double length = std::hypot(arm[0], arm[1]);
    radius = disc.radius;
    size = set[static_cast<std::size_t>(disc.first)] == 0
               ? 0.0
               : std::hypot(w.entries[disc.first], w.entries[disc.second]);
    if (set[static_cast<std::size_t>(disc.first)] == LocalActiveSet::slips && length > 0.0)
      inwards = (w.entries[disc.first] * arm[0] + w.entries[disc.second] * arm[1]) / length;
  } else {
    inwards = set[static_cast<std::size_t>(limit.place)] * w.entries[limit.place];
    size = std::abs(inwards);
    radius = 0.5 * (upper[limit.place] - lower[limit.place]);
  }
  if (!(size > w.noise))
    return std::numeric_limits<double>::quiet_NaN();
  return inwards > w.noise && radius > 0.0 ? std::max(0.0, excess) / inwards
                                           : std::numeric_limits<double>::infinity();
}

} // namespace

double leastRatio(const FollowingLimits& limits, const LocalDiscs* discs, const std::vector<double>& excess,
                  const Imbalance& w, const double* lower, const double* upper, const double* x,
                  const LocalActiveSet& set) {
  double result = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < limits.size(); ++k)
    if (const double mine = ratio(limits[k], discs, excess[k], w, lower, upper, x, set); mine < result)
      result = mine;
  return result;
}

long long freeUpTo(const FollowingLimits& limits, const LocalDiscs* discs, const std::vector<double>& excess,
                   const Imbalance& w, double most, const double* lower, const double* upper, const double* x,
                   LocalActiveSet& set) {
  long long freed = 0;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    if (!(ratio(limits[k], discs, excess[k], w, lower, upper, x, set) <= most))
      continue;
    freed += limits[k].isDisc ? 2 : 1;
    if (!limits[k].isDisc) {
      set[static_cast<std::size_t>(limits[k].place)] = 0;
      continue;
    }
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limits[k].place)];
    set[static_cast<std::size_t>(disc.first)] = set[static_cast<std::size_t>(disc.second)] = 0;
  }
  const auto sticks = [&](const Slip& slip) { return set[static_cast<std::size_t>(slip.first)] == 0; };
  set.slipping.erase(std::remove_if(set.slipping.begin(), set.slipping.end(), sticks), set.slipping.end());
  return freed;
}

std::vector<FollowingEntry> followingEntries(const FollowingLimits& limits, const LocalDiscs* discs,
                                             const LocalActiveSet& active) {
  std::vector<FollowingEntry> result;
  std::unordered_map<int, const Slip*> slips;
  for (const Slip& slip : active.slipping)
    slips.emplace(slip.first, &slip);
  for (const FollowingLimit& limit : limits) {
    if (active[static_cast<std::size_t>(limit.source)] != 0)
      continue;
    if (!limit.isDisc) {
      if (const signed char side = active[static_cast<std::size_t>(limit.place)]; side != 0)
        result.push_back(
            {limit.place, -1, {static_cast<double>(side), 0.0}, {limit.centre, 0.0}, limit.source, limit.factor});
      continue;
    }
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
    if (const auto slip = slips.find(disc.first); slip != slips.end())
      result.push_back({disc.first,
                        disc.second,
                        {slip->second->normal[0], slip->second->normal[1]},
                        {disc.centre[0], disc.centre[1]},
                        limit.source,
                        limit.factor});
  }
  return result;
}

void moveToLimits(const FollowingLimits& limits, const double* lower, const double* upper,
                  const LocalDiscs* discs, const LocalActiveSet& active, double* x) {
  for (const FollowingLimit& limit : limits) {
    if (!limit.isDisc) {
      if (const signed char side = active[static_cast<std::size_t>(limit.place)]; side != 0)
        x[limit.place] = side < 0 ? lower[limit.place] : upper[limit.place];
      continue;
    }
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
    const signed char state = active[static_cast<std::size_t>(disc.first)];
    if (state != LocalActiveSet::slips && state != LocalActiveSet::onRim)
      continue;
    const double arm[] = {x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]};
    const double length = std::hypot(arm[0], arm[1]);
    if (!(length > 0.0))
      continue;
    x[disc.first] = disc.centre[0] + disc.radius / length * arm[0];
    x[disc.second] = disc.centre[1] + disc.radius / length * arm[1];
  }
}

void limitsToArray(const FollowingLimits& limits, const double* upper, const LocalDiscs* discs,
                   double* radii) {
  for (const FollowingLimit& limit : limits)
    radii[limit.isDisc ? discs->discs()[static_cast<std::size_t>(limit.place)].first : limit.place] =
        radiusOf(limit, upper, discs);
}

void arrayToLimits(const FollowingLimits& limits, const double* radii, double* lower, double* upper,
                   LocalDiscs* discs) {
  for (const FollowingLimit& limit : limits)
    setRadius(
        limit,
        radii[limit.isDisc ? discs->discs()[static_cast<std::size_t>(limit.place)].first : limit.place],
        lower, upper, discs);
}

} // namespace Harmos::qp::Kernels
