// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_FetiAnswer.hpp"
#include "Harmos_IncrementSolver.hpp"
#include "Harmos_MumpsSolver.hpp"
#include "Harmos_SubdomainInput.hpp"

#include <Teuchos_ParameterList.hpp>

#include <memory>
#include <optional>

namespace Harmos::feti {

/// Solves a torn problem given by an application's own matrices, repeatedly as loads, bounds or matrix values
/// change:
///
///     min ½uᵀKu − fᵀu   subject to   copies equal,  B_I u ≤ c_I,  B_E u = c_E
///
/// Rows may also be equalities with a limited force (friction with a given bound) or springs (glued
/// interfaces); see ConstraintRow.
///
/// Cost of a change: two applications of F for loads, prescribed values and bounds; numerical factorisations
/// without analysis for matrices with the same graphs. A solve starts from an extrapolation of earlier
/// solutions; see SolutionHistory.
///
/// Output goes to the Log only. MPI and Kokkos are neither initialised nor finalised; any communicator is
/// valid. Parameters: the lists "Decomposition", "Dual operator" and "Solver" of a deck, see parameters() and
/// docs/parameters; unknown names are rejected.
///
/// Guarded by tests/unit/feti/test_feti_solver.cpp.
class FetiSolver : public FetiAnswer {
 public:
  /// Sets up: constraints, factorisations, coarse problem, preconditioner.
  /// @param subdomains those of this rank, which may have none; see Subdomain and Harmos_SubdomainInput.hpp.
  /// @param rows this rank's share of contacts and ties on global dofs; see ConstraintRow.
  /// @param given parameters that differ from the defaults.
  /// @throws InputError, NumericalError on all ranks, with the subdomain and a remedy. @note Collective.
  FetiSolver(Teuchos::RCP<const Teuchos::Comm<int>> comm, std::vector<Subdomain> subdomains,
             const std::vector<ConstraintRow>& rows, const Teuchos::ParameterList& given = {},
             const Log& log = {});
  ~FetiSolver();
  FetiSolver(const FetiSolver&) = delete;
  FetiSolver& operator=(const FetiSolver&) = delete;

  /// What parameters there are, with defaults and meaning.
  static ParameterSpec parameters();

  /// For the next solve(); see SubdomainSystem for the arguments and errors. All collective.
  void setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads);
  void setPrescribed(const std::vector<std::vector<double>>& values);
  /// @param rows those of the constructor, with other bounds, limits and softness, or none or some of it.
  void setBounds(const std::vector<ConstraintRow>& rows);
  /// @param rows others, of any number and kind: contacts that come and go. Factors stay but where rows touch
  /// other dofs. There is no solution until solve() finds one.
  void setRows(const std::vector<ConstraintRow>& rows);
  /// @param stiffness what was given before is not to be changed in place: where values are the same, factors
  /// stay. @param motions null pointers, or nothing: kernels as they were. Where subdomains that had equal
  /// matrices have not any more, or the other way round, everything is made anew. After a factorisation that
  /// fails (NumericalError) no solve() until matrices that succeed were set.
  void setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                   const std::vector<std::shared_ptr<const Kernel>>& motions = {});

  /// Bodies of another shape: matrices with the graphs of the old ones, kernels, loads, and other rows.
  /// Subdomains with the matrices that they had keep their factors. There is no solution until solve() finds
  /// one.
  /// @param motions as setMatrices(). @throws as setMatrices() and the constructor. After an error no solve()
  /// until a shape that succeeds was set. @note Collective.
  void setShape(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                const std::vector<std::shared_ptr<const Kernel>>& motions,
                std::vector<std::shared_ptr<const std::vector<double>>> loads,
                const std::vector<ConstraintRow>& rows);

  /// Solves, and judges the answer by its audit: where that contradicts the residuals, the solver goes on,
  /// and an answer that it contradicts to the end is not called converged. That there is no solution is no
  /// error, but a report with the reason, which names the subdomains that nothing holds.
  /// @throws NumericalError, InternalError on all ranks. @note Collective.
  /// @param tolerance nothing: that of the parameters.
  const SolveReport& solve(std::optional<double> tolerance = std::nullopt);
  double tolerance() const { return options_.tolerance; }
  /// What the next solves are judged by, beside the audit:
  ///  - groups of the rows that this rank gave, a contact for instance: the solver goes on until the forces
  ///  of
  ///    each are as accurate as displacements, beside all others. Forgotten with other rows;
  ///  - an estimate of the discretisation error, which the tolerance rule "balanced" needs: Harmos knows no
  ///    elements here. Collective.
  /// quality() has the estimates. All else is the parameters'.
  /// @throws InputError on all ranks for groups that do not fit the rows. @note Collective.
  void judgeBy(AnswerCriteria criteria);
  /// Follows the next solves, may interrupt them, keep their state and bring it back; null: none.
  void setMonitor(Teuchos::RCP<DualMonitor> monitor) { monitor_ = std::move(monitor); }
  /// The next solution starts cold, as the options say.
  void forgetSolutions() { history_.clear(); }
  /// For checkpoints: where the next solutions and increments start. With the same matrices and rows they are
  /// then, to the last bit on as many ranks, those of the run that wrote it; after setMatrices() and
  /// setShape(), which forget the starts, anyway. @throws InputError on all ranks without a problem().
  /// Guarded by tests/regression/shape/test_shape.py. @note Collective.
  void exchangeStarts(qp::StateArchive<MultiVector>& archive);
  /// The dual problem of the last solution; null before solve(), after changes, and where loads cannot be
  /// held.
  Teuchos::RCP<const DualProblem> problem() const { return pipeline_->currentProblem(); }

  using Increment = IncrementSolver::Increment;
  /// How an answer changes; see IncrementSolver. What solve() has found, and what it finds next, is as if
  /// this had not been asked. @note Collective.
  Increment solveIncrement(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                           const std::vector<ConstraintRow>& rows, double tolerance,
                           bool withDisplacement = true);

  /// F, to be used alone. Made anew with new matrices and rows: whoever keeps it keeps that of before.
  Teuchos::RCP<const DualOperator> dualOperator() const { return pipeline_->dualOperator(); }
  /// All stages, what was decided on them, and how often each was made.
  const DualPipeline& pipeline() const { return *pipeline_; }
  /// What this rank spent on factors so far.
  FactorizationCounts factorizations() const { return pipeline_->factorizations(); }

 private:
  void requireOperators() const;
  void changing(const std::function<void()>& change);

  Log log_;
  Teuchos::ParameterList list_;
  SolverOptions options_;
  AnswerCriteria criteria_; // as given
  Teuchos::RCP<DualMonitor> monitor_;
  SolutionHistory history_;
  std::unique_ptr<IncrementSolver> increments_;
};

} // namespace Harmos::feti
