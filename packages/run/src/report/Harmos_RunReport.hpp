// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_EffectCosts.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_ForceErrors.hpp"
#include "Harmos_Forces.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_SlipStates.hpp"
#include "Harmos_StepTable.hpp"

#include <map>
#include <string>
#include <vector>

namespace Harmos::run {

/// How wrong the forces of an effect with rows are, of a contact, an obstacle or a tie with its friction and
/// adhesion; see feti::forceErrors().
struct PairError : feti::ForceError {
  std::string path; ///< of the effect, see scene::Scene::effectPaths()
};

/// What is known of a run, finished or failed: the content of summary.json.
struct RunReport : feti::SolveReport {
  std::string deck;
  int ranks = 0;
  std::string scene;
  std::vector<std::string> effects;
  std::vector<scene::EffectCost> effectCosts; ///< of each kind, once the constraints are set up
  long long primalDimension = 0;
  long long dualDimension = 0;
  long long inequalities = 0;
  long long limited = 0; ///< rows of friction
  int kernelDimension = 0;
  int coarseDimension = 0;
  bool isCoarseDistributed = false;
  long long subdomains = 0;
  long long clusters = 0; ///< that they are joined to, of all ranks; 0: none
  long long distinctFactorizations = 0;
  long long roundedFactorizations = 0; ///< of them, with products in single precision
  std::string localSolver;             ///< of the subdomains
  std::string dualOperator;
  std::string dualForms;        ///< feti::DualForms, for checkpoints
  bool isSingle = false;        ///< whether local factors are in single precision, as the deck asks for
  double localDefect = 0.0;     ///< largest ‖KK⁺Kx − Kx‖/‖Kx‖
  double localCondition = 0.0;  ///< largest estimate of κ(K_i) on the complement of the kernel
  double dualOperatorMiB = 0.0; ///< factors and dense blocks of all ranks
  std::string stoppingRule;
  std::string toleranceRule;
  double tolerance = 0.0;        ///< asked for, or chosen by the rule "balanced"
  double reachedTolerance = 0.0; ///< below that, where the audit asked for more
  // Estimates in the energy norm; 0 where they were not made.
  double solverError = 0.0;          ///< with a preconditioner; see AnswerCheck
  double discretisationError = 0.0;  ///< rule "balanced" only, relative to the solution
  double allowedError = 0.0;         ///< likewise: what that rule allows the solver
  double gapRounding = 0.0;          ///< gaps are known up to this: they are differences of coordinates
  std::vector<PairError> pairErrors; ///< estimates, of each effect with rows, in the order of the scene
  bool audited = false;
  feti::KktAudit audit;
  Forces forces;                ///< audited runs only; the same on every rank
  std::vector<StepRow> steps;   ///< that were accepted, or the one there is
  long long factorisations = 0; ///< numerical ones of subdomains, on all ranks, in the whole run
  // With inequalities: those of this rank. For what applications make of them; see gatherContact().
  std::vector<contact::ContactPoint> contactPoints;
  std::vector<ContactState> contact;     ///< of each point
  std::vector<RowSlip> slips;            ///< of each limited row; only where there is friction
  ContactCounts contactCounts;           ///< of all ranks
  long long bonds = 0;                   ///< points that adhesion binds, of all ranks
  std::map<std::string, double> results; ///< of the application
  std::map<std::string, double> seconds;
  double peakMemoryMiB = 0.0;
  std::string restartedFrom;   ///< the checkpoint, "" for none
  int checkpoints = 0;         ///< written by this run
  std::string checkpoint;      ///< the last one
  std::string checkpointFault; ///< why the last one is not there, "" if it is
  bool isInterrupted() const { return solved && result.reason == qp::Reason::Interrupted; }
};

/// The row of an answer that has been audited; step and time are left.
StepRow stepRow(const RunReport& report, const EnergyAccount& energy);

/// summary.json as text.
std::string toJson(const RunReport& report);

/// Whether the audit bears out that a run has converged: feti::auditAgrees() with the share of the tolerance.
/// Where the rule "balanced" chose it, the error that the rule allows is what the run claims.
/// Guarded by tests/unit/run/test_pipeline.cpp.
bool auditAgrees(const RunReport& report);

/// What is wrong where the force of a constraint row is beyond all that bodies feel; "" where none is.
/// auditAgrees() objects then. Guarded by tests/unit/run/test_row_forces.cpp.
std::string rowForceText(const RunReport& report);

/// What the acceptance of an answer allows the error of a pair's forces to be, in a run that has been
/// audited: as share of these forces what auditAgrees() allows jumps of displacements, a hundred tolerances
/// and a tenth at most. Of forces below 1e-5 of all forces of the scene that share of 1e-5: what presses that
/// little may press by nothing but rounding errors, and there would be no end. Beside it what rounding errors
/// of displacements and gaps make of forces. Guarded by tests/unit/run/test_pair_errors.cpp.
double allowedForceError(const RunReport& report, const PairError& pair);

/// Which pairs have forces that may be wrong by a share of more than 0.01, and than auditAgrees() allows:
/// sentences, "" for none.
std::string doubtfulForces(const RunReport& report);

/// What share rounding errors leave of an answer's accuracy at least, by estimate: K is known to rounding
/// errors, and what they do to the softest motions of a subdomain is κ times as large, a stiff body's on soft
/// springs for instance; and openings of springs have rounding errors that may be large beside strains.
double attainableAccuracy(const RunReport& report);

/// Why that is above the tolerance: sentences, "" where it is not.
std::string attainableText(const RunReport& report);

/// The audit and the timing, for people.
std::string auditText(const RunReport& report);
std::string timingText(const RunReport& report, const std::vector<std::string>& stages);

} // namespace Harmos::run
