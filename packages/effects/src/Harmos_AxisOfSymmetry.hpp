// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Effect.hpp"

namespace Harmos::effects {

/// Nodes on the axis of an axisymmetric scene do not move away from it: u_x = 0 at x = 0. Decks of such
/// scenes have it by themselves.
///
/// Guarded by tests/verification/physics/test_axisymmetric.cpp.
class AxisOfSymmetry : public scene::Effect {
 public:
  static constexpr const char* kindName = "Axis of symmetry";

  /// @param bodies how many there are.
  explicit AxisOfSymmetry(std::size_t bodies);

  std::vector<int> bodies() const override { return bodies_; }
  bool exertsForce() const override { return false; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  /// @throws InputError for other physics.
  void check(const scene::Scene& scene) const override;
  void addPrescribed(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                     std::vector<feti::FixedDof>& fixed) const override;

 private:
  std::vector<int> bodies_;
};

} // namespace Harmos::effects
