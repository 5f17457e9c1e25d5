// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// A boundary part of an elastic body does not penetrate a rigid body at rest: n·u ≤ gap, see
/// contact::obstaclePoints().
///
/// Guarded by tests/verification/test_contact_patch.cpp.
class RigidObstacle : public scene::Effect {
 public:
  static constexpr const char* kindName = "Obstacle";

  RigidObstacle(Part part, const contact::Obstacle& obstacle, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override { return {{part_.body, part_.set, true}}; }
  bool givesInequalities() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  void check(const scene::Scene& scene) const override { requireElastic(scene, label()); }
  void addConstraints(scene::ConstraintCollector& collector) const override;

 private:
  Part part_;
  contact::Obstacle obstacle_;
};

/// What decks may say of it.
scene::EffectKind kindOfRigidObstacle();

} // namespace Harmos::effects
