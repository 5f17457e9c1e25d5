// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

#include <functional>

namespace Harmos::effects {

/// A boundary part is held at given displacements, in all or some components: Dirichlet conditions.
///
/// Guarded by tests/verification/test_elements.cpp.
class PrescribedDisplacement : public scene::Effect {
 public:
  static constexpr const char* kindName = "Prescribed displacement";

  struct Component {
    int component = 0;
    double value = 0.0;
    std::function<double(const fem::Point&)> field = nullptr; ///< if given, in the place of the value
  };

  PrescribedDisplacement(Part part, std::vector<Component> components, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override { return {{part_.body, part_.set, false}}; }
  std::vector<int> bodies() const override { return {part_.body}; }
  bool hasMagnitude() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  std::vector<int> heldBodies() const override { return {part_.body}; }
  /// @throws InputError for components that a node does not have.
  void check(const scene::Scene& scene) const override;
  void addPrescribed(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                     std::vector<feti::FixedDof>& fixed) const override;

 private:
  Part part_;
  std::vector<Component> components_;
};

/// What decks may say of it.
scene::EffectKind kindOfPrescribedDisplacement();

/// Holds a part in one component, and has the name of the part.
std::shared_ptr<const PrescribedDisplacement> hold(const Part& part, int component, double value = 0.0);

} // namespace Harmos::effects
