// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_Mesh.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::contact {

/// A node of a boundary part, as one subdomain sees it.
struct SurfaceNode {
  long long node; ///< global number; copies on several subdomains have the same
  double position[3];
  double length; ///< half of the lengths of its surface edges in this subdomain
};

/// The nodes of a named boundary part of a placed mesh; empty if the subdomain has none. Local.
std::vector<SurfaceNode> surfaceNodes(const fem::PlacedMesh& mesh, const std::string& set);

/// Two opposite nodes of matching surfaces.
struct NodePair {
  long long first;  ///< node of the first body
  long long second; ///< node of the second body
  double gap;       ///< initial distance, 0 for surfaces in touch
  double length;    ///< tributary length of the node on the first surface: force / length = pressure
};

/// Pairs the nodes of two surfaces that match node to node.
///
/// Every rank gets all pairs, ordered along the surface by position, whatever the number of ranks. The
/// surfaces are gathered on every rank: their size is that of a boundary, not of a body.
///
/// @param first, second this rank's nodes; copies allowed, their lengths are added up.
/// @param tolerance of the positions, relative to the extent of the surfaces.
/// @throws InputError on all ranks if a surface is empty or a node of either has no partner, naming it.
/// @note Collective.
/// Guarded by tests/unit/contact/test_node_pairs.cpp.
std::vector<NodePair> pairNodes(const Teuchos::Comm<int>& comm, const std::vector<SurfaceNode>& first,
                                const std::vector<SurfaceNode>& second, const std::string& what,
                                double tolerance = 1e-9);

/// Scalar contact u² − u¹ ≥ −gap: rows u¹ − u² ≤ gap. Row k is given on rank k mod ranks.
std::vector<ConstraintRow> contactRows(const Teuchos::Comm<int>& comm, const std::vector<NodePair>& pairs);

/// Scalar tie: rows u¹ − u² = 0. Row k is given on rank k mod ranks.
std::vector<ConstraintRow> tieRows(const Teuchos::Comm<int>& comm, const std::vector<NodePair>& pairs);

} // namespace Harmos::contact
