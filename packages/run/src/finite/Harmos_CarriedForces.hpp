// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <map>
#include <tuple>
#include <vector>

namespace Harmos::run {

/// Forces of rows of B for other rows: contacts that are made anew where bodies have moved. A contact keeps
/// the force of the one that its effect had at the same node, turned as its normal has turned; one that is
/// new has none. Ties, equations and gluing rows stay what they are, equations that are locked at a time too.
///
/// Guarded by tests/unit/run/test_finite_displacements.cpp.
class CarriedForces {
 public:
  /// Of scenes with these effects, which have to outlive it.
  explicit CarriedForces(const scene::Scene& scene) : scene_(&scene) {}

  bool isEmpty() const { return !isKept_; }
  void clear();
  /// @param contact what the constraints are of. @note Collective.
  void keep(const feti::Constraints& constraints, const scene::ContactSetup& contact,
            const MultiVector& multiplier);
  /// What was kept, in the rows of these. @param springsFollow those of rows that are springs are what bounds
  /// make of them, of bodies that are where the contact is made. @note Collective.
  Teuchos::RCP<MultiVector> on(const feti::Constraints& constraints, const scene::ContactSetup& contact,
                               bool springsFollow = false) const;
  /// For checkpoints. @param constraints any of the run's. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const std::string& name,
                const feti::Constraints& constraints);

 private:
  using Key = std::tuple<std::size_t, long long, int>; // effect, node, side
  struct Force {
    double along = 0.0;  // the normal
    fem::Point across{}; // of friction: tangents are others where surfaces turn
    fem::Point normal{};
  };
  // Of a point of contact, of one of the tangents at it, or of an equation that is locked at a time.
  struct Row {
    long long number; // in B
    Key key;
    const ConstraintRow* row;
    const fem::Point *normal, *tangent; // or null
  };
  std::vector<Row> rowsOf(const feti::Constraints& constraints, const scene::ContactSetup& contact) const;

  const scene::Scene* scene_;
  bool isKept_ = false;
  std::map<Key, Force> ofPoints_; // of this rank, physical
  std::vector<double> rest_;      // of the rows that stay, scaled, in the order of this rank's
};

} // namespace Harmos::run
