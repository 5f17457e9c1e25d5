// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_EffectCosts.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::scene {

/// Where bodies may touch each other and obstacles, and the rows that follow.
struct ContactSetup {
  /// The points of the inequality rows, in their order, which is that of the effects. The same on every rank.
  std::vector<contact::ContactPoint> points;
  std::vector<ConstraintRow> rows; ///< this rank's share, ties too
  std::vector<std::string> notes;  ///< what the user should know; sentences
};

/// Collects the constraints of all effects: they gather the surfaces that they name, pair them, and make the
/// rows.
/// @throws InputError on all ranks: surfaces that are empty or not manifolds, that do not match or never
///         meet.
/// @note Collective.
ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned, EffectCosts& costs);
ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
