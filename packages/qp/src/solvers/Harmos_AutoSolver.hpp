// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverManager.hpp"

#include <string>
#include <vector>

namespace Harmos::qp {

/// "Auto": lets the solver that suits the problem's structure do the work, and where that gives up, or takes
/// long, another one; Result::method tells which. Each method by name is this with that one first. No solver
/// knows of another one: who goes on for whom is written here alone.
///
///     no nonsmooth terms                                 PCPG
///     terms that are no sets, as soft bounds             PDAS
///     bounds, preconditioner, no equalities              PDAS
///     bounds, preconditioner, equalities with FaceGram   PDAS
///     bounds, no equalities                              MPRGP
///     bounds and equalities                              SMALBE
///
/// With a good preconditioner a face is solved in a few steps, and PDAS needs few faces; without one MPRGP
/// leaves a face before it has been solved too well. With equalities PDAS needs a factor of C_FC_Fᵀ for each
/// face, which is cheap only where an application knows their structure.
///
/// PDAS hands over to what converges from everywhere: MPRGP or SMALBE; where limits follow the solution, to
/// programs with given limits (FixedPointSolver). Terms that are no sets have no other method. MPRGP, SMALBE
/// and the penalty method creep along rims, and know no limits that follow: with discs, or programs with
/// given limits, they have a quarter of the iterations, and PDAS, if rows can be orthonormal, the rest, from
/// zero, where its first face is better than what there is.
///
/// Guarded by tests/unit/qp/test_life_cycle.cpp, test_pdas_budget.cpp, test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class AutoSolver : public SolverManager<Scalar, MV, OP> {
 public:
  using Solver = SolverManager<Scalar, MV, OP>;

  /// @param first the method to begin with; null: the one that the structure calls for.
  explicit AutoSolver(Teuchos::RCP<const Solver> first = Teuchos::null) : first_(std::move(first)) {}

  std::string name() const override { return first_.is_null() ? "Auto" : first_->name(); }
  Teuchos::RCP<Solver> clone() const override;
  /// Of the methods that it may come to.
  const ParameterSpec& parameterSpec() const override;
  bool letsLimitsFollow() const override { return true; }
  bool takesAllBlocks() const override { return first_.is_null() || first_->takesAllBlocks(); }
  bool meetsEqualities() const override { return first_.is_null() || first_->meetsEqualities(); }
  static const ParameterSpec& spec();

  /// The name of the solver that the problem's structure calls for.
  static std::string choice(const Problem<Scalar, MV, OP>& problem);

 protected:
  void doSolve() override;

 private:
  // A method, and what it may use.
  struct Stage {
    Teuchos::RCP<Solver> solver;
    double share = 1.0; // of the iterations that are left
    bool isFromZero = false;
  };

  static Teuchos::RCP<Solver> make(const std::string& method);
  std::vector<Stage> plan() const;
  Teuchos::RCP<Solver> successorOfPdas() const;
  bool canBeOrthonormal() const;
  std::string whyHandOver(const Stage& stage) const;

  Teuchos::RCP<const Solver> first_;
};

} // namespace Harmos::qp
