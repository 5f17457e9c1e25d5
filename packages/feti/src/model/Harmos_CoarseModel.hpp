// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::feti {

class RigidMotions;

/// What the coarse problem's costs are computed with. Rates of solves and of reading are those of one core of
/// an AMD EPYC with two cores in use (tests/performance/coarse_factor, dual_operator). Latency and bandwidth
/// are assumptions about a common cluster and not measured.
struct CoarseRates {
  double readBytes = 1.9e10;       ///< a second, of vectors
  double coarseEntries = 1.1e9;    ///< of L a second in coarse solves, while L is in cache
  double coarseFromMemory = 2.5e8; ///< the same, when it is not
  double latency = 2e-6;           ///< seconds of a message
  double bandwidth = 1e10;         ///< bytes a second between two ranks
};

/// Up to so many rows a factor of the coarse problem is dense.
constexpr int mostDenseCoarseRows = 200;

/// What a coarse problem costs depends on.
struct CoarseShape {
  double dimension = 0.0; ///< n
  double motions = 1.0;   ///< of a subdomain: 1 of a membrane, 3 in the plane, 6 in space
  int ranks = 1;
  double mostOwn = 0.0;       ///< motions of a rank
  double factorEntries = 0.0; ///< of L; 0: coarseFactorEntries()
  double neighbours = -1.0;   ///< ranks that a rank exchanges motions with; less than 0: likelyNeighbours()

  bool isInSpace() const { return motions > 3.5; }
};
/// @note Collective.
CoarseShape shapeOf(const RigidMotions& motions);

/// Entries of L, LLᵀ = G̃G̃ᵀ, of N = n/m subdomains on a grid, each coupled to all that it touches:
///
///     up to 200 rows           n(n + 1)/2: dense, see CoarseFactor
///     plane, m = 3             m²N max(3.6 log₂N − 15.5, 1.35 log₂N)
///     plane, m = 1             N max(3.6 log₂N − 11.2, 1.35 log₂N): joined fronts store zeros
///     space, x = N^(1/3)       m²N·0.8x² up to x = 6, then m²N·9.6 (x − 3)
///
/// Nested dissection of a square takes (31/8) N log₂N and less (George, SIAM J. Numer. Anal. 10, 1973), of a
/// cube N^(4/3) by a constant; these are fitted to what SparseCholesky has: to 15 per cent of it with
/// 16² and 32² subdomains and 4³ to 8³.
double coarseFactorEntries(const CoarseShape& shape);

/// Ranks whose subdomains touch those of a rank, if its share is about a square or a cube: 8 and 26 at most.
double likelyNeighbours(const CoarseShape& shape);

/// Ranks of a group that factors a distributed coarse problem: two, or as many as its factors need.
int coarseGroup(const CoarseShape& shape);

/// Seconds of a step of projected conjugate gradients in the coarse problem, with t = latency·log₂(ranks) and
/// c = StepCalls:
///
///     replicated   c.coarseVectors (2 t + 16 n/bandwidth) + c.coarseSolves·entries/rate
///     distributed  c.coarseVectors·t + 8 (c.coarseVectors·n + c.reducedNumbers·P)/bandwidth
///                  + c.coarseExchanges·neighbours·latency
///                  + c.coarseSolves·8 n·own/readBytes, or where groups solve, coarseSolves(),
///                    c.coarseSolves·2 entries/(coarseFromMemory·√group)
///
/// A reduction of n numbers and solves with L or Lᵀ, the rate by whether they are fewer than 5e5 entries; or
/// an all-gather, rows of A⁻, and exchanges with neighbours. That a group of g ranks solves √g times as fast
/// as one is an assumption. Guarded by tests/unit/feti/coarse/test_coarse_model.cpp.
double replicatedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates);
double distributedCoarseSeconds(const CoarseShape& shape, const CoarseRates& rates);
/// Whether a distributed one is worth while: from `fewestRanks` on, and where it takes half as long at most.
bool isDistributedCheaper(const CoarseShape& shape, const CoarseRates& rates);

/// Whether a distributed factor is better solved with than inverted: its rows would need too much memory, or,
/// on a face, more solves than they save.
bool coarseSolves(const CoarseShape& shape, int groupSize, bool isFace);

/// Bytes of a rank for A⁻: L in rectangles, with fronts while it is made, 16 entries; or its own rows of the
/// inverse, 8 n·own, or where groups solve its part of MUMPS' factor, 16 entries/group.
double coarseBytes(const CoarseShape& shape, bool isDistributed);
/// Bytes of a rank while rows of the inverse are made: its part of MUMPS' factor.
double coarseBytesOfSetup(const CoarseShape& shape, bool isDistributed);

/// Seconds to make A⁻ where one rank factors A in `factorization` seconds: those; distributed, in which
/// groups take no longer, and for the rows of their ranks 2 entries·own·group/(coarseEntries·√group), since
/// blocks of right-hand sides read L once. Of what coarse_factor takes on two ranks that is 0.95 (1024 rows)
/// and 1.7 (10000). @param isFace see coarseSolves().
double coarseSetupSeconds(const CoarseShape& shape, bool isDistributed, bool isFace, double factorization,
                          const CoarseRates& rates);

} // namespace Harmos::feti
