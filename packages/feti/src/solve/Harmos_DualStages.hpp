// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AdaptiveSpace.hpp"
#include "Harmos_DualProblem.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <functional>
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

} // namespace Harmos::feti
