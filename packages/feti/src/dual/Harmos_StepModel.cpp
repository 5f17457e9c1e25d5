// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepModel.hpp"

#include <cmath>

namespace Harmos::feti {

StepSeconds predictStep(const StepShape& shape, const StepRates& rates) {
  constexpr double passes = 40.0, word = 8.0;
  const bool several = shape.ranks > 1;
  const double tree = 2.0 * std::log2(shape.ranks) * rates.latency;
  StepSeconds step;
  step.vectors = passes * word * shape.rows / rates.readBytes + rates.overhead;
  if (several)
    step.exchange = 4.0 * (shape.neighbours * rates.latency + word * shape.sharedRows / rates.bandwidth);
  step.reductions = 2.0 * tree;
  CoarseShape coarse;
  coarse.dimension = shape.coarseDimension;
  coarse.ranks = shape.ranks;
  coarse.mostOwn = shape.ownMotions;
  coarse.factorEntries = shape.coarseEntries;
  step.coarse = shape.isCoarseDistributed ? distributedCoarseSeconds(coarse, rates)
                                          : replicatedCoarseSeconds(coarse, rates);
  return step;
}

} // namespace Harmos::feti
