// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::feti {

/// What a step of projected conjugate gradients with a preconditioner says to other ranks, and computes in
/// the coarse problem. The projector is applied three times in it, and the rows of equality once more.
///
/// The numbers are those that tests/unit/feti/test_communication.cpp and
/// tests/performance/messages/communication.py count at MPI; tests/performance/performance_model.py has them
/// too, in CALLS, and tests/unit/feti/test_step_model.cpp compares.
struct StepCalls {
  double exchanges = 0.0;       ///< of dual rows with neighbours: in and out of F, and of M⁻¹
  double coarseVectors = 0.0;   ///< collectives of a number for each motion of all subdomains
  double coarseExchanges = 0.0; ///< of numbers of motions with neighbours
  double coarseSolves = 0.0;    ///< with L or its transpose; distributed: products with own rows of A⁻
  double reductions = 0.0;      ///< of a few numbers
  double reducedNumbers = 0.0;  ///< in all of them
};

/// A reduction for G in each projection, solves on every rank.
constexpr StepCalls replicatedCalls{4.0, 4.0, 0.0, 7.0, 2.0, 8.0};
/// For each projection an exchange, an all-gather, a product and another exchange.
constexpr StepCalls distributedCalls{4.0, 4.0, 8.0, 4.0, 4.0, 10.0};

constexpr const StepCalls& callsOf(bool isCoarseDistributed) {
  return isCoarseDistributed ? distributedCalls : replicatedCalls;
}

} // namespace Harmos::feti
