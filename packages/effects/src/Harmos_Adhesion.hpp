// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CohesiveLaw.hpp"
#include "Harmos_DamageUpdate.hpp"
#include "Harmos_DeckPlaces.hpp"

#include <memory>

namespace Harmos::effects {

/// A contact, or a body on an obstacle, that is glued until it breaks: springs where the surfaces touch when
/// the run begins, unstretched there, in tension and along the surfaces; in compression it is the contact
/// that it always is (Wriggers, Zavarise, Zohdi: Comput. Mater. Sci. 12, 1998). By the law of CohesiveLaw,
/// point by point,
///
///     t_n = (1 − d)k_n δ_n where it is open,   t_t = (1 − d)k_t s,
///
/// s the slip, and one damage d that never falls. Where d = 1 a contact is left, with the friction that acts
/// on it, if any, from where the surfaces have slipped to.
///
/// Within a step convex problems are solved, of springs that the law gives for the last answer, until both
/// agree: see DamageUpdate and run::Softening. In a brittle law of what is beyond its strength only those
/// points break that are nearly as far beyond it as the worst one: the others are asked again when those
/// carry nothing any more.
///
/// Guarded by tests/unit/effects/test_adhesion.cpp and tests/verification/test_adhesion.cpp.
class Adhesion : public scene::Effect, public scene::InterfaceLaw {
 public:
  static constexpr const char* kindName = "Adhesion";

  /// @param contact a Contact or a RigidObstacle of the same scene.
  Adhesion(std::shared_ptr<const scene::Effect> contact, const CohesiveLaw& law, std::string name = "");

  const scene::Effect& contact() const { return *contact_; }
  const CohesiveLaw& law() const { return law_; }
  /// @throws InputError for membranes, a contact that is not in the scene, is none, or has another adhesion.
  void check(const scene::Scene& scene) const override;
  void addConstraints(scene::ConstraintCollector& collector) const override;

  const scene::InterfaceLaw* interfaceLaw() const override { return this; }
  const scene::FiniteBehaviour* finite() const override { return &scene::FiniteBehaviour::plain(); }
  std::size_t stateSize() const override { return scene::PointStates::sizeOf<DamageState>(); }
  void beginStep(scene::PointStates& trial) const override;
  void soften(const scene::PointStates& state, const std::vector<Row>& rows,
              std::vector<Spring>& springs) const override;
  bool updateState(const std::vector<RowAnswer>& answer, double tolerance, const Largest& largest,
                   scene::PointStates& trial) const override;
  bool softens() const override { return !law_.isBrittle(); }
  std::vector<double> lawForces(const scene::PointStates& trial, const std::vector<Row>& rows,
                                const std::vector<double>& openings) const override;
  double misfit(const std::vector<RowAnswer>& answer, const scene::PointStates& trial) const override;
  bool follow(const std::vector<Row>& rows, const std::vector<double>& openings,
              std::optional<double> steepness, double known, scene::PointStates& trial) const override;
  bool breaks() const override { return true; }
  double damage(const scene::PointStates& state, std::size_t point) const override {
    return state.get<DamageState>(point).damage;
  }
  Broken broken(const scene::PointStates& state, const std::vector<Row>& rows) const override;
  /// A quarter of what the interface can dissipate.
  double mostBroken() const override { return 0.25; }

 private:
  double root(std::size_t direction) const; // of the stiffness
  std::vector<DamageUpdate::Point> pointsOf(const std::vector<Row>& rows, const std::vector<double>& openings,
                                            std::size_t count) const;

  std::shared_ptr<const scene::Effect> contact_;
  CohesiveLaw law_;
};

/// The law in a deck: stiffnesses, strengths and energies.
void addCohesiveLaw(ParameterSpec& spec);
/// @throws InputError for what is missing or makes no law, with the path in the deck.
CohesiveLaw cohesiveLawFrom(const Teuchos::ParameterList& list, const std::string& path);

/// What decks may say of it.
scene::EffectKind kindOfAdhesion();

} // namespace Harmos::effects
