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
  double sharedRows = 0.0;      ///< those that other ranks touch too
  int neighbours = 0;           ///< ranks that it exchanges them with
  double coarseDimension = 0.0; ///< n_c
  double coarseEntries = 0.0;   ///< of L
  bool isCoarseDistributed = false;
  double ownMotions = 0.0; ///< of its subdomains
};

struct StepSeconds {
  double vectors = 0.0, exchange = 0.0, reductions = 0.0, coarse = 0.0;
  double sum() const { return vectors + exchange + reductions + coarse; }
};

/// With P ranks, a tree t = 2 log₂P · latency:
///
///     vectors     40 passes · 8 rows/readBytes + overhead
///     exchange    4 (neighbours · latency + 8 sharedRows/bandwidth), for P > 1
///     reductions  2t
///     coarse      see CoarseModel
///
/// Exchanges and reductions as tests/unit/feti/test_communication.cpp counts them; the formulas are those of
/// tests/performance/performance_model.py, see docs/dual_operator.md. Guarded by
/// tests/unit/feti/test_step_model.cpp.
StepSeconds predictStep(const StepShape& shape, const StepRates& rates = {});

} // namespace Harmos::feti
