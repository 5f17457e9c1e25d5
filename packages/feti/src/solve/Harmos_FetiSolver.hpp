// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualOptions.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_MumpsSolver.hpp"
#include "Harmos_Reactions.hpp"
#include "Harmos_SolutionHistory.hpp"
#include "Harmos_SubdomainInput.hpp"

#include <Teuchos_ParameterList.hpp>

#include <memory>

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
class FetiSolver {
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
  /// @param stiffness what was given before is not to be changed in place: where values are the same, factors
  /// stay. @param motions null pointers, or nothing: kernels as they were. Where subdomains that had equal
  /// matrices have not any more, or the other way round, everything is made anew. After a factorisation that
  /// fails (NumericalError) no solve() until matrices that succeed were set.
  void setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                   const std::vector<std::shared_ptr<const Kernel>>& motions = {});

  /// Bodies of another shape: matrices with the graphs of the old ones, kernels, loads, and rows with other
  /// coefficients, of the same kinds and numbers. Subdomains with the matrices that they had keep their
  /// factors. There is no solution until solve() finds one.
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
  const SolveReport& solve();
  /// To another tolerance than that of the parameters.
  const SolveReport& solve(double tolerance);
  double tolerance() const { return options_.tolerance; }
  /// The next solution starts cold, as the options say.
  void forgetSolutions() { history_.clear(); }
  /// For checkpoints: where the next solutions and increments start. With the same matrices and rows they are
  /// then, to the last bit on as many ranks, those of the run that wrote it; after setMatrices() and
  /// setShape(), which forget the starts, anyway. @throws InputError on all ranks without a problem().
  /// Guarded by tests/regression/shape/test_shape.py. @note Collective.
  void exchangeStarts(qp::StateArchive<MultiVector>& archive);
  /// The dual problem of the last solution; null before solve(), after changes, and where loads cannot be
  /// held.
  const DualProblem* problem() const { return problem_.get(); }

  /// How an answer changes: that of the matrices and rows that are here to other loads and bounds, with
  /// prescribed values of zero. What solve() has found, and what it finds next, is as if this had not been
  /// asked. Starts from what was asked before.
  struct Increment {
    SolveReport report;
    TornVector displacement;       ///< empty where it was not asked for
    std::vector<double> rowForces; ///< of the rows that this rank gave
  };
  /// @param loads of this rank's subdomains. @param rows those that are here, with other bounds, and with
  /// statuses: where all inequalities are decided the problem is linear. @param tolerance as solve(). @param
  /// withDisplacement without it there is no audit either, and a product with the local inverses less.
  /// @throws InputError, NumericalError, InternalError on all ranks. @note Collective.
  Increment solveIncrement(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                           const std::vector<ConstraintRow>& rows, double tolerance,
                           bool withDisplacement = true);

  /// Of the last solution, copies of a dof in each subdomain.
  const TornVector& displacement() const { return solution().displacement; }
  const KktAudit& audit() const { return audit_; }
  /// Gaps and forces of inequality rows that this rank owns. @note Collective.
  ContactState contact() const { return contactState(*constraints_, solution()); }
  /// Slips and forces of limited rows that this rank owns. @note Collective.
  FrictionState friction() const { return frictionState(*constraints_, solution()); }
  /// The forces by which the Dirichlet conditions of each subdomain hold it, see feti::reactions().
  /// @note Collective.
  std::vector<std::vector<double>> reactions() const {
    return feti::reactions(*system_, *constraints_, solution());
  }
  /// Of the rows that this rank gave, in their order: a row exerts −coefficient · force on its dofs.
  /// @note Collective.
  std::vector<double> rowForces() const { return constraints_->givenMultipliers(*solution().multiplier); }
  const TornSolution& solution() const;
  /// Of the last solve().
  const SolveReport& report() const { return report_; }
  /// Not before solve(), nor where loads cannot be held.
  bool hasSolution() const { return solution_ != nullptr; }

  const SubdomainSystem& system() const { return *system_; }
  const Constraints& constraints() const { return *constraints_; }
  const LocalInverses& inverses() const { return *inverses_; }
  const CoarseSpace& coarse() const { return *coarse_; }
  /// That subdomains are joined to, of all ranks; 0: none.
  long long clusters() const { return decided_.inverses.clusters ? decided_.inverses.clusters->total() : 0; }
  /// What was decided: "condensed, double, Dirichlet preconditioner".
  std::string dualOperatorText() const { return decided_.describe(); }
  /// F, to be used alone. Made anew with new matrices.
  const DualOperator& dualOperator() const { return *operator_; }
  /// What this rank spent on factors so far.
  FactorizationCounts factorizations() const;

 private:
  // What is solved for, and where it starts.
  struct Task {
    const SubdomainSystem& system;
    const Constraints& constraints;
    const DualProblem& problem;
    SolutionHistory& history;
    double rounding, roundingShare; // bounds are known up to this, and this share of displacements
  };
  struct Answer {
    SolveReport report;
    TornSolution torn;
    KktAudit audit;
  };
  Answer solved(const Task& task, double tolerance, bool recovers = true);
  void requireOperators() const;
  void setUpInverses();
  void forgetOperators();
  using Factored = std::vector<std::pair<const LocalMatrix*, const Kernel*>>;
  Factored factored() const;
  void renewInverses(const Factored& before);
  void setUpOperators();
  std::string escapingSubdomains(const DualSolution& dual) const;

  Log log_;
  Teuchos::ParameterList list_;
  DualOptions dual_;
  SolverOptions options_;
  DualOptions::Decided decided_ = {};
  ClusterOptions clusters_;   // the same
  double contrast_ = 1.0;     // of stiffness
  double defect_ = 0.0;       // of the inverses
  double rounding_ = 0.0;     // bounds are known up to this
  FactorizationCounts spent_; // on inverses that are no more
  std::unique_ptr<SubdomainSystem> system_;
  std::unique_ptr<Constraints> constraints_;
  std::unique_ptr<LocalInverses> inverses_;
  std::unique_ptr<DualOperator> operator_;
  std::unique_ptr<CoarseSpace> coarse_;
  std::unique_ptr<DualProblem> problem_;
  Teuchos::RCP<const DualPreconditioner> preconditioner_;
  std::unique_ptr<AdaptiveSpace> adaptive_;
  std::unique_ptr<TornSolution> solution_;
  SolutionHistory history_, increments_;
  KktAudit audit_;
  SolveReport report_;
};

} // namespace Harmos::feti
