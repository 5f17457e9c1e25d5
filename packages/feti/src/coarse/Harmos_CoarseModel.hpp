// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StepModel.hpp"

namespace Harmos::feti {

class SubdomainSystem;

/// What a coarse problem costs depends on.
struct CoarseShape {
  double dimension = 0.0; ///< n
  double motions = 1.0;   ///< of a subdomain: 1 of a membrane, 3 in the plane, 6 in space
  int ranks = 1;
  double mostOwn = 0.0; ///< motions of a rank
};
/// @note Collective.
CoarseShape shapeOf(const SubdomainSystem& system);

/// Entries of L, LLᵀ = G̃G̃ᵀ, in the order of nested dissection, of n/m subdomains of a body in the plane (m =
/// 1 or 3) or in space: m²·N·(a + b·log₂N) and m²·(a·N + b·N^(4/3)) of N subdomains, fitted to generated
/// blocks (tests/performance/coarse_problem.cpp).
double coarseFactorEntries(const CoarseShape& shape);

/// Ranks of a group that factors a distributed coarse problem: two, or as many as its factors need.
int coarseGroup(const CoarseShape& shape);

/// Seconds of one application of the projector, with what each rank has whole or in shares:
///
///     replicated    2 t + 16 n/bandwidth + 4 entries/rate                 an all-reduce, both solves
///     distributed   t + 8 n/bandwidth + 8 n·own/readBytes + 4 latency     an all-gather, rows of A⁻, two
///                                                                         exchanges with neighbours
///
/// with a tree t = latency·log₂(ranks) and the rate of StepRates.
double replicatedCoarseSeconds(const CoarseShape& shape, const StepRates& rates);
double distributedCoarseSeconds(const CoarseShape& shape, const StepRates& rates);
bool isDistributedCheaper(const CoarseShape& shape, const StepRates& rates);

/// Whether a distributed factor is better solved with than inverted: its rows would need too much memory, or,
/// on a face, more solves than they save.
bool coarseSolves(const CoarseShape& shape, int groupSize, bool isFace);

} // namespace Harmos::feti
