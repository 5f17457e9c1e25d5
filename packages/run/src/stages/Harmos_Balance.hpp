// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CarriedForces.hpp"
#include "Harmos_DeformedBodies.hpp"
#include "Harmos_Locks.hpp"
#include "Harmos_Motion.hpp"
#include "Harmos_MovedBonds.hpp"
#include "Harmos_RunStages.hpp"

#include <memory>
#include <string>
#include <vector>

namespace Harmos::run {

/// What is out of balance where bodies are in a step: stresses, loads and contacts, which are searched there.
/// Displacements are of all nodes of this rank's subdomains, with equal copies.
///
/// All members are collective. Guarded by tests/verification/finite.
class Balance {
 public:
  using Loads = std::vector<std::shared_ptr<const std::vector<double>>>;

  /// All of these have to outlive it.
  /// @param motion null: forces of inertia are none.
  Balance(const RunContext& context, RunStages& run, const DeformedBodies& bodies, Motion* motion)
      : context_(context),
        run_(run),
        bodies_(bodies),
        motion_(motion),
        atRest_(run.contact()),
        bonds_(run.owned(), run.contact(), bodies) {}

  /// @param locks which of the equations hold that are locked at a time; to outlive it.
  void follow(const Locks& locks) { locks_ = &locks; }
  /// What adhesion binds.
  MovedBonds& bonds() { return bonds_; }
  long long bondCount() const { return bonds_.points().bondCount; }

  /// A step to a time begins. @param begun displacements there, since when points slip; to outlive the step.
  void begin(double time, const feti::TornVector& begun);
  double time() const { return time_; }
  /// Of bodies that have inertia, or null.
  Motion* motion() const { return motion_; }

  /// Rows of how displacements change from here.
  scene::ContactSetup contactAt(const feti::TornVector& displacement) const;
  /// Loads that keep their direction, and those that go with the bodies, less forces of inertia.
  Loads loadsAt(const feti::TornVector& displacement) const;
  DeformedBodies::Forces forcesAt(const feti::TornVector& displacement) const;
  /// Loads less internal forces and those of rows, which points keep that have them, but for springs of
  /// adhesion. Without frames.
  feti::TornVector at(const feti::TornVector& displacement, const CarriedForces& ofRows) const;

  /// An equilibrium.
  struct Answer {
    const feti::TornVector& displacement;
    const DeformedBodies::Forces& forces;
    const Loads& loads;
    const CarriedForces& ofRows;
    const feti::TornSolution& change; ///< the last one, in the frames
    double jump;                      ///< of copies, the largest that was joined
  };
  /// Forces and gaps, with rows made once more.
  feti::KktAudit audit(const Answer& given) const;
  /// By which prescribed values are held: internal forces, loads and those of rows out of balance.
  std::vector<std::vector<double>> reactions(const Answer& given) const;
  /// What effects forbid of bodies in equilibrium and do not see, see scene::FiniteBehaviour::fault(); of
  /// states on the way that nothing can be asked of nothing.
  std::string faultOf(const feti::TornVector& displacement) const;

 private:
  scene::ContactSetup contactOf(const feti::TornVector& displacement) const;
  std::vector<scene::OwnedSubdomain> movedBy(const feti::TornVector& displacement) const;
  feti::TornVector rowForces(const feti::Constraints& constraints, const MultiVector& multiplier) const;

  RunContext context_;
  RunStages& run_;
  const DeformedBodies& bodies_;
  Motion* motion_;
  scene::ContactSetup atRest_;
  MovedBonds bonds_;
  const Locks* locks_ = nullptr;
  double time_ = 0.0;
  const feti::TornVector* begun_ = nullptr;
  Loads dead_;
};

/// The largest |entry| of all ranks. @note Collective.
double largestOf(const Teuchos::Comm<int>& comm, const feti::TornVector& values);

} // namespace Harmos::run
