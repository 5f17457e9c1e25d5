// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerQuality.hpp"
#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include "Harmos_MaterialStates.hpp"

#include <optional>
#include <vector>

namespace Harmos::run {

/// States of the materials of each subdomain with its displacements; empty: none has any.
using MaterialStates = std::vector<fem::MaterialStates>;

/// At the nodes of this rank's subdomains.
struct RecoveredStress {
  std::vector<std::vector<fem::Voigt>> stress;
  std::vector<std::vector<double>>
      states; ///< fem::MaterialLaw::shownState(); empty where no material has any
};
/// See fem::stressSums(): averaged over all cells of the body around a node, across subdomains; not across
/// bodies.
/// @param time at which the scene's magnitudes count: of its temperatures.
/// @note Collective.
RecoveredStress recoverStress(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                              const std::vector<scene::OwnedSubdomain>& owned,
                              const feti::TornVector& displacement, double time,
                              const MaterialStates& states = {});

/// Mean stresses of the cells of this rank's subdomains, see fem::cellStresses(). Local.
std::vector<std::vector<fem::Voigt>> cellStresses(const scene::Scene& scene,
                                                  const std::vector<scene::OwnedSubdomain>& owned,
                                                  const feti::TornVector& displacement, double time,
                                                  const MaterialStates& states = {});

/// Estimates by the recovered stresses how far the finite element solution is from that of the continuous
/// problem, in the energy norm √∫ σ : C⁻¹ : σ, of membranes √∫ |∇u|²; see fem::recoveryError().
/// @param time of temperatures; none: without any, of what displacements change by.
/// @param cells of each subdomain the squares of the errors of its cells, see fem::RecoveryError::cells;
/// null: not asked for. @note Collective.
feti::DiscretisationError estimateDiscretisationError(const Teuchos::Comm<int>& comm,
                                                      const scene::Scene& scene,
                                                      const std::vector<scene::OwnedSubdomain>& owned,
                                                      const feti::TornVector& displacement,
                                                      std::optional<double> time,
                                                      std::vector<std::vector<double>>* cells = nullptr);

} // namespace Harmos::run
