// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseOptions.hpp"

#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_ReplicatedCoarse.hpp"

#include <algorithm>

namespace Harmos::feti {

bool takesDistributed(const CoarseOptions& options, const CoarseShape& shape) {
  using Form = CoarseOptions::Form;
  return options.form == Form::Distributed ||
         (options.form == Form::Auto && isDistributedCheaper(shape, options.rates));
}

std::unique_ptr<CoarseSpace> makeCoarseSpace(const RigidMotions& motions, const Constraints& constraints,
                                             const CoarseOptions& options) {
  using Form = CoarseOptions::Form;
  if (options.form == Form::Distributed)
    return std::make_unique<DistributedCoarse>(motions, constraints, options);
  if (options.form == Form::Auto && takesDistributed(options, shapeOf(motions))) {
    try {
      return std::make_unique<DistributedCoarse>(motions, constraints, options);
    } catch (const NumericalError&) { // on all ranks
    }
  }
  return std::make_unique<ReplicatedCoarse>(motions, constraints);
}

} // namespace Harmos::feti
