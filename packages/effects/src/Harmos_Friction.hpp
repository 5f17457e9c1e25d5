// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeckPlaces.hpp"

#include <functional>
#include <memory>

namespace Harmos::effects {

/// A coefficient of friction, by the position of the point on the first surface.
struct Coulomb {
  Coulomb(double mu) : coefficient([mu](const fem::Point&) { return mu; }) {}
  explicit Coulomb(std::function<double(const fem::Point&)> mu) : coefficient(std::move(mu)) {}

  std::function<double(const fem::Point&)> coefficient; ///< μ ≥ 0
};

/// Friction between the surfaces of a contact, or on an obstacle: the force of a point across the normal is
/// at most g; below it the point sticks, at it the point slips along the force (Duvaut, Lions: Inequalities
/// in Mechanics and Physics, 1976):
///
///     |λ_t| ≤ g,   |λ_t| < g ⇒ Δs = 0,   |λ_t| = g ⇒ Δs = cλ_t, c ≥ 0
///
/// −λ_t is the force on the first body, Δs = B_t u − c_t the slip of the step, of the first body against the
/// second: c_t is that of the last step that was accepted.
///
/// By Coulomb's law g = μλ_n, point by point, λ_n the force of contact. By Tresca's law g is given, the slip
/// bound times the area of the point, whatever the pressure is, also where the contact is open.
///
/// Guarded by tests/verification/test_friction.cpp and tests/unit/effects/test_friction.cpp.
class Friction : public scene::Effect, public scene::InterfaceLaw {
 public:
  static constexpr const char* kindName = "Friction";

  /// @param contact a Contact or a RigidObstacle of the same scene. @param slipBound force per area, not
  /// negative.
  Friction(std::shared_ptr<const scene::Effect> contact, double slipBound, std::string name = "");
  Friction(std::shared_ptr<const scene::Effect> contact, Coulomb law, std::string name = "");
  /// @param slipBound by the position of the point on the first surface.
  Friction(std::shared_ptr<const scene::Effect> contact, std::function<double(const fem::Point&)> slipBound,
           std::string name = "");

  const scene::Effect& contact() const { return *contact_; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  /// @throws InputError for membranes, a contact that is not in the scene, is none, or has
  /// another friction.
  void check(const scene::Scene& scene) const override;
  /// @throws InputError where the bound or the coefficient is negative or no number.
  void addConstraints(scene::ConstraintCollector& collector) const override;

  const scene::InterfaceLaw* interfaceLaw() const override { return this; }
  std::size_t stateSize() const override;
  void beginStep(scene::PointStates& trial) const override;
  void addToBounds(const scene::PointStates& state, const std::vector<Row>& rows,
                   std::vector<double>& bounds) const override;
  bool updateState(const std::vector<RowAnswer>& answer, double tolerance, const Largest& largest,
                   scene::PointStates& trial) const override;

 private:
  std::shared_ptr<const scene::Effect> contact_;
  std::function<double(const fem::Point&)> value_; // slip bound, or
  bool isCoulomb_ = false;                         // coefficient
};

/// What decks may say of it.
scene::EffectKind kindOfFriction();

} // namespace Harmos::effects
