// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::fem {

/// Which part each cell belongs to.
struct Partition {
  std::vector<int> part;          ///< of each cell
  int parts = 0;                  ///< not always as many as wanted
  std::vector<double> necks;      ///< of partitionCells(): width of each part's neck, see Neck
  std::vector<std::string> notes; ///< what was not as wanted; sentences
};

enum class PartitionMethod {
  Compact, ///< METIS' parts, rounded off and their necks mended: see roundOff(), mendNecks()
  Metis    ///< METIS' parts as they are
};

struct PartitionOptions {
  PartitionMethod method = PartitionMethod::Compact;
  int seed = 1; ///< of METIS' random numbers: another one gives another cut
};

/// Cuts a body into parts of about equally many cells with short boundaries.
///
/// METIS (Karypis, Kumar 1998) cuts the graph of the cells that share a side; mendParts() makes its parts
/// hang together. Components of the body that share no side are cut each by itself, at least one part each.
/// The same body gives the same partition.
///
/// Compact parts of bodies of many cells are cut on clusters of eight cells first (CellClusters). Half a ball
/// of 212 000 cells, three seeds, 24 to 384 parts: as many sides between parts (within 1 %) and necks as wide
/// as without clusters, in 0.5 to 0.9 of the time.
///
/// Guarded by tests/unit/fem/test_partition.cpp.
///
/// @param wanted number of parts.
/// @throws InputError if more parts are wanted than there are cells, or less than one.
Partition partitionCells(const BodyMesh& body, int wanted, const PartitionOptions& options = {});

/// The same, to the last cell, by all ranks, of a body that rank 0 has: large ones that hang together are cut
/// in two pieces first, and these by themselves.
/// @param body null on other ranks. @return on rank 0; nothing on others. @note Collective.
/// @throws InputError on all ranks, as above.
Partition partitionCells(const Teuchos::Comm<int>& comm, const BodyMesh* body, int wanted,
                         const PartitionOptions& options = {});

/// Makes parts whose cells are connected through sides, so that each is a solid: pieces that hang together in
/// a node, or in space in an edge, would have a mechanism (a hinge) in their kernel.
///
/// Of a part in pieces, the largest keeps its place; each other becomes a part of its own or, with fewer than
/// a tenth of the average part's cells, joins the neighbour that shares most sides with it. Parts are
/// numbered anew, in the order of their lowest cells; empty ones vanish.
///
/// @param part of each cell, any numbers.
Partition mendParts(const BodyMesh& body, const std::vector<int>& part);

} // namespace Harmos::fem
