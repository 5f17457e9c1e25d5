// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SurfacePair.hpp"

namespace Harmos::effects {

/// Two boundary parts are glued together: u¹ = u². Rows where both sides end on prescribed displacements are
/// left out, see contact::tieRows().
///
/// Guarded by tests/verification/test_contact_patch.cpp.
class Tie : public scene::Effect {
 public:
  static constexpr const char* kindName = "Tie";

  explicit Tie(SurfacePair pair, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override { return pair_.parts(); }
  bool exertsForce() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  bool tiesSurfaces() const override { return true; }
  void addConstraints(scene::ConstraintCollector& collector) const override;

 private:
  SurfacePair pair_;
};

/// What decks may say of it.
scene::EffectKind kindOfTie();

} // namespace Harmos::effects
