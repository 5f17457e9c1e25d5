// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// Equations that are locked at a time of the run, see scene::ContactSetup::Lock: without force until then,
/// and with the value that they have then as their bound from there on. Values are those of accepted steps.
/// Of finite displacements terms change, as the direction of a bolt does, and the contact with them.
///
/// Guarded by tests/verification/physics/test_pretension.py.
class Locks {
 public:
  /// All have to outlive it.
  Locks(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
        const std::vector<scene::OwnedSubdomain>& owned, int components);

  /// Whether there are any; the same on all ranks.
  bool any() const { return !contact_.locks.empty(); }
  /// @param rows of this rank, as this contact has them; at the end of a step. Local.
  void apply(const scene::ContactSetup& contact, std::vector<ConstraintRow>& rows, double time) const;
  /// A step that ends at this time was accepted. @return what locks then, for people; "": nothing.
  /// @note Collective.
  std::string commit(double time, const feti::TornVector& displacement);
  /// For checkpoints.
  void exchange(qp::StateArchive<MultiVector>& archive);

 private:
  bool isLocked(std::size_t lock, double time) const;
  double valueOf(const scene::ContactSetup::Lock& lock, const feti::TornVector& displacement) const;

  const Teuchos::Comm<int>& comm_;
  const scene::ContactSetup& contact_;
  const std::vector<scene::OwnedSubdomain>& owned_;
  int components_;
  std::vector<double> values_; // of each lock, when the last step was accepted
};

} // namespace Harmos::run
