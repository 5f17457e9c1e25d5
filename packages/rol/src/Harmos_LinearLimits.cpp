// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LinearLimits.hpp"

#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::rol {

AffineFunction::AffineFunction(sensitivity::DesignFunction& function, const std::vector<double>& design)
    : design_(design), value_(function.value(design, 0.0)) {
  gradient_ = function.gradient(design, 0.0);
  HARMOS_REQUIRE(gradient_.size() == design.size(), "a gradient has other numbers than the design");
}

double AffineFunction::value(const std::vector<double>& design, double) {
  double result = value_;
  for (std::size_t k = 0; k < design.size(); ++k)
    result += gradient_[k] * (design[k] - design_[k]);
  return result;
}

std::vector<double> AffineFunction::gradient(const std::vector<double>&, double) {
  return gradient_;
}

double AffineFunction::extreme(const sensitivity::DesignSpace& space, double sign) const {
  double result = value_;
  for (std::size_t k = 0; k < design_.size(); ++k)
    if (gradient_[k] != 0.0) // or zero times infinity
      result += gradient_[k] * ((sign * gradient_[k] > 0.0 ? space.upper[k] : space.lower[k]) - design_[k]);
  return result;
}

void checkReach(const sensitivity::DesignConstraint& constraint, const AffineFunction& function,
                const sensitivity::DesignSpace& space) {
  const double least = function.least(space), most = function.most(space);
  // Sums of as many terms as there are numbers: their rounding, generously.
  double size = 0.0;
  for (const double number : {least, most, constraint.lower, constraint.upper})
    if (std::isfinite(number))
      size = std::max(size, std::abs(number));
  const double rounding =
      10.0 * static_cast<double>(space.size()) * std::numeric_limits<double>::epsilon() * size;
  if (constraint.lower <= most + rounding && constraint.upper >= least - rounding)
    return;
  const std::string limits = constraint.isEquality()
                                 ? "is to be " + scientific(constraint.lower, 6)
                                 : "is to lie between " + scientific(constraint.lower, 6) + " and " +
                                       scientific(constraint.upper, 6);
  throw InputError("no design within the bounds satisfies the constraint \"" + constraint.name + "\": it " +
                       limits + ", but is at least " + scientific(least, 6) + " and at most " +
                       scientific(most, 6) + "; widen the bounds of the design or change the limits",
                   {{"constraint", constraint.name},
                    {"least", scientific(least, 6)},
                    {"most", scientific(most, 6)},
                    {"lower", scientific(constraint.lower, 6)},
                    {"upper", scientific(constraint.upper, 6)}});
}

} // namespace Harmos::rol
