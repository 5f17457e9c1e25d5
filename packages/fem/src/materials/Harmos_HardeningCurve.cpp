// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_HardeningCurve.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {

HardeningCurve::HardeningCurve(std::vector<double> strains, std::vector<double> stresses, double slope)
    : strains_(std::move(strains)), stresses_(std::move(stresses)), slope_(slope) {}

// The one that begins at or before a strain.
std::size_t HardeningCurve::segmentOf(double strain) const {
  const auto after = std::upper_bound(strains_.begin() + 1, strains_.end(), strain);
  return static_cast<std::size_t>(after - strains_.begin()) - 1;
}

double HardeningCurve::slopeOf(std::size_t segment) const {
  return segment + 1 == strains_.size()
             ? slope_
             : (stresses_[segment + 1] - stresses_[segment]) / (strains_[segment + 1] - strains_[segment]);
}

double HardeningCurve::stress(double strain) const {
  const std::size_t k = segmentOf(strain);
  return stresses_[k] + slopeOf(k) * (strain - strains_[k]);
}

double HardeningCurve::work(double strain) const {
  const std::size_t last = segmentOf(strain);
  double sum = 0.0;
  for (std::size_t k = 0; k < last; ++k)
    sum += 0.5 * (stresses_[k] + stresses_[k + 1]) * (strains_[k + 1] - strains_[k]);
  return sum + 0.5 * (stresses_[last] + stress(strain)) * (strain - strains_[last]);
}

HardeningCurve::Flow HardeningCurve::flow(double strain, double a, double b) const {
  const double root = std::sqrt(2.0 / 3.0);
  double amount = 0.0, reached = strain;
  for (std::size_t k = segmentOf(strain);; ++k) {
    const double slope = slopeOf(k);
    const double more = (a - b * amount - root * stress(reached)) / (b + root * root * slope);
    if (k + 1 == strains_.size() || reached + root * more <= strains_[k + 1])
      return {amount + more, slope};
    amount += (strains_[k + 1] - reached) / root;
    reached = strains_[k + 1];
  }
}

} // namespace Harmos::fem
