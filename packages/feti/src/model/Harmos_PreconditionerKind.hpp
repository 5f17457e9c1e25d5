// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::feti {

/// Approximations of the inverse of F.
enum class PreconditionerKind {
  None,
  Lumped, ///< K_bb in the place of S: cheap, weaker
  Dirichlet ///< S = K_bb − K_bi K_ii⁻¹ K_ib: what makes the condition number grow like (1 + log(H/h))² only
};

/// How the copies of a dof share a jump.
enum class PreconditionerScaling {
  Multiplicity, ///< equally: D is the same at all copies of a dof, and drops out
  Stiffness ///< the softer copy takes more of it: D = diag(K); for materials that jump across an interface
};

} // namespace Harmos::feti
