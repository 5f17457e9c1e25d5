// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualSystem.hpp"

#include <Stratimikos_DefaultLinearSolverBuilder.hpp>
#include <Thyra_PreconditionerFactoryBase.hpp>

#include <string>

namespace Harmos {

/// Preconditioners of a feti::DualSystem for solvers that Stratimikos makes: PFPλ = Pd by Belos, say.
///
/// Parameters: "Type", see feti::DualSystem::Preconditioner: "Dirichlet" (default), "lumped", "deflation";
/// "Scaling": "multiplicity" (default), "stiffness".
///
/// Guarded by tests/unit/thyra/test_preconditioners.cpp.
class FetiPreconditionerFactory : public Thyra::PreconditionerFactoryBase<double> {
 public:
  /// Whether it is a Thyra operator over a feti::DualSystem.
  bool isCompatible(const Thyra::LinearOpSourceBase<double>& source) const override;
  Teuchos::RCP<Thyra::PreconditionerBase<double>> createPrec() const override;
  /// @throws InputError, NumericalError on all ranks. @note Collective.
  void initializePrec(const Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>& source,
                      Thyra::PreconditionerBase<double>* preconditioner,
                      Thyra::ESupportSolveUse use = Thyra::SUPPORT_SOLVE_UNSPECIFIED) const override;
  void uninitializePrec(Thyra::PreconditionerBase<double>* preconditioner,
                        Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* source,
                        Thyra::ESupportSolveUse* use) const override;

  void setParameterList(const Teuchos::RCP<Teuchos::ParameterList>& list) override;
  Teuchos::RCP<Teuchos::ParameterList> getNonconstParameterList() override { return list_; }
  Teuchos::RCP<Teuchos::ParameterList> unsetParameterList() override;
  Teuchos::RCP<const Teuchos::ParameterList> getParameterList() const override { return list_; }
  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters() const override;

  std::string description() const override { return "Harmos FETI preconditioner"; }

 private:
  Teuchos::RCP<Teuchos::ParameterList> list_;
};

/// Offers it to Stratimikos as the "Preconditioner Type" of this name.
void enableHarmosPreconditioner(Stratimikos::DefaultLinearSolverBuilder& builder,
                                const std::string& name = "Harmos FETI");

} // namespace Harmos
