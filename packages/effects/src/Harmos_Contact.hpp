// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SurfacePair.hpp"

namespace Harmos::effects {

/// Two boundary parts do not penetrate each other, without friction or adhesion, unless effects of their own
/// say so: n·(u¹ − u²) ≤ gap, or, where the surfaces give way, ≤ gap + p/k under the pressure p.
///
/// Guarded by tests/verification/test_contact_patch.cpp and tests/unit/scene/test_contact_setup.cpp.
class Contact : public scene::Effect, public scene::FiniteBehaviour {
 public:
  static constexpr const char* kindName = "Contact";

  struct Options {
    double gap = 0.0;       ///< added to the distance of the meshes; negative: penetration
    double stiffness = 0.0; ///< k, pressure by penetration; 0: the contact is hard
    double adjust = 0.0;    ///< distances up to this, and penetrations, are taken to be zero; 0: none
    /// Penetration besides, which the history of the effect scales over time: a shrink fit.
    double interference = 0.0;
  };
  explicit Contact(SurfacePair pair, double gap = 0.0, std::string name = "");
  Contact(SurfacePair pair, const Options& options, std::string name);

  std::vector<BoundaryPart> boundaryParts() const override { return pair_.parts(); }
  bool givesInequalities() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return this; }
  bool hasMagnitude() const override { return options_.interference != 0.0; }
  void check(const scene::Scene& scene) const override;
  void addConstraints(scene::ConstraintCollector& collector) const override;

  /// Of finite displacements: one body deeper in the other than the reach, where no point holds it.
  std::string fault(const scene::ConstraintCollector& deformed) const override;

 private:
  SurfacePair pair_;
  Options options_;
};

/// What decks may say of it.
scene::EffectKind kindOfContact();

} // namespace Harmos::effects
