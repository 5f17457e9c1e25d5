// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterModel.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace Harmos::feti {

double growthOfProducts(double clusterSize, bool isInSpace, double aspect) {
  using Growth = ProductGrowth;
  const double side = std::pow(std::max(1.0, clusterSize), isInSpace ? 1.0 / 3.0 : 0.5);
  return 1.0 + (isInSpace ? Growth::space : Growth::plane) * std::log2(side) +
         (isInSpace ? Growth::slenderInSpace : Growth::slenderInPlane) * (std::max(1.0, aspect) - 1.0);
}

ShareSides sidesOf(const std::vector<std::array<double, 3>>& centres, bool isInSpace) {
  if (centres.size() < 2)
    return {};
  std::array<double, 3> low = centres.front(), high = low;
  for (const auto& centre : centres)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], centre[d]);
      high[d] = std::max(high[d], centre[d]);
    }
  std::array<double, 3> sides{};
  for (std::size_t d = 0; d < 3; ++d)
    sides[d] = high[d] - low[d];
  std::sort(sides.begin(), sides.end(), std::greater<>());
  const std::size_t dimension = isInSpace ? 3 : 2;
  const auto count = static_cast<double>(centres.size());
  // 1/h, for which the box is as full as it is; a chain of all of them has the largest one.
  double least = 0.0, most = sides[0] > 0.0 ? (count - 1.0) / sides[0] : 0.0;
  constexpr int halvings = 50; // to the last digit
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (least + most);
    double product = 1.0;
    for (std::size_t d = 0; d < dimension; ++d)
      product *= sides[d] * middle + 1.0;
    (product < count ? least : most) = middle;
  }
  return {sides[0] * most + 1.0, sides[dimension - 1] * most + 1.0};
}

double aspectOfClusters(const ShareSides& share, double subdomains, double clusters, bool isInSpace) {
  std::vector<double> sides = {share.longest, share.shortest};
  if (isInSpace)
    sides.push_back(std::clamp(subdomains / (share.longest * share.shortest), share.shortest, share.longest));
  for (double parts = clusters; parts > 1.0; parts *= 0.5) {
    double& longest = *std::max_element(sides.begin(), sides.end());
    longest = std::max(1.0, longest / std::min(2.0, parts));
  }
  return *std::max_element(sides.begin(), sides.end()) / *std::min_element(sides.begin(), sides.end());
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
