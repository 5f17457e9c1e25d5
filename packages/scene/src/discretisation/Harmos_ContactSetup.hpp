// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintCollector.hpp"

#include <string>

namespace Harmos::scene {

/// Collects the constraints of all effects: they gather the surfaces that they name, pair them, and make the
/// rows.
/// @throws InputError on all ranks: surfaces that are empty or not manifolds, that do not match or never
///         meet.
/// @note Collective.
ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned, EffectCosts& costs);
ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned);

/// The same of deformed bodies: contacts of where they are now, in terms of how displacements change from
/// here; ties and equations as of the bodies at rest. Contacts may be apart; those of two surfaces are
/// mortar couplings.
/// @param atRest bodies, and what adhesion binds, which stays with what it was bound to. @param moved as
/// moved() makes them.
ContactSetup setUpMovedContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                               const ConstraintCollector::AtRest& atRest,
                               const std::vector<OwnedSubdomain>& moved, EffectCosts& costs);

/// What effects find wrong with deformed bodies in equilibrium, see FiniteBehaviour::fault(); empty: nothing.
/// @param moved as moved() makes them. @note Collective.
std::string faultOfMoved(const Teuchos::Comm<int>& comm, const Scene& scene,
                         const std::vector<OwnedSubdomain>& atRest, const std::vector<OwnedSubdomain>& moved);

} // namespace Harmos::scene
