// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseForms.hpp"

#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_ReplicatedCoarse.hpp"

namespace Harmos::feti {

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
