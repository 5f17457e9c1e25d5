// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectCosts.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Subdomains begin ... end − 1 of a rank.
struct Share {
  long long begin;
  long long end;
};

/// Blocks of consecutive numbers, as equal as possible; ranks beyond the number of subdomains have none.
Share shareOf(int rank, int ranks, long long subdomains);

/// How the subdomains of a body are numbered, which says what a rank's share of them is.
enum class Numbering {
  AsMade, ///< as generators and cuts of meshes have them
  Compact ///< so that shares are compact, by compactOrder(): as clusters of a rank's subdomains need them
};

/// The subdomains of this rank, see shareOf(), with the boundary parts that the scene's rules choose. Meshes
/// that rank 0 alone has are distributed.
/// @throws InputError on all ranks for rules that choose nothing.
/// @note Collective.
std::vector<OwnedSubdomain> decompose(const Teuchos::Comm<int>& comm, const Scene& scene,
                                      Numbering numbering = Numbering::AsMade);

/// OwnedSubdomain::measures of the parts that effects measure: decompose() has made them, subdomains that
/// have moved have others. @note Collective.
void measureParts(const Teuchos::Comm<int>& comm, const Scene& scene, std::vector<OwnedSubdomain>& owned);

/// Stiffness, load, kernel and Dirichlet conditions of each, with what the effects add to them. Subdomains
/// that share a mesh share the matrix.
/// @throws InputError for materials out of range and cells that are inverted or have no area, naming body,
///         cell and place.
/// Local.
std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned,
                                      EffectCosts& costs);
std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
