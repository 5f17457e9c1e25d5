// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"
#include "Harmos_EffectRegistry.hpp"

namespace Harmos::app {

/// What decks may say of it. It stands for effects of other kinds: withAutomaticContacts() puts these in its
/// place before effects are made.
scene::EffectKind kindOfAutomaticContact();

/// Contacts between all bodies that are near each other, as lists of "Effects": the deck with a Contact, and
/// where it is wanted a Friction, for each pair of bodies with sides that face each other, see
/// scene::facedBodies(). Each body has a part "facing <the other body>", by a rule that the scene gets. The
/// body with more such sides is the first one. Pairs that a Contact or Tie of the deck names are left out.
/// What was found is told in the log.
///
/// Meshes are distributed once more for this; decks without the list come back as they are.
///
/// @param scene with its bodies. @throws InputError for bodies that are not there. @note Collective.
/// Guarded by tests/regression/models/test_automatic_contact.py.
Teuchos::ParameterList withAutomaticContacts(const DeckContext& context,
                                             const scene::EffectRegistry& registry, scene::Scene& scene);

} // namespace Harmos::app
