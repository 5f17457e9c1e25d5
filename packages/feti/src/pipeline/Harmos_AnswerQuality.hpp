// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ForceErrors.hpp"
#include "Harmos_KktAudit.hpp"

#include <string>
#include <vector>

namespace Harmos::feti {

/// How wrong the forces of a group of given rows are, of a contact, an obstacle or a tie with its friction
/// and adhesion; see forceErrors().
struct PairError : ForceError {
  std::string path; ///< its name; in a scene the path of the effect
};

/// Energy norms of an answer. The caller estimates them: FETI knows no elements.
struct DiscretisationError {
  double error; ///< of the finite element solution, estimated
  double norm;  ///< of the solution
};

/// What is known of an answer from the primal side, and what it is measured against.
struct AnswerQuality {
  double tolerance = 0.0;        ///< asked for, or chosen by the rule "balanced"
  double reachedTolerance = 0.0; ///< below that, where the audit asked for more
  // Estimates in the energy norm; 0 where they were not made.
  double solverError = 0.0;         ///< see AnswerJudge
  double discretisationError = 0.0; ///< rule "balanced" only, relative to the solution
  double allowedError = 0.0;        ///< likewise: what that rule allows the solver
  double gapRounding = 0.0;         ///< bounds are known up to this: gaps are differences of coordinates
  /// The force of a row may be so many times all forces; 0: no limit, as rows may have any coefficients.
  double mostRowForce = 0.0;
  double localDefect = 0.0;          ///< largest ‖KK⁺Kx − Kx‖/‖Kx‖ of all ranks
  std::vector<PairError> pairErrors; ///< estimates, of each group of rows
  bool audited = false;
  KktAudit audit;
};

/// Whether the audit bears out that a solve has converged: auditAgrees() with the share of the tolerance.
/// Where the rule "balanced" chose it, the error that the rule allows is what the answer claims. Local.
/// Guarded by tests/unit/run/test_pipeline.cpp.
bool auditAgrees(const AnswerQuality& quality);

/// What is wrong where the force of a constraint row is beyond all that bodies feel; "" where none is, and
/// without a limit. auditAgrees() objects then. Guarded by tests/unit/run/test_row_forces.cpp.
std::string rowForceText(const AnswerQuality& quality);

/// The share of displacements and forces that an answer may be wrong by: auditShare() of its tolerance, or
/// what the rule "balanced" allows.
double allowedShare(const AnswerQuality& quality);

/// What the acceptance of an answer allows the error of a group's forces to be, after an audit: as share of
/// these forces what auditAgrees() allows jumps of displacements, a hundred tolerances and a tenth at most.
/// Of forces below 1e-5 of all forces that share of 1e-5: what presses that little may press by nothing but
/// rounding errors, and there would be no end. Beside it what rounding errors of displacements and gaps make
/// of forces. Guarded by tests/unit/run/test_pair_errors.cpp.
double allowedForceError(const AnswerQuality& quality, const PairError& pair);

/// The same of tractions: three times that share of the largest one of the group.
double allowedTractionError(const AnswerQuality& quality, const PairError& pair);

/// The error of a group's forces, or of its tractions, as a multiple of what it may be: of the larger
/// multiple.
double forceExcess(const AnswerQuality& quality, const PairError& pair);
/// The largest of all groups.
double forceExcess(const AnswerQuality& quality);

/// The group of the largest one; null without groups.
const PairError* worstPair(const AnswerQuality& quality);

/// What the estimate of errors may be too large by: an answer with a larger excess is none.
constexpr double mostForceExcess = 4.0;

/// "1.9e-01, of its largest traction at one node 9.8e-01": relative errors of a pair.
std::string forceErrorText(const PairError& pair);

/// Whose forces no smaller tolerance could be reached for, though their excess is larger; "" where there are
/// none.
std::string wrongForcesText(const AnswerQuality& quality);

} // namespace Harmos::feti
