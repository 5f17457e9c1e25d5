// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerQuality.hpp"
#include "Harmos_DualPipeline.hpp"
#include "Harmos_Reactions.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// The last answer of a solver, by what an application asks of it: displacements, forces, and how good they
/// are.
///
/// Guarded by tests/unit/feti/test_feti_solver.cpp.
class FetiAnswer {
 public:
  /// Not before solve(), nor where loads cannot be held.
  bool hasSolution() const { return solution_ != nullptr; }
  /// @throws InputError without one; so do those that follow.
  const TornSolution& solution() const;
  /// Of the last solution, copies of a dof in each subdomain.
  const TornVector& displacement() const { return solution().displacement; }
  /// Gaps and forces of inequality rows that this rank owns. @note Collective.
  ContactState contact() const { return contactState(*constraints(), solution()); }
  /// Slips and forces of limited rows that this rank owns. @note Collective.
  FrictionState friction() const { return frictionState(*constraints(), solution()); }
  /// The forces by which the Dirichlet conditions of each subdomain hold it, see feti::reactions().
  /// @note Collective.
  std::vector<std::vector<double>> reactions() const {
    return feti::reactions(system(), *constraints(), solution());
  }
  /// Of the rows that this rank gave, in their order: a row exerts −coefficient · force on its dofs.
  /// @note Collective.
  std::vector<double> rowForces() const { return constraints()->givenMultipliers(*solution().multiplier); }

  /// Of the last solve().
  const SolveReport& report() const { return report_; }
  const KktAudit& audit() const { return quality_.audit; }
  /// The audit with estimates of errors.
  const AnswerQuality& quality() const { return quality_; }

  const SubdomainSystem& system() const { return pipeline_->system(); }
  Teuchos::RCP<const Constraints> constraints() const { return pipeline_->constraints(); }

 protected:
  FetiAnswer();
  ~FetiAnswer();

  std::unique_ptr<DualPipeline> pipeline_; // what the answer is of
  std::unique_ptr<TornSolution> solution_;
  AnswerQuality quality_;
  SolveReport report_;
};

} // namespace Harmos::feti
