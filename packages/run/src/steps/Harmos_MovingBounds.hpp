// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_TimedLoads.hpp"

#include <vector>

namespace Harmos::run {

/// Bounds of rows that go with the histories of their effects, c(t) = c₁ + (h(t) − 1)m, with c₁ that of h = 1
/// and m the part that moves, see scene::ContactSetup::moving. Guarded by
/// tests/verification/physics/test_interference.py and test_bolts_and_sectors.py.
class MovingBounds {
 public:
  /// Both have to outlive it; the contact may become another one.
  MovingBounds(const scene::Scene& scene, const scene::ContactSetup& contact);

  /// Whether there are any; the same on all ranks.
  bool any() const { return any_; }
  /// @param rows of this rank, as ContactSetup has them: with the bounds of h = 1.
  void move(std::vector<ConstraintRow>& rows, double time) const;
  /// −Σλm of this rank's rows, for the one state of a run without steps, in which h = 1. Local.
  double product(const std::vector<double>& multipliers) const;
  /// Adds −Σλm to what prescribed values of the same history do by their forces: E = ½uᵀKu − fᵀu changes by
  /// −λ dc. @param multipliers λ of this rank's rows. @note Collective.
  void addProducts(const Teuchos::Comm<int>& comm, const std::vector<double>& multipliers,
                   const std::vector<scene::TimedLoads::Case>& cases,
                   scene::TimedLoads::Products& products) const;

 private:
  const scene::Scene& scene_;
  const scene::ContactSetup& contact_;
  bool any_;
};

} // namespace Harmos::run
