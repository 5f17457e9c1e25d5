// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterModel.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

double growthOfProducts(double clusterSize, bool isInSpace) {
  const double side = std::pow(std::max(1.0, clusterSize), isInSpace ? 1.0 / 3.0 : 0.5);
  return 1.0 + (isInSpace ? ProductGrowth::space : ProductGrowth::plane) * (side - 1.0);
}

JoinCosts joinCosts(const ClusterShape& clusters) {
  constexpr double word = 8.0, atOnce = 6.0; // vectors
  JoinCosts costs;
  const double m = clusters.size, r = clusters.motions;
  if (!(m > 1.0) || clusters.subdomains <= 0.0)
    return costs;
  const double d = clusters.isInSpace() ? 3.0 : 2.0;
  const double faces = d * (m - std::pow(m, (d - 1.0) / d));
  const double number = clusters.subdomains / m;
  const bool isShared = clusters.distinct < clusters.subdomains;
  const double joined = r * (isShared ? std::min(2.0 * d, 2.0 * faces) : 2.0 * faces / m);
  const double w = word * clusters.boundary * (2.0 * joined + r) * clusters.distinct;
  const double readings = std::max(1.0, clusters.subdomains / (atOnce * clusters.distinct));
  const double ofMotions = 0.5 * word * r * m * (r * m + 1.0); // S₀⁺, packed
  CoarseShape f0;
  f0.dimension = costs.averages = r * faces;
  f0.motions = r;
  const double entries = coarseFactorEntries(f0);
  costs.bytesRead = 2.0 * w * readings + number * ofMotions;
  costs.entries = 6.0 * number * entries;
  costs.bytesHeld = w + number * (32.0 * entries + ofMotions);
  return costs;
}

StepShape withClusters(const StepShape& step, const ClusterShape& clusters) {
  if (!(clusters.size > 1.0))
    return step;
  StepShape result = step;
  const double d = clusters.isInSpace() ? 3.0 : 2.0;
  const double number = clusters.subdomains / clusters.size;
  result.coarseDimension = step.coarseDimension * clusters.share;
  result.coarseEntries = 0.0;
  result.ownMotions = step.ownMotions / clusters.size;
  if (step.ranks > 1)
    result.sharedMotions = step.motions * (std::pow(std::pow(number, 1.0 / d) + 2.0, d) - number);
  const JoinCosts costs = joinCosts(clusters);
  result.clusterSize = clusters.size;
  result.joinBytes = costs.bytesRead;
  result.joinEntries = costs.entries;
  return result;
}

} // namespace Harmos::feti
