// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_KktAudit.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// The state of a contact point in the solution.
struct ContactState {
  double pressure; ///< force per tributary area
  double force;
  double gap; ///< that is left
  bool closed;
};

/// Of all points, in their order, on every rank.
/// @note Collective; the rows are gathered on every rank.
std::vector<ContactState> contactStates(const Teuchos::Comm<int>& comm,
                                        const std::vector<contact::ContactPoint>& points,
                                        const feti::ContactState& state);

/// Contact results at the nodes of this rank's subdomains, for output.
struct ContactFields {
  feti::TornVector pressure;                         ///< 0 where no point is
  feti::TornVector gap;                              ///< that is left, 0 where no point is
  std::vector<std::vector<unsigned char>> activeSet; ///< 0 where no point is, 1 open, 2 closed (force > 0)
};

/// Brings the states to the nodes; every copy of a node gets the same values. With node to node contact both
/// sides have them, with mortar coupling the side that carries the multipliers.
/// Local.
ContactFields contactFields(const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states);

} // namespace Harmos::run
