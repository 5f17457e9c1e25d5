// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// What is to be said where bodies move farther than the scene is large, by a rigid-body mode that nothing
/// holds but rounding errors of normals: the forces of such an answer may be right, its displacements are
/// not.
/// "" where none does.
/// @param u of this rank's subdomains. @note Collective.
/// Guarded by tests/unit/run/test_drift.cpp.
std::string driftText(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                      const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& u);

} // namespace Harmos::run
