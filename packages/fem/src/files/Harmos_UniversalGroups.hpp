// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace Harmos::fem::Details {

/// A group of an I-DEAS universal file: the numbers of its nodes and of its elements.
struct UniversalGroup {
  std::string name;
  std::vector<long long> nodes, elements;
};

/// Whether a file is one by its name: it ends with ".unv".
bool isUniversal(const std::string& path);

/// The groups of a file: datasets 2429, 2430, 2432 (entities by type and number) and 2435, 2452, 2467, 2477
/// (by four numbers each), as Salome and others write them. Entities of other types than nodes (7) and
/// elements (8) are passed over. Groups of one name are one. Local.
/// @throws InputError for a dataset that is cut off or is no numbers, naming its line.
/// Guarded by tests/regression/files/test_foreign_meshes.py.
std::vector<UniversalGroup> readUniversalGroups(const std::string& path);

} // namespace Harmos::fem::Details
