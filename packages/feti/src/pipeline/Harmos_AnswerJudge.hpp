// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerQuality.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PreconditionerKind.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_SolverOptions.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::feti {

/// What an answer is judged by.
struct AnswerCriteria {
  ToleranceRule rule = ToleranceRule::Fixed;
  double solverErrorShare = 0.3; ///< of the rule Balanced
  /// Of an answer's displacements, for the rule Balanced; else null. Collective.
  std::function<DiscretisationError(const TornVector& displacement)> estimate;
  double boundRounding = 0.0; ///< bounds are known up to this, on all ranks
  /// And to this share of the largest displacement: where they are those of an increment.
  double roundingShare = 0.0;
  /// Whether errors are estimated, in the energy norm and of the forces of groups of rows. Without, the audit
  /// alone decides. The rule Balanced needs it.
  bool estimatesErrors = true;
  std::vector<int> groupOf;        ///< of each row that this rank gave: place among `groups`; −1: none
  std::vector<std::string> groups; ///< names, the same on all ranks
  /// Of each of those rows, for its traction; 0: it has none. Empty: tractions are not looked at.
  std::vector<double> areaOf;
};

/// Looks from the primal side at answers that meet the solver's tolerance, and says whether to go on.
///
/// Three reasons to go on. The audit contradicts the answer (auditAgrees()): residuals of the dual problem
/// are no measure of the jumps of u where the condition of F is bad. The forces of a contact, an obstacle or
/// a tie are wrong by more than allowedForceError(), by the estimate of forceErrors(), or its tractions by
/// more than allowedTractionError(): residuals are measured against the whole load, of which a small contact
/// has a small share. An answer that the audit agrees with is taken all the same if the solver comes no
/// further, unless the excess is beyond mostForceExcess. And, by the tolerance rule "balanced", the solver's
/// error is still more than its share of the discretisation error:
///
///  - the solver's error in the energy norm is at most ‖u − v‖, where u is in equilibrium with the
///  multipliers
///    and v meets the constraints (hypercircle of Prager, Synge: Approximations in elasticity based on the
///    concept of function space, Quart. Appl. Math. 5, 1947). With the jumps r = Bu − c shared out by the
///    preconditioner's B_D and extended into the subdomains, ‖u − v‖² = rᵀM⁻¹r for the Dirichlet one; the
///    lumped one extends them by zero, which costs more energy and bounds it too. Rows of contacts that are
///    open, with λ = 0, count where they are violated only;
///  - the discretisation error is what the caller's estimate says.
///
/// Guarded by tests/unit/run/test_answer_check.cpp and tests/unit/run/test_capabilities.cpp.
class AnswerJudge {
 public:
  /// @param scaling of a preconditioner that is made where the stages have none. @param precision of the
  /// stages' inverses. @param quality has tolerance and localDefect; gets the rest. To outlive this.
  AnswerJudge(DualStages stages, AnswerCriteria criteria, PreconditionerScaling scaling, Precision precision,
              const Log& log, AnswerQuality& quality);

  /// @param lambda, mu an answer; @param tolerance that it meets.
  /// @return the tolerance to go on to; nothing if the answer is accepted, or going on would not help.
  /// @note Collective. Audit and estimates go to the quality.
  Verdict judge(const MultiVector& lambda, const std::vector<double>& mu, double tolerance);

  /// What it has learnt of the discretisation error, and the forces of the last answer. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive);

  /// The solution that belongs to an answer, audited; that of the last one judged is at hand.
  /// @param isLastJudged whether it is that one. @note Collective.
  TornSolution finish(const MultiVector& lambda, const std::vector<double>& mu, bool isLastJudged);

  /// The tolerance that the rule Balanced starts with.
  static double firstBalancedTolerance();

 private:
  // Of an answer: its forces, and the jumps that their errors are estimated from.
  struct Judged {
    RowForces forces;
    Teuchos::RCP<MultiVector> jumps; // null: there is no answer
  };

  void recover(const MultiVector& lambda, const std::vector<double>& mu);
  void sharpen();
  bool isRefusedByAudit() const;
  RowForces forcesOf(const MultiVector& multiplier, const MultiVector& jumps, double* energy = nullptr) const;
  void measureErrors();
  std::optional<double> improve(double tolerance);
  void makeExtension(PreconditionerKind kind);
  std::optional<double> balance(double tolerance);
  std::optional<double> improveForces(double tolerance);

  DualStages stages_;
  AnswerCriteria criteria_;
  PreconditionerScaling scaling_;
  Precision precision_;
  Log log_; // by value: it may be the muted one of a step
  AnswerQuality& quality_;
  Teuchos::RCP<const Operator> extension_; // M⁻¹ of the estimate
  bool isBoundAlone_ = false;              // it was made for a bound that costs little
  TornSolution torn_;
  Judged last_, before_; // the answer that was judged last, and the one before
  std::optional<DiscretisationError> discretisation_;
  bool trusted_ = false; // that estimate is not about the solver's error
  bool isSharp_ = false; // the extension was made anew, by Dirichlet's preconditioner
};

/// √(rᵀM⁻¹r) of what an answer leaves of its rows, r = Bu − c − Cλ, as AnswerJudge estimates the solver's
/// error in the energy norm; by the stages' preconditioner, or the lumped one. @note Collective.
double energyError(const DualStages& stages, PreconditionerScaling scaling, const TornSolution& answer);

} // namespace Harmos::feti
