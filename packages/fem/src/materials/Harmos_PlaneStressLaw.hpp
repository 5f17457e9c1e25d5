// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_MaterialLaw.hpp"

namespace Harmos::fem {

/// Plane stress of a law in space: the strain across the plane is the one without stress there, and the
/// tangent is condensed. States: the law's, and that strain, from where the next search begins.
///
/// Local. Guarded by tests/unit/fem/test_plasticity.cpp.
class PlaneStressLaw : public MaterialLaw {
 public:
  explicit PlaneStressLaw(std::unique_ptr<MaterialLaw> inSpace) : law_(std::move(inSpace)) {}

  std::size_t stateSize() const override { return law_->stateSize() + 1; }
  MaterialResponse at(const Voigt& strain, double rise, const double* before, double* after) const override;
  double shownState(const double* state) const override { return law_->shownState(state); }

 private:
  std::unique_ptr<MaterialLaw> law_;
};

} // namespace Harmos::fem
