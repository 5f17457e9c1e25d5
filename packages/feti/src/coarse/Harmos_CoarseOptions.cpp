// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseOptions.hpp"

#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_ReplicatedCoarse.hpp"

#include <algorithm>

namespace Harmos::feti {

std::unique_ptr<CoarseSpace> makeCoarseSpace(const SubdomainSystem& system, const Constraints& constraints,
                                             const CoarseOptions& options) {
  using Form = CoarseOptions::Form;
  if (options.form == Form::Distributed)
    return std::make_unique<DistributedCoarse>(system, constraints, options);
  if (options.form == Form::Auto && isDistributedCheaper(shapeOf(system), options.rates)) {
    try {
      return std::make_unique<DistributedCoarse>(system, constraints, options);
    } catch (const NumericalError&) { // on all ranks
    }
  }
  return std::make_unique<ReplicatedCoarse>(system, constraints);
}

} // namespace Harmos::feti
