// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_TestModel.hpp"

#include <memory>

namespace Harmos {

/// Two membranes whose contact is closed or open everywhere, and the linear problem that has the same
/// solution: with equalities in the place of the inequalities, or without them.
struct LinearLimit {
  /// @param s 1/H; @param n H/h. @param pattern 0 to 3: uniform loads, loads in few nodes, loads that differ
  /// between subdomains, waves.
  LinearLimit(int s, int n, bool closed, int pattern);

  TestModel contact, linear;
};

/// A model up to its dual problem with the Dirichlet preconditioner, ready to be solved as an application
/// does.
class LimitProblem {
 public:
  explicit LimitProblem(const TestModel& model);

  /// The dual problem alone, by the default method to a relative tolerance. @note Collective.
  run::RunReport solve(double tolerance);

  const feti::CoarseSpace& coarse() const { return *coarse_; }
  const feti::DualProblem& dual() const { return *dual_; }
  /// Of the last solution. @note Collective.
  feti::KktAudit audit() const;

 private:
  Teuchos::RCP<feti::SubdomainSystem> system_;
  Teuchos::RCP<feti::Constraints> constraints_;
  Teuchos::RCP<feti::LocalInverses> inverses_;
  Teuchos::RCP<feti::DualOperator> operator_;
  Teuchos::RCP<feti::CoarseSpace> coarse_;
  Teuchos::RCP<feti::DualProblem> dual_;
  Teuchos::RCP<const Operator> preconditioner_;
  feti::DualSolution solution_;
};

} // namespace Harmos
