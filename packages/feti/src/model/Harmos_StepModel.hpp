// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseModel.hpp"

namespace Harmos::feti {

/// What a step of projected conjugate gradients takes beside products with dense blocks and factors. The
/// overhead is fitted to tests/performance/scaling.py.
struct StepRates : CoarseRates {
  double overhead = 1e-4; ///< seconds of a step that depend on nothing
};

/// A step on the busiest of the ranks.
struct StepShape {
  int ranks = 1;
  double rows = 0.0;            ///< of dual vectors
  double sharedRows = 0.0;      ///< those that other ranks touch too, once for each of these
  int neighbours = 0;           ///< ranks that it exchanges them with
  double coarseDimension = 0.0; ///< n_c
  double coarseEntries = 0.0;   ///< of L; 0: coarseFactorEntries()
  bool isCoarseDistributed = false;
  double ownMotions = 0.0;    ///< of its subdomains
  double motions = 1.0;       ///< of a subdomain
  double sharedMotions = 0.0; ///< of other ranks' subdomains that its rows touch, and the other way round
  // Where subdomains are joined, motions are those of clusters; see ClusterModel.
  double clusterSize = 1.0; ///< subdomains of a cluster
  double joinBytes = 0.0;   ///< read to join them, in a product with F and one with the preconditioner
  double joinEntries = 0.0; ///< of L, LLᵀ = F₀, in the solves of these

  CoarseShape coarse() const;
};

struct StepSeconds {
  double vectors = 0.0, exchange = 0.0, reductions = 0.0, coarse = 0.0, joins = 0.0;
  double sum() const { return vectors + exchange + reductions + coarse + joins; }
};

/// What a step says to other ranks. A pair of exchanges, in and out, is a message to each neighbour.
struct StepCounts {
  double messages = 0.0, messageBytes = 0.0; ///< sent to neighbours
  double reductions = 0.0, gathers = 0.0;    ///< collective calls
  double collectiveBytes = 0.0;              ///< that come to a rank by them
};

/// With P ranks, a tree t = 2 log₂P · latency, and c = StepCalls:
///
///     vectors     40 passes · 8 rows/readBytes + overhead
///     exchange    c.exchanges (neighbours · latency + 8 sharedRows/bandwidth), for P > 1
///     reductions  c.reductions t
///     coarse      see CoarseModel
///     joins       joinBytes/readBytes + joinEntries/coarseEntries
///
/// The formulas are those of tests/performance/performance_model.py, see docs/dual_operator.md. Guarded by
/// tests/unit/feti/test_step_model.cpp, which compares with that program from 1 to 10⁵ ranks.
StepSeconds predictStep(const StepShape& shape, const StepRates& rates = {});

/// For P > 1, else nothing:
///
///     messages    (c.exchanges + c.coarseExchanges)/2 · neighbours
///     their bytes 8 (c.exchanges sharedRows + c.coarseExchanges sharedMotions)/2
///     bytes of collectives   8 (c.coarseVectors n_c + c.reducedNumbers), distributed P c.reducedNumbers
///
/// Counted at MPI by tests/performance/messages/communication.py.
StepCounts predictCounts(const StepShape& shape);

} // namespace Harmos::feti
