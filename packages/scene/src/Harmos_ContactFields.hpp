// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Decomposition.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_NodePairs.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Contact results at the nodes of this rank's subdomains, for output.
struct ContactFields {
  feti::TornVector pressure;                         ///< force per tributary length, 0 off the interface
  feti::TornVector gap;                              ///< c_I − B_I u, 0 off the interface
  std::vector<std::vector<unsigned char>> activeSet; ///< 0 off the interface, 1 open, 2 closed (force > 0)
};

/// Brings the state of the inequality rows to the nodes of both sides; every copy gets the same values.
/// @param pairs of the contact interfaces, in the order of the rows.
/// @note Collective; the rows of the interface are gathered on every rank.
ContactFields contactFields(const Teuchos::Comm<int>& comm, const std::vector<OwnedSubdomain>& owned,
                            const std::vector<contact::NodePair>& pairs, const feti::ContactState& state);

} // namespace Harmos::scene
