// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_KktAudit.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// Of a contact point: without friction, or what that does.
enum class Friction : unsigned char { None, Sticks, Slips };

/// The state of a contact point in the solution.
struct ContactState {
  double pressure; ///< force per tributary area
  double force;
  double gap; ///< that is left
  bool closed;
  Friction friction = Friction::None;
  fem::Point traction{}; ///< of friction, on the first body: force per tributary area
  fem::Point slip{};     ///< of the first body against the second, since the beginning of the run
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
  // With friction only.
  feti::TornVector traction, slip;                  ///< three numbers a node
  std::vector<std::vector<unsigned char>> friction; ///< 0 none, 1 sticks, 2 slips
};

/// Brings the states to the nodes; every copy of a node gets the same values. With node to node contact both
/// sides have them, with mortar coupling the side that carries the multipliers. Tractions and slips on the
/// second side are the negative ones.
/// Local.
ContactFields contactFields(const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states);

} // namespace Harmos::run
