// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace Harmos::scene {

/// Reads a deck (XML, or YAML by the extension .yaml or .yml), applies assignments, validates and completes
/// it.
///
/// Done on rank 0 and broadcast: a fault is reported once, and no two ranks read different decks.
///
/// @param assignments "List/Sublist/Name=value", later ones win.
/// @param notes null or: on rank 0 a sentence for each name at an old place is added.
/// @throws InputError on all ranks: no such file, malformed, unknown or mistyped parameters.
/// @note Collective.
/// Guarded by tests/unit/scene/test_deck.cpp and tests/regression/test_command_line.py.
Teuchos::ParameterList readDeck(const Teuchos::Comm<int>& comm, const std::string& file,
                                const std::vector<std::string>& assignments, const ParameterSpec& spec,
                                std::vector<std::string>* notes = nullptr);

/// The first parameter, "List/Name", in which two decks differ, with both values; "" if there is none.
/// @param ignored lists and parameters that may differ. Local.
std::string firstDifference(const Teuchos::ParameterList& one, const Teuchos::ParameterList& other,
                            const std::vector<std::string>& ignored);

} // namespace Harmos::scene
