// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// The same force at each node of a part of an elastic body. Where the mesh is refined such a load does not
/// converge: displacements under a force at a point grow without bound. Traction does.
///
/// Guarded by tests/unit/effects/test_force.cpp.
class Force : public scene::Effect {
 public:
  static constexpr const char* kindName = "Force";

  Force(Part part, const fem::Point& force, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override { return {{part_.body, part_.set, false, true}}; }
  std::vector<int> bodies() const override { return {part_.body}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  void check(const scene::Scene& scene) const override { requireElastic(scene, label()); }
  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;

 private:
  Part part_;
  fem::Point force_;
};

/// What decks may say of it.
scene::EffectKind kindOfForce();

} // namespace Harmos::effects
