// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PreconditionerKind.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_StressRecovery.hpp"

#include <optional>

namespace Harmos::run {

/// Looks from the primal side at answers that meet the solver's tolerance, and says whether to go on.
///
/// Three reasons to go on. The audit contradicts the answer (auditAgrees()): residuals of the dual problem
/// are no measure of the jumps of u where the condition of F is bad. The forces of a contact, an obstacle or
/// a tie are wrong by more than allowedForceError(), by the estimate of feti::forceErrors(): residuals are
/// measured against the whole load, of which a small contact has a small share. An answer that the audit
/// agrees with is taken all the same if the solver comes no further. And, by the tolerance rule "balanced",
/// the solver's error is still more than its share of the discretisation error:
///
///  - the solver's error in the energy norm is at most ‖u − v‖, where u is in equilibrium with the
///  multipliers
///    and v meets the constraints (hypercircle of Prager, Synge: Approximations in elasticity based on the
///    concept of function space, Quart. Appl. Math. 5, 1947). With the jumps r = Bu − c shared out by the
///    preconditioner's B_D and extended into the subdomains, ‖u − v‖² = rᵀM⁻¹r for the Dirichlet one; the
///    lumped one extends them by zero, which costs more energy and bounds it too. Rows of contacts that are
///    open, with λ = 0, count where they are violated only;
///  - the discretisation error comes from recovered stresses, see estimateDiscretisationError().
///
/// Guarded by tests/unit/run/test_answer_check.cpp.
class AnswerCheck {
 public:
  /// @param time of the loads.
  AnswerCheck(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
              const std::vector<scene::OwnedSubdomain>& owned, const feti::DualStages& stages,
              const scene::ContactSetup& contact, const RunOptions& options, double time, const Log& log,
              RunReport& report);

  /// @param lambda, mu an answer; @param tolerance that it meets.
  /// @return the tolerance to go on to; nothing if the answer is accepted, or going on would not help.
  /// @note Collective. Audit and estimates go to the report.
  feti::Verdict judge(const MultiVector& lambda, const std::vector<double>& mu, double tolerance);

  /// What it has learnt of the discretisation error. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive);

  /// The solution that belongs to an answer, audited; that of the last one judged is at hand.
  /// @param isLastJudged whether it is that one. @note Collective.
  feti::TornSolution finish(const MultiVector& lambda, const std::vector<double>& mu, bool isLastJudged);

 private:
  void recover(const MultiVector& lambda, const std::vector<double>& mu);
  void estimate();
  std::optional<double> improve(double tolerance);
  void makeExtension(feti::PreconditionerKind kind);
  std::optional<double> balance(double tolerance);
  double forceExcess() const;
  std::optional<double> improveForces(double tolerance);

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  const std::vector<scene::OwnedSubdomain>& owned_;
  const feti::DualStages& stages_;
  std::vector<int> groupOf_; // of each row of this rank: place among the pairs
  const RunOptions& options_;
  double time_;
  Log log_; // by value: it may be the muted one of a step
  RunReport& report_;
  Teuchos::RCP<const Operator> extension_; // M⁻¹ of the estimate
  bool isBoundAlone_ = false;              // it was made for a bound that costs little
  feti::TornSolution torn_;
  std::optional<DiscretisationError> discretisation_;
  bool trusted_ = false; // that estimate is not about the solver's error
};

/// The tolerance that a balanced run starts with.
double firstBalancedTolerance();

} // namespace Harmos::run
