// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AdaptiveSpace.hpp"
#include "Harmos_DualProblem.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_SolverOptions.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::feti {

/// The stages of the dual problem in their order.
struct DualStages {
  Teuchos::RCP<const SubdomainSystem> system;
  Teuchos::RCP<const Constraints> constraints;
  Teuchos::RCP<const LocalInverses> inverses;
  Teuchos::RCP<const CoarseSpace> coarse;
  Teuchos::RCP<const DualProblem> problem;
  Teuchos::RCP<const Operator> preconditioner; ///< or null
  Teuchos::RCP<AdaptiveSpace> adaptive;        ///< vectors are made when they are needed; or null
};

/// The outcome of a solve of the dual problem.
struct SolveReport {
  std::string solver;  ///< the method that was chosen
  bool solved = false; ///< the solver has run
  bool converged = false;
  std::string reason = "not finished";
  qp::Result result;
  double gradientScale = 0.0; ///< ‖g^P‖ is measured against it
  double equalityScale = 0.0; ///< ‖Gλ‖ likewise, 0 without a coarse problem
  double dNorm = 0.0;         ///< ‖d‖
  /// Where ‖g^P‖ came down to the rounding errors of what rows give way by, and not to the tolerance: these
  /// as a share of the rule's scale. gradientScale is what they amount to then.
  double openingRounding = 0.0;
  int adaptiveVectors = 0;      ///< that the solver had in the end
  double adaptiveSeconds = 0.0; ///< that they took to make
};

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
};

/// Target values of the residuals.
struct DualTargets {
  double gradient = 0.0; ///< of ‖g^P‖
  double equality = 0.0; ///< of ‖Gλ‖, 0 without a coarse problem
};

/// A solve of the dual problem before its first iteration.
struct DualRun {
  DualStages stages;
  std::string method;
  std::function<DualTargets()> targets; ///< those of now: an acceptance may have made them stricter
};

/// Monitor of a solve of the dual problem.
class DualMonitor : public qp::SolverMonitor<MultiVector> {
 public:
  /// Before the first iteration, or before the state of an earlier run is asked for. @note Collective.
  virtual void begins(const DualRun& run) = 0;
  /// The next solve goes on where one has ended: its rows are counted on from the last one's.
  virtual void goesOnAfter(const qp::IterationRecord& /*last*/) {}
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
