// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerQuality.hpp"
#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// Stresses at the nodes of this rank's subdomains (see fem::stressSums()), averaged over all cells of the
/// body around a node, across subdomains; not across bodies.
/// @param time at which the scene's magnitudes count: of its temperatures.
/// @note Collective.
std::vector<std::vector<fem::Voigt>> recoverStress(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                                                   const std::vector<scene::OwnedSubdomain>& owned,
                                                   const feti::TornVector& displacement, double time);

/// Mean stresses of the cells of this rank's subdomains, see fem::cellStresses(). Local.
std::vector<std::vector<fem::Voigt>> cellStresses(const scene::Scene& scene,
                                                  const std::vector<scene::OwnedSubdomain>& owned,
                                                  const feti::TornVector& displacement, double time);

/// Estimates by the recovered stresses how far the finite element solution is from that of the continuous
/// problem, in the energy norm √∫ σ : C⁻¹ : σ, of membranes √∫ |∇u|²; see fem::recoveryError().
/// @note Collective.
feti::DiscretisationError estimateDiscretisationError(const Teuchos::Comm<int>& comm,
                                                      const scene::Scene& scene,
                                                      const std::vector<scene::OwnedSubdomain>& owned,
                                                      const feti::TornVector& displacement, double time);

} // namespace Harmos::run
