// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Recovery.hpp"

#include <vector>

namespace Harmos::feti {

/// The forces by which Dirichlet conditions hold the torn problem,
///
///     r = Ku − f + Bᵀλ  at each fixed dof of each subdomain,
///
/// of the physical K and f, without trivial equations, and of the given rows of B in full: also what they
/// were at prescribed values before these left them. The multipliers of gluing and Dirichlet rows take no
/// part: gluing ones cancel over the copies of a dof, Dirichlet ones are −r. The force on a dof is the sum
/// over its copies.
/// @return of each subdomain of this rank a force for each of Subdomain::fixed; a dof that is fixed twice has
///         it twice.
/// @note Collective.
/// Guarded by tests/unit/feti/test_reactions.cpp.
std::vector<std::vector<double>> reactions(const SubdomainSystem& system, const Constraints& constraints,
                                           const TornSolution& solution);

} // namespace Harmos::feti
