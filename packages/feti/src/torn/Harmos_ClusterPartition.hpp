// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

namespace Harmos::feti {

/// Subdomains of a rank that share dofs with each other alone, and how many.
struct SubdomainLink {
  int first, second; ///< subdomains of the rank, the first one lower
  int weight;
};

/// Groups of about so many subdomains that hang together by links.
///
/// Where centres stand on a grid, bricks of it, about as long as wide; else of sections of their box, of
/// METIS' parts of the graph of the links, and of both made compact, that which cuts few links and is
/// compact; without centres METIS' parts. What of a group does not hang together with its largest piece joins
/// the group that it has most links with, or is one of its own.
/// @param centres of each subdomain; none at all: METIS. @param size of a group; 0: as large as there are.
/// @return members by rising subdomains, groups by their first. Local.
/// Guarded by tests/unit/feti/clusters/test_clusters.cpp.
std::vector<std::vector<int>> partitionIntoClusters(int subdomains, const std::vector<SubdomainLink>& links,
                                                    const std::vector<std::array<double, 3>>& centres,
                                                    int size);

} // namespace Harmos::feti
