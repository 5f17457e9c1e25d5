// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FormChoice.hpp"
#include "Harmos_StepModel.hpp"

namespace Harmos::feti {

/// Bodies before they are cut.
struct WholeBodies {
  double nodes = 0.0;
  int dofsPerNode = 3;
  int dimension = 3;     ///< of space
  double stencil = 15.0; ///< nodes that an equation couples, with its own
};

/// What a factorisation of one of so many compact parts needs. With m nodes a part that no other shares it
/// has m(1 + 3m^(−1/3)) nodes in space and m(1 + 2m^(−1/2)) in the plane, of which 6m^(2/3) and 4m^(1/2) are
/// at its boundary; of c components a node, L has 5.5c²m^(4/3) entries, in the plane c²m(3.4 log₂m − 13). In
/// space that is 0.87 to 1.16 of what parts of 230 to 2700 nodes of linear and quadratic tetrahedra have.
FactorizationEstimate typicalPart(const WholeBodies& bodies, double parts);

/// How many parts, the least expected seconds.
struct SubdomainChoice {
  int parts = 1;
  double seconds = 0.0;
};

/// Into how many parts bodies are cut where nobody says so: of k a rank, k = 1, 2, 3, 4, 6, 8, ..., that with
/// the least seconds by predict() and predictStep(), the cheapest form of each, and what the coarse problem
/// takes beside: its factors, of which an active set needs one, and of every part with m motions a·m/6 on all
/// ranks and b·m/6 shared between them, as is a where the coarse problem is distributed. With a = 1.8 ms and
/// b = 4.4 ms this follows half a ball of 306 000 tetrahedra in 24 to 384 parts on one rank and two.
///
/// The minimum is flat: twice or half as many take some 10 per cent more. Parts have 30 nodes at least; of
/// small bodies some ranks have none.
/// @param memoryMiB of each rank for factors, 0 for any: where that is too little, of the numbers that fit
/// the fastest, or else that which needs least. Local. Guarded by tests/unit/feti/test_subdomain_choice.cpp.
SubdomainChoice chooseSubdomains(const WholeBodies& bodies, int ranks, double memoryMiB,
                                 const MachineRates& rates = {});

} // namespace Harmos::feti
