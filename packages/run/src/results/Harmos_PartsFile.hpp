// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryParts.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// The bodies' boundaries with their named parts, for a look before a run: sides as cells, by
/// io::VtkHdfWriter. Parts that have nodes alone are points.
///
/// Cell data: body; for each part one by its name ("block: top"; a slash becomes a bar), on it the part's
/// number, counted from 1, and 0 elsewhere; part, the least of these numbers, or 0.
/// @throws InputError on all ranks if the file cannot be written.
/// @note Collective.
/// Guarded by tests/regression/files/test_boundary_parts.py.
void writeParts(const Teuchos::Comm<int>& comm, const std::string& path, const scene::Scene& scene,
                const std::vector<scene::OwnedSubdomain>& owned,
                const std::vector<scene::PartSummary>& parts);

/// A line for each part: how many sides, how large, where. Local.
std::string partsText(const scene::Scene& scene, const std::vector<scene::PartSummary>& parts);

} // namespace Harmos::run
