// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_DeckPlaces.hpp"

namespace Harmos::effects {

/// A bolt under pretension: both sides of a plane cut through it keep together, but for the same shift s
/// along the normal n of the cut everywhere, by which the bolt is shorter: with the outward normal of the
/// first side
///
///     u¹ − u² = s n.
///
/// Either the force F of the bolt is given, and s follows, until the bolt is locked and keeps the s that it
/// has then; or s is given. The sides have the same nodes. F loads them evenly, F/A n; −λ n is added where s
/// does not give way. A history scales F or s.
///
/// Of finite displacements n is that of the deformed cut, in the mean: the bolt may turn and bend, its force
/// goes with it. Of half a bolt it stays in the plane that holds it. What n adds to the derivative of u¹ − u²
/// = s n is left out: forces across the bolt act s apart, and make a couple of that arm.
///
/// Guarded by tests/verification/physics/test_pretension.py and tests/verification/finite.
class Pretension : public scene::Effect, public scene::FiniteBehaviour {
 public:
  static constexpr const char* kindName = "Pretension";

  struct Options {
    std::optional<double> force, shift; ///< one of them
    std::optional<double> lockedFrom;   ///< time, with a force; none: never
  };

  Pretension(Part first, Part second, const Options& options, std::string name = "");

  std::vector<BoundaryPart> boundaryParts() const override;
  std::vector<int> bodies() const override;
  bool exertsForce() const override { return true; }
  bool hasMagnitude() const override { return true; }
  /// @throws InputError for a time that is not the end of a step.
  void check(const scene::Scene& scene) const override;

  std::optional<Key> loadKey(const scene::Scene& scene,
                             const scene::OwnedSubdomain& subdomain) const override;
  void addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
               std::vector<double>& load) const override;
  const scene::FiniteBehaviour* finite() const override { return this; }
  bool hasFollowingLoads() const override { return options_.force.has_value(); }
  void addFollowingLoad(const scene::Scene& scene, const Deformed& subdomain,
                        std::vector<double>& load) const override;
  bool loadsWithItsForce() const override { return options_.force.has_value(); }
  void addForce(const scene::Scene& scene, const Deformed& subdomain,
                std::vector<double>& load) const override;
  /// @throws InputError on all ranks where the cut is not plane, or its sides have not the same nodes.
  void addConstraints(scene::ConstraintCollector& collector) const override;

 private:
  void pull(const Part& part, const scene::OwnedSubdomain& atRest, const scene::OwnedSubdomain& now,
            std::vector<double>& load) const;
  void requirePlane(const scene::ConstraintCollector& collector) const;
  fem::Point directionNow(scene::ConstraintCollector& collector, const fem::Point& atRest) const;

  Part first_, second_;
  Options options_;
};

/// What decks may say of it.
scene::EffectKind kindOfPretension();

} // namespace Harmos::effects
