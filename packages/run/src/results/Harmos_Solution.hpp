// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Quantity.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <optional>
#include <vector>

namespace Harmos::run {

/// What a run finds: the meshes of this rank's subdomains, the displacements of their nodes, dof = node ·
/// components + component, and the multipliers.
struct Solution {
  std::vector<scene::OwnedSubdomain> owned;
  feti::TornVector displacement;
  Teuchos::RCP<const MultiVector> multipliers;          ///< λ, in the rows of feti::Constraints
  std::optional<QuantityValue> quantity = std::nullopt; ///< where options ask for one, and the run converged
};

} // namespace Harmos::run
