// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_EffectCosts.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_QpTypes.hpp"

#include <map>
#include <string>
#include <vector>

namespace Harmos::scene {

/// What is known of a run, finished or failed: the content of summary.json.
struct RunReport {
  std::string deck;
  int ranks = 0;
  std::string scene;
  std::vector<std::string> effects;
  std::vector<EffectCost> effectCosts; ///< of each kind, once the constraints are set up
  long long primalDimension = 0;
  long long dualDimension = 0;
  long long inequalities = 0;
  int kernelDimension = 0;
  int coarseDimension = 0;
  long long subdomains = 0;
  long long distinctFactorizations = 0;
  std::string dualOperator;
  double localCondition = 0.0;  ///< largest estimate of κ(K_i) on the complement of the kernel
  double dualOperatorMiB = 0.0; ///< factors and dense blocks of all ranks
  std::string solver;
  std::string stoppingRule;
  std::string toleranceRule;
  bool solved = false; ///< the solver has run
  bool converged = false;
  std::string reason = "not finished";
  qp::Result result;
  double gradientScale = 0.0;    ///< ‖g^P‖ is measured against it
  double equalityScale = 0.0;    ///< ‖Gλ‖ likewise, 0 without a coarse problem
  double tolerance = 0.0;        ///< asked for, or chosen by the rule "balanced"
  double reachedTolerance = 0.0; ///< below that, where the audit asked for more
  // Estimates in the energy norm; 0 where they were not made.
  double solverError = 0.0;         ///< with a preconditioner; see AnswerCheck
  double discretisationError = 0.0; ///< rule "balanced" only, relative to the solution
  double allowedError = 0.0;        ///< likewise: what that rule allows the solver
  double dNorm = 0.0;               ///< ‖d‖
  double gapRounding = 0.0;         ///< gaps are known up to this: they are differences of coordinates
  bool audited = false;
  feti::KktAudit audit;
  // With inequalities; the same on every rank. For what applications make of them.
  std::vector<contact::ContactPoint> contactPoints;
  std::vector<ContactState> contact;     ///< of each point
  std::map<std::string, double> results; ///< of the application
  std::map<std::string, double> seconds;
  double peakMemoryMiB = 0.0;
};

/// summary.json as text.
std::string toJson(const RunReport& report);

/// Whether the audit bears out that a run has converged. The solver's residuals and the audit are about the
/// same errors in other units: a factor of a hundred in the jumps, or in the error in the energy norm where
/// it is estimated, is beyond what norms and scalings explain, and a tenth of the solution is too much by any
/// tolerance; forces out of balance by half the load are no solution by any rule. Where the rule "balanced"
/// chose the tolerance, the error that it allows is what the run claims. A number that is none objects.
/// Guarded by tests/unit/scene/test_pipeline.cpp.
bool auditAgrees(const RunReport& report);

/// The audit and the timing, for people.
std::string auditText(const RunReport& report);
std::string timingText(const RunReport& report, const std::vector<std::string>& stages);

} // namespace Harmos::scene
