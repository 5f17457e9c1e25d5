// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Assembly.hpp"
#include "Harmos_EffectRegistry.hpp"
#include "Harmos_Loads.hpp"

#include <vector>

namespace Harmos::effects {

/// A force on a body: f_i = ∫ b φ_i.
///
/// Guarded by tests/verification/test_elements.cpp and tests/verification/test_model_problem.py.
class BodyForce : public scene::Effect {
 public:
  static constexpr const char* kindName = "Body force";

  /// The same everywhere, per volume of an elastic body.
  BodyForce(int body, const fem::Point& density, std::string name = "");
  /// Per volume of an elastic body.
  BodyForce(int body, fem::VectorField density, std::string name = "");
  /// Of a membrane.
  BodyForce(int body, std::vector<fem::BoxLoad> loads, std::string name = "");

  std::vector<int> bodies() const override { return {body_}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  /// @throws InputError for a load of a membrane on an elastic body, and the other way round.
  void check(const scene::Scene& scene) const override;
  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;

 private:
  int body_;
  bool isUniform_ = false;
  fem::VectorField density_;
  std::vector<fem::BoxLoad> boxes_;
};

/// What decks may say of it.
scene::EffectKind kindOfBodyForce();

} // namespace Harmos::effects
