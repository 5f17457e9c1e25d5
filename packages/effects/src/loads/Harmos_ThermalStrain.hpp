// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// An elastic body is warmer than when it was free of stress: f = ∫ B̄ᵀ C ε_T, and σ = C(ε̄ − ε_T). Rises of
/// several effects add up. Of finite displacements there is no load: see fem::ElasticLaw.
///
/// Guarded by tests/unit/fem/test_elasticity.cpp and tests/verification/test_scenes.py.
class ThermalStrain : public scene::Effect {
 public:
  static constexpr const char* kindName = "Thermal strain";

  /// @param rise in degrees.
  ThermalStrain(int body, double rise, std::string name = "");
  /// @param field of the body's mesh: rises at nodes.
  ThermalStrain(int body, std::string field, std::string name);

  std::vector<int> bodies() const override { return {body_}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  void check(const scene::Scene& scene) const override { requireElastic(scene, label()); }
  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;
  double temperatureRise(int body) const override { return body == body_ ? rise_ : 0.0; }
  std::string temperatureField(int body) const override { return body == body_ ? field_ : ""; }

 private:
  int body_;
  double rise_ = 0.0;
  std::string field_;
};

/// What decks may say of it.
scene::EffectKind kindOfThermalStrain();

} // namespace Harmos::effects
