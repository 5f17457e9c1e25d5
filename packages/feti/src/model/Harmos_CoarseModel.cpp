// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseModel.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_RigidMotions.hpp"
#include "Harmos_StepCalls.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

namespace {

constexpr double word = 8.0;
constexpr double bytesOfEntry = 16.0; // with fronts and workspace beside factors

double entriesOf(const CoarseShape& shape) {
  return shape.factorEntries > 0.0 ? shape.factorEntries : coarseFactorEntries(shape);
}

} // namespace

double coarseFactorEntries(const CoarseShape& shape) {
  const double n = shape.dimension;
  if (n <= mostDenseCoarseRows)
    return 0.5 * n * (n + 1.0);
  const double m = std::max(1.0, shape.motions), subdomains = std::max(2.0, n / m);
  if (shape.isInSpace()) {
    const double x = std::cbrt(subdomains);
    return m * m * subdomains * (x < 6.0 ? 0.8 * x * x : 9.6 * (x - 3.0));
  }
  const double levels = std::log2(subdomains);
  const double joined = m < 1.5 ? 4.3 : 0.0; // zeros in fronts of few columns that are one
  return m * m * subdomains * std::max(3.6 * levels - 15.5 + joined, 1.35 * levels);
}

double likelyNeighbours(const CoarseShape& shape) {
  return std::min(shape.isInSpace() ? 26.0 : 8.0, shape.ranks - 1.0);
}

int coarseGroup(const CoarseShape& shape) {
  constexpr double bytesOfRank = 128.0 * 1024.0 * 1024.0;
  const double ranks = std::ceil(bytesOfEntry * entriesOf(shape) / bytesOfRank);
  return static_cast<int>(std::clamp(ranks, std::min(2.0, 1.0 * shape.ranks), 1.0 * shape.ranks));
}

CoarseShape shapeOf(const RigidMotions& motions) {
  const Teuchos::Comm<int>& comm = *motions.system().comm();
  CoarseShape shape;
  shape.dimension = motions.dimension();
  shape.motions = shape.dimension / static_cast<double>(std::max(1LL, motions.totalParts()));
  shape.ranks = comm.getSize();
  const auto own = static_cast<long long>(motions.ownColumns().size());
  shape.mostOwn = static_cast<double>(globalMax(comm, own));
  return shape;
}

double replicatedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates) {
  constexpr double inCache = 5e5;
  constexpr StepCalls calls = replicatedCalls;
  const double tree = 2.0 * std::log2(shape.ranks) * rates.latency;
  const double transfer = shape.ranks > 1 ? 2.0 * word * shape.dimension / rates.bandwidth : 0.0;
  const double entries = entriesOf(shape);
  return calls.coarseVectors * (tree + transfer) +
         calls.coarseSolves * entries / (entries < inCache ? rates.coarseEntries : rates.coarseFromMemory);
}

double distributedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates) {
  constexpr StepCalls calls = distributedCalls;
  const bool several = shape.ranks > 1;
  const double tree = std::log2(shape.ranks) * rates.latency;
  const double gathered = calls.coarseVectors * shape.dimension + calls.reducedNumbers * shape.ranks;
  const double transfer = several ? word * gathered / rates.bandwidth : 0.0;
  const double neighbours = shape.neighbours < 0.0 ? likelyNeighbours(shape) : shape.neighbours;
  const int group = coarseGroup(shape);
  const double solve = coarseSolves(shape, group, false)
                           ? 2.0 * entriesOf(shape) / (rates.coarseFromMemory * std::sqrt(group))
                           : word * shape.dimension * shape.mostOwn / rates.readBytes;
  return calls.coarseVectors * tree + transfer + calls.coarseSolves * solve +
         (several ? calls.coarseExchanges * neighbours * rates.latency : 0.0);
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

double coarseBytes(const CoarseShape& shape, bool isDistributed) {
  if (!isDistributed)
    return bytesOfEntry * entriesOf(shape);
  const int group = coarseGroup(shape);
  return coarseSolves(shape, group, false) ? bytesOfEntry * entriesOf(shape) / group
                                           : word * shape.dimension * shape.mostOwn;
}

double coarseBytesOfSetup(const CoarseShape& shape, bool isDistributed) {
  return isDistributed ? bytesOfEntry * entriesOf(shape) / coarseGroup(shape) : 0.0;
}

double coarseSetupSeconds(const CoarseShape& shape, bool isDistributed, bool isFace, double factorization,
                          const CoarseRates& rates) {
  const int group = coarseGroup(shape);
  if (!isDistributed || coarseSolves(shape, group, isFace))
    return factorization;
  return factorization +
         shape.mostOwn * group * 2.0 * entriesOf(shape) / (rates.coarseEntries * std::sqrt(group));
}

} // namespace Harmos::feti
