// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::feti {

/// What a step of projected conjugate gradients with a preconditioner says to other ranks, and computes in
/// the coarse problem. The projector is applied twice in it, and scalars travel with it; each tenth step
/// takes two or three projections more, which are left out here.
///
/// The numbers are those that tests/unit/feti/test_communication.cpp and
/// tests/performance/messages/communication.py count at MPI; tests/performance/performance_model.py has them
/// too, in CALLS, and tests/unit/feti/test_step_model.cpp compares.
struct StepCalls {
  double exchanges = 0.0;       ///< of dual rows with neighbours: in and out of F, and of M⁻¹
  double coarseVectors = 0.0;   ///< collectives of a number for each motion of all subdomains
  double coarseExchanges = 0.0; ///< of numbers of motions with neighbours
  double coarseSolves = 0.0;    ///< with L or its transpose; distributed: products with own rows of A⁻
  double reductions = 0.0;      ///< of a few numbers, by themselves
  double reducedNumbers =
      0.0; ///< that are summed, in all collectives; in an all-gather those of each rank come
};

/// A reduction for G in each projection, with scalars; solves on every rank.
constexpr StepCalls replicatedCalls{4.0, 2.0, 0.0, 4.0, 0.0, 6.0};
/// For each projection an exchange, an all-gather with scalars, a product and another exchange.
constexpr StepCalls distributedCalls{4.0, 2.0, 4.0, 2.0, 0.0, 6.0};

constexpr const StepCalls& callsOf(bool isCoarseDistributed) {
  return isCoarseDistributed ? distributedCalls : replicatedCalls;
}

} // namespace Harmos::feti
