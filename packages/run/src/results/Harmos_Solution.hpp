// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <vector>

namespace Harmos::run {

/// What a run finds: the meshes of this rank's subdomains, the displacements of their nodes, dof = node ·
/// components + component, and the multipliers.
struct Solution {
  std::vector<scene::OwnedSubdomain> owned;
  feti::TornVector displacement;
  Teuchos::RCP<const MultiVector> multipliers; ///< λ, in the rows of feti::Constraints
};

} // namespace Harmos::run
