// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepModel.hpp"

#include "Harmos_StepCalls.hpp"

#include <cmath>

namespace Harmos::feti {

namespace {
constexpr double number = 8.0;
}

CoarseShape StepShape::coarse() const {
  CoarseShape shape;
  shape.dimension = coarseDimension;
  shape.motions = motions;
  shape.ranks = ranks;
  shape.mostOwn = ownMotions;
  shape.factorEntries = coarseEntries;
  shape.neighbours = neighbours;
  return shape;
}

StepSeconds predictStep(const StepShape& shape, const StepRates& rates) {
  constexpr double passes = 40.0;
  const StepCalls& calls = callsOf(shape.isCoarseDistributed);
  const double tree = 2.0 * std::log2(shape.ranks) * rates.latency;
  StepSeconds step;
  step.vectors = passes * number * shape.rows / rates.readBytes + rates.overhead;
  if (shape.ranks > 1)
    step.exchange =
        calls.exchanges * (shape.neighbours * rates.latency + number * shape.sharedRows / rates.bandwidth);
  step.reductions = calls.reductions * tree;
  step.coarse = shape.isCoarseDistributed ? distributedCoarseSeconds(shape.coarse(), rates)
                                          : replicatedCoarseSeconds(shape.coarse(), rates);
  step.joins = shape.joinBytes / rates.readBytes + shape.joinEntries / rates.coarseEntries;
  return step;
}

StepCounts predictCounts(const StepShape& shape) {
  StepCounts counts;
  if (shape.ranks == 1)
    return counts;
  const StepCalls& calls = callsOf(shape.isCoarseDistributed);
  counts.messages = 0.5 * (calls.exchanges + calls.coarseExchanges) * shape.neighbours;
  counts.messageBytes =
      0.5 * number * (calls.exchanges * shape.sharedRows + calls.coarseExchanges * shape.sharedMotions);
  counts.reductions = calls.reductions + (shape.isCoarseDistributed ? 0.0 : calls.coarseVectors);
  counts.gathers = shape.isCoarseDistributed ? calls.coarseVectors : 0.0;
  const double numbers = calls.reducedNumbers * (shape.isCoarseDistributed ? shape.ranks : 1);
  counts.collectiveBytes = number * (calls.coarseVectors * shape.coarseDimension + numbers);
  return counts;
}

} // namespace Harmos::feti
