// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseModel.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

namespace {
constexpr double word = 8.0;
}

double coarseFactorEntries(const CoarseShape& shape) {
  const double m = std::max(1.0, shape.motions), subdomains = std::max(2.0, shape.dimension / m);
  if (m > 3.5)
    return m * m * (10.0 * subdomains + 1.5 * std::pow(subdomains, 4.0 / 3.0));
  return m * m * subdomains * (2.0 + 2.0 * std::log2(subdomains));
}

int coarseGroup(const CoarseShape& shape) {
  constexpr double bytesOfRank = 128.0 * 1024.0 * 1024.0;
  constexpr double bytesOfEntry = 16.0; // fronts and workspace beside the factors
  const double ranks = std::ceil(bytesOfEntry * coarseFactorEntries(shape) / bytesOfRank);
  return std::clamp(static_cast<int>(ranks), std::min(2, shape.ranks), shape.ranks);
}

CoarseShape shapeOf(const SubdomainSystem& system) {
  CoarseShape shape;
  shape.dimension = system.kernelDimension();
  shape.motions = shape.dimension / static_cast<double>(std::max(1LL, system.globalSubdomains()));
  shape.ranks = system.comm()->getSize();
  long long own = 0;
  for (int i = 0; i < system.size(); ++i)
    own += system.kernel(i).columns;
  shape.mostOwn = static_cast<double>(globalMax(*system.comm(), own));
  return shape;
}

double replicatedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates) {
  constexpr double inCache = 5e5;
  const double tree = 2.0 * std::log2(shape.ranks) * rates.latency;
  const double transfer = shape.ranks > 1 ? 2.0 * word * shape.dimension / rates.bandwidth : 0.0;
  const double entries = shape.factorEntries > 0.0 ? shape.factorEntries : coarseFactorEntries(shape);
  return 4.0 * (tree + transfer) +
         7.0 * entries / (entries < inCache ? rates.coarseEntries : rates.coarseFromMemory);
}

double distributedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates) {
  const bool several = shape.ranks > 1;
  const double tree = std::log2(shape.ranks) * rates.latency;
  const double transfer = several ? word * shape.dimension / rates.bandwidth : 0.0;
  const double neighbours = several ? 4.0 * rates.latency : 0.0;
  return 4.0 * (tree + transfer + word * shape.dimension * shape.mostOwn / rates.readBytes + neighbours);
}

bool isDistributedCheaper(const CoarseShape& shape, const CoarseRates& rates) {
  constexpr int fewestRanks = 8;     // below, set-up takes longer than it saves
  constexpr double worthWhile = 0.5; // models are no better than that
  return shape.ranks >= fewestRanks &&
         distributedCoarseSeconds(shape, rates) < worthWhile * replicatedCoarseSeconds(shape, rates);
}

bool coarseSolves(const CoarseShape& shape, int groupSize, bool isFace) {
  constexpr double mostBytes = 512.0 * 1024.0 * 1024.0;
  constexpr double mostColumns = 512.0; // as many as the solves of a face, some thirty, in blocks of 32
  if (8.0 * shape.dimension * shape.mostOwn > mostBytes)
    return true;
  return isFace && shape.mostOwn * groupSize > mostColumns;
}

} // namespace Harmos::feti
