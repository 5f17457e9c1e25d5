// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DesignProblem.hpp"

#include "Harmos_Log.hpp"

#include <cmath>

namespace Harmos::sensitivity {

void DesignSpace::check() const {
  const std::size_t n = start.size();
  if (n == 0)
    throw InputError("a design needs at least one number");
  if (lower.size() != n || upper.size() != n || weights.size() != n)
    throw InputError("a design of " + std::to_string(n) +
                     " numbers needs as many lower and upper bounds and weights");
  for (std::size_t k = 0; k < n; ++k) {
    const std::string name = "number " + std::to_string(k) + " of the design";
    if (!(lower[k] <= upper[k]))
      throw InputError(name + ": lower bound " + scientific(lower[k]) + " exceeds upper bound " +
                       scientific(upper[k]));
    if (!(start[k] >= lower[k] && start[k] <= upper[k]))
      throw InputError(name + " starts at " + scientific(start[k]) + ", outside its bounds, " +
                       scientific(lower[k]) + " and " + scientific(upper[k]));
    if (!(weights[k] > 0.0) || !std::isfinite(weights[k]))
      throw InputError(name + " has the weight " + scientific(weights[k]) + "; give a positive weight");
  }
}

} // namespace Harmos::sensitivity
