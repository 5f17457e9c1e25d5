// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualStages.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_SolverOptions.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace Harmos::feti {

/// The answer to the dual problem.
struct DualSolution {
  Teuchos::RCP<MultiVector> lambda;
  std::vector<double> mu; ///< this rank's entries of the multiplier of the equality rows
  /// Whether no forces can hold the bodies; then the amplitudes of the rigid motion that escapes, a vector of
  /// motions (CoarseSpace).
  bool isEscaping = false;
  std::vector<double> escape;
};

/// Where to start: the solution of a problem nearby.
struct WarmStart {
  Teuchos::RCP<const MultiVector> multiplier; ///< λ + λ̃; what G sees of them is not used
  std::vector<double> mu;                     ///< of Gλ = 0: without it active sets are guessed wrong
  /// Points that slip in it start at their limits, else they begin as points that stick: rounding errors of
  /// the projection take them off. For solutions of which most points slip on.
  bool keepsLimits = false;
};

/// The verdict of an acceptance test on a solution.
struct Verdict {
  std::optional<double> next; ///< the tolerance to go on to; nothing: the answer is accepted
  /// With a tolerance to go on to: the answer is accepted all the same if the solver comes no further.
  bool isEnough = false;
};

/// Decides on what meets a tolerance. Collective.
struct Acceptance {
  /// Is asked about λ and μ that just meet a tolerance; null: they are accepted.
  std::function<Verdict(const MultiVector& lambda, const std::vector<double>& mu, double tolerance)> judge;
  /// What it knows, for checkpoints; or null.
  std::function<void(qp::StateArchive<MultiVector>& archive)> exchange;
  int iterationsBefore = 0; ///< of a solve that this one goes on from
};

/// Hands the dual problem to the quadratic programming layer, with the solver, stopping rule and
/// preconditioner of the options, and puts what became of it into the report.
/// @param start or null: as the options say. @param acceptance is not asked
/// about answers of the penalty method. @param monitor or null; with a state to go on from, in the place of
/// `start`.
/// @throws NumericalError, InternalError on all ranks. @note Collective.
DualSolution solveDualProblem(const DualStages& stages, const SolverOptions& options, const WarmStart* start,
                              const Acceptance& acceptance, const Log& log, SolveReport& report,
                              const Teuchos::RCP<DualMonitor>& monitor = Teuchos::null);

/// Where nothing holds a rigid motion: the parts of the torn problem that move with it, by the squares of
/// their amplitudes those above a hundredth of the largest amplitude. A part may be a subdomain or a body.
/// @param escape of DualSolution. @param partOf a number, from zero to below `parts`, for each subdomain of
/// this rank. @note Collective. Guarded by tests/unit/feti/test_feti_solver.cpp.
std::vector<long long> escapingParts(const RigidMotions& motions, const std::vector<double>& escape,
                                     const std::vector<long long>& partOf, long long parts);

} // namespace Harmos::feti
