// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_Comm.hpp>

#include <set>
#include <string>
#include <vector>

namespace Harmos::scene {

/// Names of boundary parts, body after body: all, and those that have sides.
struct PartNames {
  std::vector<std::set<std::string>> all, withSides;
};

/// @note Collective.
PartNames gatherPartNames(const Teuchos::Comm<int>& comm, std::size_t bodies,
                          const std::vector<OwnedSubdomain>& owned);

/// A boundary part of a body, over all ranks.
struct PartSummary {
  std::string body, part;
  fem::SidesGeometry geometry; ///< of its sides; none: it has nodes alone
};

/// All boundary parts, body after body: those that rules choose, then those of the mesh, by name. @note
/// Collective.
std::vector<PartSummary> boundaryPartsOf(const Teuchos::Comm<int>& comm, const Scene& scene,
                                         const std::vector<OwnedSubdomain>& owned);

/// Refuses bodies and boundary parts that effects name and that are not there, offering the nearest part, and
/// what the effects themselves refuse.
/// @throws InputError on all ranks.
/// @note Collective.
void checkBoundaryParts(const Teuchos::Comm<int>& comm, const Scene& scene,
                        const std::vector<OwnedSubdomain>& owned);

} // namespace Harmos::scene
