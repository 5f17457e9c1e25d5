// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerQuality.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_DualStages.hpp"
#include "Harmos_EffectCosts.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_Forces.hpp"
#include "Harmos_SlipStates.hpp"
#include "Harmos_StepTable.hpp"

#include <map>
#include <string>
#include <vector>

namespace Harmos::run {

using feti::PairError;

/// What is known of a run, finished or failed: the content of summary.json.
struct RunReport : feti::SolveReport, feti::AnswerQuality {
  // Rows of a scene have coefficients of one: a force that is so much larger than all that bodies feel is
  // that of a row that nearly cancels, and is scaled to one.
  RunReport() { mostRowForce = 1e6; }
  std::string deck;
  int ranks = 0;
  std::string scene;
  bool isFinite = false;           ///< displacements of any size
  std::vector<std::string> bodies; ///< their names, in the order of the results' cell data
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
  double localCondition = 0.0;  ///< largest estimate of κ(K_i) on the complement of the kernel
  double dualOperatorMiB = 0.0; ///< factors and dense blocks of all ranks
  std::string stoppingRule;
  std::string toleranceRule;
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
