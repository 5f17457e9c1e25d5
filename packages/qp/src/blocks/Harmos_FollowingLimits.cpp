// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FollowingLimits.hpp"

#include <algorithm>
#include <cmath>
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

void update(const FollowingLimits& limits, const double* x, const double* g, const double* lower,
            const double* upper, const LocalDiscs* discs, const FaceUpdate& how, const ActiveFace& before,
            ActiveFace& face, FaceTally& tally) {
  for (const FollowingLimit& limit : limits) {
    double distance = 0.0;
    if (limit.isDisc) {
      const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
      if (face[static_cast<std::size_t>(disc.first)] == ActiveFace::slips)
        distance = std::max(
            0.0, disc.radius - std::hypot(x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]));
    } else {
      const int i = limit.place;
      const auto place = static_cast<std::size_t>(i);
      const signed char was = before[place];
      const double l = lower[i], u = upper[i], z = x[i] - how.stepLength * g[i];
      const double noise = how.stepLength * how.gradientNoise;
      signed char state = 0;
      if (was != 0 && -was * g[i] > how.gradientNoise)
        state = was;
      else if (l == u)
        state = was != 0 ? was : z < l ? -1 : 1;
      else
        state = z < l - noise ? -1 : z > u + noise ? 1 : 0;
      face[place] = state;
      distance = state < 0 ? x[i] - l : state > 0 ? u - x[i] : 0.0;
    }
    tally.distance2 += distance * distance;
  }
}

std::vector<Coupling> couplings(const FollowingLimits& limits, const LocalDiscs* discs,
                                const ActiveFace& active) {
  std::vector<Coupling> result;
  std::unordered_map<int, const Slip*> slips;
  for (const Slip& slip : active.slipping)
    slips.emplace(slip.first, &slip);
  for (const FollowingLimit& limit : limits) {
    if (active[static_cast<std::size_t>(limit.source)] != 0)
      continue;
    if (!limit.isDisc) {
      if (const signed char side = active[static_cast<std::size_t>(limit.place)]; side != 0)
        result.push_back({limit.place,
                          -1,
                          {static_cast<double>(side), 0.0},
                          {limit.centre, 0.0},
                          limit.source,
                          limit.factor});
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

void leaveOut(const FollowingLimits& limits, const LocalDiscs* discs, ActiveFace& active) {
  for (const FollowingLimit& limit : limits) {
    if (!limit.isDisc) {
      active[static_cast<std::size_t>(limit.place)] = 0;
      continue;
    }
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
    for (int entry : {disc.first, disc.second})
      active[static_cast<std::size_t>(entry)] = 0;
    active.slipping.erase(std::remove_if(active.slipping.begin(), active.slipping.end(),
                                         [&](const Slip& slip) { return slip.first == disc.first; }),
                          active.slipping.end());
  }
}

void moveToFollowing(const std::vector<Coupling>& couplings, const double* lower, double* x) {
  for (const Coupling& entry : couplings) {
    const double radius = entry.factor * std::max(0.0, x[entry.source] - lower[entry.source]);
    if (entry.second < 0) {
      x[entry.first] = entry.centre[0] + radius * entry.along[0];
      continue;
    }
    const double tangent = -entry.along[1] * (x[entry.first] - entry.centre[0]) +
                           entry.along[0] * (x[entry.second] - entry.centre[1]);
    x[entry.first] = entry.centre[0] + radius * entry.along[0] - tangent * entry.along[1];
    x[entry.second] = entry.centre[1] + radius * entry.along[1] + tangent * entry.along[0];
  }
}

void moveToLimits(const FollowingLimits& limits, const double* lower, const double* upper,
                  const LocalDiscs* discs, const ActiveFace& active, double* x) {
  for (const FollowingLimit& limit : limits) {
    if (!limit.isDisc) {
      if (const signed char side = active[static_cast<std::size_t>(limit.place)]; side != 0)
        x[limit.place] = side < 0 ? lower[limit.place] : upper[limit.place];
      continue;
    }
    const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
    const signed char state = active[static_cast<std::size_t>(disc.first)];
    if (state != ActiveFace::slips && state != ActiveFace::onRim)
      continue;
    const double arm[] = {x[disc.first] - disc.centre[0], x[disc.second] - disc.centre[1]};
    const double length = std::hypot(arm[0], arm[1]);
    if (!(length > 0.0))
      continue;
    x[disc.first] = disc.centre[0] + disc.radius / length * arm[0];
    x[disc.second] = disc.centre[1] + disc.radius / length * arm[1];
  }
}

namespace {

// First, second entry (−1 for intervals), centre.
struct Followers {
  int first, second;
  double centre[2];
};

Followers followersOf(const FollowingLimit& limit, const LocalDiscs* discs) {
  if (!limit.isDisc)
    return {limit.place, -1, {limit.centre, 0.0}};
  const Disc& disc = discs->discs()[static_cast<std::size_t>(limit.place)];
  return {disc.first, disc.second, {disc.centre[0], disc.centre[1]}};
}

} // namespace

Cones conesOf(const FollowingLimits& limits, const double* x, const LocalDiscs* discs) {
  Cones result;
  for (const FollowingLimit& limit : limits) {
    const Followers entries = followersOf(limit, discs);
    result.push_back({x[limit.source], {x[entries.first], entries.second < 0 ? 0.0 : x[entries.second]}});
  }
  return result;
}

// Of (n, t) with |t| > fn: n' = (n + f|t|)/(1 + f²), t' = fn't/|t|; the apex where that is below zero.
void projectOntoCones(const Cones& points, const FollowingLimits& limits, const double* lower,
                      const LocalDiscs* discs, double* x) {
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const FollowingLimit& limit = limits[k];
    const Followers entries = followersOf(limit, discs);
    const double bound = lower[limit.source], f = limit.factor, n = points[k].source - bound;
    double arm[] = {points[k].arm[0] - entries.centre[0],
                    entries.second < 0 ? 0.0 : points[k].arm[1] - entries.centre[1]};
    const double length = std::hypot(arm[0], arm[1]);
    double height = n;
    if (length > f * n || n < 0.0) { // the second where f is zero
      height = std::max(0.0, (n + f * length) / (1.0 + f * f));
      for (double& part : arm)
        part *= length > 0.0 ? f * height / length : 0.0;
    }
    x[limit.source] = bound + height;
    x[entries.first] = entries.centre[0] + arm[0];
    if (entries.second >= 0)
      x[entries.second] = entries.centre[1] + arm[1];
  }
}

void takeConeInfimum(const FollowingLimits& limits, const double* lower, const LocalDiscs* discs, double* w,
                     double* sums) {
  for (const FollowingLimit& limit : limits) {
    const Followers entries = followersOf(limit, discs);
    const double arm[] = {w[entries.first], entries.second < 0 ? 0.0 : w[entries.second]};
    const double open = std::max(0.0, limit.factor * std::hypot(arm[0], arm[1]) - w[limit.source]);
    const double corner[] = {lower[limit.source], entries.centre[0], entries.centre[1]};
    sums[0] += w[limit.source] * corner[0] + arm[0] * corner[1] + arm[1] * corner[2];
    sums[1] += open * open;
    sums[2] += corner[0] * corner[0] + corner[1] * corner[1] + corner[2] * corner[2];
    w[limit.source] = w[entries.first] = 0.0;
    if (entries.second >= 0)
      w[entries.second] = 0.0;
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
    setRadius(limit,
              radii[limit.isDisc ? discs->discs()[static_cast<std::size_t>(limit.place)].first : limit.place],
              lower, upper, discs);
}

} // namespace Harmos::qp::Kernels
