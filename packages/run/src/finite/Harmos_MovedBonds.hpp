// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_DeformedBodies.hpp"
#include "Harmos_EffectStates.hpp"
#include "Harmos_SlipStates.hpp"

#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

namespace Harmos::run {

/// Adhesion at finite displacements, where contacts come and go. A point that adhesion binds keeps the places
/// of the second surface that it touched when the run began, with the weights w_a and the area A of then:
/// with its normal n and tangents t of now,
///
///     δ_n = n·j − n₀·j₀,  s = t·j − t₀·j₀,   j = −Σ w_a x_a,
///
/// which bodies that but move leave as they are: openings and slips need no history, damage alone has one
/// (Ortiz, Pandolfi: Int. J. Numer. Meth. Engng. 44, 1999; tractions are per area at rest). Where it has
/// broken, from the next step on, it is a contact as all others are. On an obstacle, which does not turn,
/// w_a u_a take the place of w_a x_a.
///
/// Guarded by tests/unit/run/test_finite_displacements.cpp and tests/verification/finite.
class MovedBonds {
 public:
  /// @param atRest contacts of the bodies at rest. @param bodies to outlive it. @note Collective.
  MovedBonds(const std::vector<scene::OwnedSubdomain>& owned, const scene::ContactSetup& atRest,
             const DeformedBodies& bodies);

  /// The points that are bound when the run begins, alone: what states are of.
  const scene::ContactSetup& points() const { return points_; }
  /// @param states of these, which say what holds, and what is broken for good; to outlive it.
  void follow(const EffectStates& states) { states_ = &states; }
  bool any() const { return points_.bondCount > 0; }

  /// Leaves contacts alone, as they are at rest, of what has broken. Local.
  void release(scene::ContactSetup& contact) const;
  /// What is bound still, for scene::setUpMovedContact().
  std::vector<scene::ContactSetup::Pairing> pairings() const;
  /// Gives the rows of what is bound their springs, and where these have no force. @param contact of the
  /// deformed bodies, with those pairings. @note Collective.
  void hold(scene::ContactSetup& contact, const feti::TornVector& displacement) const;
  /// Of limited rows: where springs have no force, so that slips are those since the run began. Local.
  void addSlipsBefore(const scene::ContactSetup& contact, std::vector<double>& slips) const;

  /// An answer, in the order of points(); nothing of those that are contacts now.
  struct Answer {
    std::vector<ContactState> states;
    std::vector<RowSlip> slips;
  };
  /// Local.
  Answer answer(const scene::ContactSetup& contact, const std::vector<ContactState>& states,
                const std::vector<RowSlip>& slips) const;
  /// EffectStates::tell() of what is bound. What has broken and meets nothing any more becomes a point of the
  /// contact, without a row, for results. Local.
  void tell(scene::ContactSetup& contact, const std::vector<RowSlip>& slips,
            std::vector<ContactState>& states);

 private:
  using Key = std::tuple<const scene::Effect*, long long, int>; // contact, node, side
  struct AtRest {
    fem::Point normal{}, jump{}; // j₀
    std::vector<fem::Point> tangents;
  };
  // Places of a point that is bound: in points(), and in a contact of now.
  struct Place {
    std::size_t own, point, slip;
  };
  std::vector<Place> placesIn(const scene::ContactSetup& contact) const;
  void findJumps(const std::vector<scene::OwnedSubdomain>& owned);
  bool takesOver(std::size_t own, const ConstraintRow& spring) const;

  const DeformedBodies& bodies_;
  const EffectStates* states_ = nullptr;
  scene::ContactSetup points_;
  std::vector<AtRest> atRest_; // of each point
  std::map<Key, std::size_t> placeOf_;
};

} // namespace Harmos::run
