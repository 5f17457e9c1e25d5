// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// What is to be said where bodies move farther than the scene is large, by a rigid-body mode that hardly
/// anything holds: the forces of such an answer may be right, its displacements are not. "" where none does:
/// where bodies deform as much, as with loads that are not to scale, or follow what is prescribed, they do
/// not drift.
/// @param u of this rank's subdomains. @param prescribed the largest displacement of this rank that is.
/// @note Collective.
/// Guarded by tests/unit/run/test_drift.cpp.
std::string driftText(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                      const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& u,
                      double prescribed);

} // namespace Harmos::run
