// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"
#include "Harmos_Loads.hpp"

namespace Harmos::effects {

/// A force on a boundary part of an elastic body: f_i = ∫ (t − pn) φ_i. Of finite displacements t is a force
/// per area of the body at rest and keeps its direction, and the pressure p acts on the deformed body.
///
/// Guarded by tests/verification/test_elements.cpp.
class Traction : public scene::Effect, public scene::FiniteBehaviour {
 public:
  static constexpr const char* kindName = "Traction";

  /// @param density force per area.
  Traction(Part part, fem::Traction density, std::string name = "");
  /// @param density or null. @param pressure against the outward normal.
  Traction(Part part, fem::Traction density, double pressure, std::string name);

  std::vector<BoundaryPart> boundaryParts() const override { return {{part_.body, part_.set, true}}; }
  std::vector<int> bodies() const override { return {part_.body}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return this; }
  void check(const scene::Scene& scene) const override { requireElastic(scene, label()); }
  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;

  // Of finite displacements: the pressure.
  bool hasFollowingLoads() const override { return pressure_ != 0.0; }
  void addFollowingLoad(const scene::Scene& scene, const Deformed& subdomain,
                        std::vector<double>& load) const override;

 private:
  Part part_;
  fem::Traction density_; // null: none
  double pressure_ = 0.0;
};

/// What decks may say of it.
scene::EffectKind kindOfTraction();

} // namespace Harmos::effects
