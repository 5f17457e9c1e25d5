// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FetiSolver.hpp"
#include "Harmos_TornOperator.hpp"

#include <Stratimikos_DefaultLinearSolverBuilder.hpp>
#include <Thyra_LinearOpWithSolveBase.hpp>
#include <Thyra_LinearOpWithSolveFactoryBase.hpp>

#include <memory>
#include <string>

namespace Harmos {

/// A feti::TornOperator that can be solved with, by feti::FetiSolver.
///
/// A solve takes the tolerance of the criteria, if they are about ‖Ax − b‖/‖b‖: FETI's own is lowered until
/// that residual, computed from the torn matrices, meets it. A solve with constraint rows is one of the
/// constrained problem; with inequalities it is not linear in b, and the residual holds contact forces, so
/// that FETI's own tolerance alone is asked for. Columns are solved for one after the other, each starting
/// with the last one's multipliers.
class FetiLinearOpWithSolve : public Thyra::LinearOpWithSolveBase<double> {
 public:
  Teuchos::RCP<const Thyra::VectorSpaceBase<double>> range() const override;
  Teuchos::RCP<const Thyra::VectorSpaceBase<double>> domain() const override;
  std::string description() const override;

  /// Null before initialisation.
  const feti::FetiSolver* solver() const { return solver_.get(); }

 protected:
  bool opSupportedImpl(Thyra::EOpTransp transposed) const override;
  void applyImpl(Thyra::EOpTransp transposed, const Thyra::MultiVectorBase<double>& X,
                 const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& Y, double alpha,
                 double beta) const override;
  bool solveSupportsImpl(Thyra::EOpTransp transposed) const override;
  bool solveSupportsSolveMeasureTypeImpl(Thyra::EOpTransp transposed,
                                         const Thyra::SolveMeasureType& measure) const override;
  Thyra::SolveStatus<double>
  solveImpl(Thyra::EOpTransp transposed, const Thyra::MultiVectorBase<double>& B,
            const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& X,
            Teuchos::Ptr<const Thyra::SolveCriteria<double>> criteria) const override;

 private:
  friend class FetiLinearOpWithSolveFactory;

  Teuchos::RCP<const Thyra::LinearOpSourceBase<double>> source_;
  Teuchos::RCP<const Thyra::LinearOpBase<double>> forward_;
  Teuchos::RCP<const feti::TornOperator> operator_;
  mutable std::unique_ptr<feti::FetiSolver> solver_; // solutions warm it up
};

/// Makes them, from Thyra operators over a feti::TornOperator. Parameters: FetiSolver::parameters().
///
/// To initialise one again with an operator whose matrices have the same graphs costs numerical
/// factorisations alone. Guarded by tests/unit/thyra/test_thyra.cpp.
class FetiLinearOpWithSolveFactory : public Thyra::LinearOpWithSolveFactoryBase<double> {
 public:
  bool isCompatible(const Thyra::LinearOpSourceBase<double>& source) const override;
  Teuchos::RCP<Thyra::LinearOpWithSolveBase<double>> createOp() const override;
  /// @throws InputError, NumericalError on all ranks. @note Collective.
  void initializeOp(const Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>& source,
                    Thyra::LinearOpWithSolveBase<double>* op,
                    Thyra::ESupportSolveUse use = Thyra::SUPPORT_SOLVE_UNSPECIFIED) const override;
  void uninitializeOp(Thyra::LinearOpWithSolveBase<double>* op,
                      Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* source,
                      Teuchos::RCP<const Thyra::PreconditionerBase<double>>* preconditioner,
                      Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* approximateSource,
                      Thyra::ESupportSolveUse* use) const override;

  void setParameterList(const Teuchos::RCP<Teuchos::ParameterList>& list) override;
  Teuchos::RCP<Teuchos::ParameterList> getNonconstParameterList() override;
  Teuchos::RCP<Teuchos::ParameterList> unsetParameterList() override;
  Teuchos::RCP<const Teuchos::ParameterList> getParameterList() const override;
  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters() const override;

  std::string description() const override { return "Harmos FETI"; }

 private:
  Teuchos::RCP<Teuchos::ParameterList> list_;
};

/// Offers FETI to Stratimikos as the "Linear Solver Type" of this name.
void enableHarmos(Stratimikos::DefaultLinearSolverBuilder& builder, const std::string& name = "Harmos FETI");

} // namespace Harmos
