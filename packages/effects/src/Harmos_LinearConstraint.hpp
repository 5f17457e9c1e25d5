// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// Linear conditions on displacements of nodes, which may belong to several bodies: Σ c_i u_i = g, each a row
/// of B. The force of the condition, its multiplier λ, acts with −λ c_i at each of its nodes. A history
/// scales g.
///
/// Guarded by tests/unit/effects/test_linear_constraint.cpp.
class LinearConstraint : public scene::Effect {
 public:
  static constexpr const char* kindName = "Linear constraint";

  struct Term {
    Part part; ///< of one node
    int component;
    double coefficient;
  };
  struct Equation {
    std::vector<Term> terms;
    double value = 0.0; ///< g
  };

  explicit LinearConstraint(std::vector<Equation> equations, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override;
  /// The force is that on the node of the first term, summed over the equations.
  bool exertsForce() const override { return true; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  bool hasMagnitude() const override;
  /// @throws InputError for components that a node does not have.
  void check(const scene::Scene& scene) const override;
  void addConstraints(scene::ConstraintCollector& collector) const override;

 private:
  std::vector<Equation> equations_;
};

/// What decks may say of it.
scene::EffectKind kindOfLinearConstraint();

} // namespace Harmos::effects
