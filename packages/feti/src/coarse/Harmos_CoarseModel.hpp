// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::feti {

class SubdomainSystem;

/// What the coarse problem's costs are computed with. Rates of solves and of reading are those of one core of
/// an AMD EPYC with two cores in use (tests/performance/coarse_problem, dual_operator). Latency and bandwidth
/// are assumptions about a common cluster and not measured.
struct CoarseRates {
  double readBytes = 1.9e10;       ///< a second, of vectors
  double coarseEntries = 1.1e9;    ///< of L a second in coarse solves, while L is in cache
  double coarseFromMemory = 2.5e8; ///< the same, when it is not
  double latency = 2e-6;           ///< seconds of a message
  double bandwidth = 1e10;         ///< bytes a second between two ranks
};

/// What a coarse problem costs depends on.
struct CoarseShape {
  double dimension = 0.0; ///< n
  double motions = 1.0;   ///< of a subdomain: 1 of a membrane, 3 in the plane, 6 in space
  int ranks = 1;
  double mostOwn = 0.0;       ///< motions of a rank
  double factorEntries = 0.0; ///< of L; 0: coarseFactorEntries()
};
/// @note Collective.
CoarseShape shapeOf(const SubdomainSystem& system);

/// Entries of L, LLᵀ = G̃G̃ᵀ, in the order of nested dissection, of N = n/m subdomains in the plane (m = 1 or
/// 3) or in space: m²·N·(2 + 2 log₂N) and m²·(10 N + 1.5 N^(4/3)), about.
double coarseFactorEntries(const CoarseShape& shape);

/// Ranks of a group that factors a distributed coarse problem: two, or as many as its factors need.
int coarseGroup(const CoarseShape& shape);

/// Seconds of a step of projected conjugate gradients, which applies the projector four times, in the coarse
/// problem, with t = latency·log₂(ranks):
///
///     replicated    4 (2 t + 16 n/bandwidth) + 7 entries/rate
///     distributed   4 (t + 8 n/bandwidth + 8 n·own/readBytes + 4 latency)
///
/// A reduction of n numbers and solves with L and Lᵀ, the rate by whether they are fewer than 5e5; or an
/// all-gather, rows of A⁻, and two exchanges with neighbours. Guarded by
/// tests/unit/feti/coarse/test_coarse_model.cpp.
double replicatedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates);
double distributedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates);
/// Whether a distributed one is worth while: from `fewestRanks` on, and where it takes half as long at most.
bool isDistributedCheaper(const CoarseShape& shape, const CoarseRates& rates);

/// Whether a distributed factor is better solved with than inverted: its rows would need too much memory, or,
/// on a face, more solves than they save.
bool coarseSolves(const CoarseShape& shape, int groupSize, bool isFace);

} // namespace Harmos::feti
