// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"
#include "Harmos_Loads.hpp"

namespace Harmos::effects {

/// A body that turns about an axis at a constant speed, in axes that turn with it: f_i = ∫ ρ ω² r φ_i, r the
/// vector from the axis; of finite displacements from where the body is, over its mass at rest.
///
/// Guarded by tests/unit/effects/test_centrifugal_force.cpp.
class CentrifugalForce : public scene::Effect, public scene::FiniteBehaviour {
 public:
  static constexpr const char* kindName = "Centrifugal force";

  struct Rotation {
    double massDensity = 0.0;                   ///< ρ, mass per volume
    double angularVelocity = 0.0;               ///< ω, radians per time
    fem::Point point{}, axis = {0.0, 0.0, 1.0}; ///< in the plane the axis is normal to it
  };

  CentrifugalForce(int body, const Rotation& rotation, std::string name = "");

  std::vector<int> bodies() const override { return {body_}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return this; }
  /// @throws InputError for membranes, and for an axis of length zero or one that lies in the plane.
  void check(const scene::Scene& scene) const override;
  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;

  bool hasFollowingLoads() const override { return true; }
  void addFollowingLoad(const scene::Scene& scene, const Deformed& subdomain,
                        std::vector<double>& load) const override;

 private:
  fem::VectorField density() const;

  int body_;
  Rotation rotation_;
};

/// What decks may say of it.
scene::EffectKind kindOfCentrifugalForce();

} // namespace Harmos::effects
