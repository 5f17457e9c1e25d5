// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::scene {

/// Where bodies may touch each other and obstacles, and the rows that follow.
struct ContactSetup {
  /// Of all contact interfaces, then all obstacles: the points of the inequality rows, in their order. The
  /// same on every rank.
  std::vector<contact::ContactPoint> points;
  std::vector<ConstraintRow> rows; ///< this rank's share, ties too
  std::vector<std::string> notes;  ///< what the user should know; sentences
};

/// Gathers the surfaces that the scene names, pairs them, and makes the rows.
/// @throws InputError on all ranks: surfaces that are empty or not manifolds, that do not match or never
///         meet.
/// @note Collective.
ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
