// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace Harmos::fem {

/// The yield stress over the equivalent plastic strain: linear between points and beyond the last one.
/// Local. Guarded by tests/unit/fem/test_plasticity.cpp.
class HardeningCurve {
 public:
  /// @param slope beyond the last point.
  HardeningCurve(std::vector<double> strains, std::vector<double> stresses, double slope);

  double stress(double strain) const;
  /// ∫₀ σ de.
  double work(double strain) const;

  struct Flow {
    double amount; ///< Δγ
    double slope;  ///< of the curve there
  };
  /// Δγ of a − bΔγ = √⅔ σ(e + √⅔Δγ): where the stress that is left, with b what a flow takes from it, is the
  /// one that the material bears. @param a above √⅔ σ(e). @param b above 0.
  Flow flow(double strain, double a, double b) const;

 private:
  std::size_t segmentOf(double strain) const;
  double slopeOf(std::size_t segment) const;

  std::vector<double> strains_, stresses_;
  double slope_;
};

} // namespace Harmos::fem
