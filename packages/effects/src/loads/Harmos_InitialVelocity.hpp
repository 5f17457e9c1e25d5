// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"
#include "Harmos_FiniteBehaviour.hpp"
#include "Harmos_InitialMotion.hpp"
#include "Harmos_PointAlgebra.hpp"

namespace Harmos::effects {

/// How a body moves when a transient run begins: v = v₀ + ω × (x − x₀).
///
/// Guarded by tests/verification/physics/test_transient.py.
class InitialVelocity : public scene::Effect, public scene::InitialMotion {
 public:
  static constexpr const char* kindName = "Initial velocity";

  struct Motion {
    fem::Point velocity{};        ///< of the centre
    fem::Point angularVelocity{}; ///< radians per time; in the plane about z
    fem::Point centre{};
  };

  InitialVelocity(int body, const Motion& motion, std::string name = "");

  std::vector<int> bodies() const override { return {body_}; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  /// @throws InputError for a run that is not transient, and for motions that leave the plane.
  void check(const scene::Scene& scene) const override;
  void addVelocity(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                   std::vector<double>& velocity) const override;

 private:
  int body_;
  Motion motion_;
};

/// What decks may say of it.
scene::EffectKind kindOfInitialVelocity();

} // namespace Harmos::effects
