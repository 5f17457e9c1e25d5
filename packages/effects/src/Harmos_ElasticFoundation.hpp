// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// A boundary part of an elastic body rests on a linear elastic foundation, which pulls as well as it pushes
/// (Winkler 1867; Timoshenko, Goodier: Theory of Elasticity, 1970):
///
///     t = −C u,  C = k_n n⊗n + k_t (I − n⊗n),  so that  K += ∫ φ_i φ_j C.
///
/// With both stiffnesses positive it holds its body; with one of them a straight part leaves motions to
/// others, and the kernel of each subdomain is what is left.
///
/// Guarded by tests/unit/effects/test_elastic_foundation.cpp.
class ElasticFoundation : public scene::Effect {
 public:
  static constexpr const char* kindName = "Elastic foundation";

  /// @param normal k_n and @param tangential k_t: force per area and displacement, not negative.
  ElasticFoundation(Part part, double normal, double tangential, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override { return {{part_.body, part_.set, true}}; }
  std::vector<int> bodies() const override { return {part_.body}; }
  std::vector<int> heldBodies() const override;
  bool exertsForce() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  /// @throws InputError for membranes, and if both stiffnesses are zero or one is negative.
  void check(const scene::Scene& scene) const override;
  std::optional<Key> stiffnessKey(const scene::Scene& scene,
                                  const scene::OwnedSubdomain& subdomain) const override;
  void addStiffness(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                    std::vector<MatrixEntry>& entries) const override;

 private:
  Part part_;
  double normal_, tangential_;
};

/// What decks may say of it.
scene::EffectKind kindOfElasticFoundation();

} // namespace Harmos::effects
