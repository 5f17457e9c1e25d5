// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"

#include <Teuchos_Comm.hpp>

#include <cstddef>
#include <vector>

namespace Harmos::fem {

/// Tears a body, or a block of one, into subdomains along the sides between its parts.
///
/// Nodes of a subdomain are numbered in the order they have in the body, and so are its cells; its anchor is
/// its first node. Boundary nodes are those on sides that no other cell of the subdomain shares, those that
/// other subdomains have as well, and the named ones. A set holds every local node of a named boundary part,
/// even where the subdomain touches the part with a node only: all copies of a node are in the same sets.
///
/// Guarded by tests/unit/fem/test_torn_body.cpp.
///
/// @param part of each cell, in 0…parts−1. @param firstNode global number of the body's first node.
std::vector<PlacedMesh> tear(const BodyMesh& body, const std::vector<int>& part, int parts,
                             long long firstNode);

/// All that a placed mesh holds, as bytes for a machine of the same kind.
std::vector<char> pack(const PlacedMesh& mesh);
/// The inverse of pack().
/// @throws InternalError if the bytes are not a whole mesh.
PlacedMesh unpack(const std::vector<char>& bytes);

/// Bytes that leave the first rank in one round of distribute(): well below what MPI counts, and small beside
/// the meshes that need more than one.
constexpr std::size_t distributionRound = std::size_t(1) << 28;

/// Sends subdomains from the first rank to their owners.
///
/// Bytes travel in rounds, so that neither the whole nor a single subdomain is limited by what MPI can count.
/// Meshes that subdomains share are sent with each of them, and stay shared on the first rank only.
///
/// @param onRoot all subdomains on rank 0; not looked at on the others.
/// @param owner rank of each subdomain; the same on all ranks.
/// @return this rank's subdomains, in their order.
/// @note Collective.
std::vector<PlacedMesh> distribute(const Teuchos::Comm<int>& comm, const std::vector<PlacedMesh>& onRoot,
                                   const std::vector<int>& owner,
                                   std::size_t bytesPerRound = distributionRound);

} // namespace Harmos::fem
