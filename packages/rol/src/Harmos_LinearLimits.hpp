// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignProblem.hpp"

#include <vector>

namespace Harmos::rol {

/// A linear function, known from its value and gradient at one design: ROL asks for such functions at designs
/// that have no shape, all zeros for one (DaiFletcherProjection).
class AffineFunction : public sensitivity::DesignFunction {
 public:
  /// Asks the function at the design. @throws what the function throws. @note Collective, as nothing else
  /// here is.
  AffineFunction(sensitivity::DesignFunction& function, const std::vector<double>& design);

  double value(const std::vector<double>& design, double tolerance = 0.0) override;
  std::vector<double> gradient(const std::vector<double>& design, double tolerance = 0.0) override;

  /// What it is at least, and at most, between the bounds; may be infinite.
  double least(const sensitivity::DesignSpace& space) const { return extreme(space, -1.0); }
  double most(const sensitivity::DesignSpace& space) const { return extreme(space, 1.0); }

 private:
  double extreme(const sensitivity::DesignSpace& space, double sign) const;

  std::vector<double> design_, gradient_;
  double value_;
};

/// @throws InputError if no design between the bounds meets the limits: with the constraint's name, what it
/// is at least and at most, and its limits. Guarded by tests/unit/rol/test_constraints.cpp.
void checkReach(const sensitivity::DesignConstraint& constraint, const AffineFunction& function,
                const sensitivity::DesignSpace& space);

} // namespace Harmos::rol
