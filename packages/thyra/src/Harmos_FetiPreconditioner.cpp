// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FetiPreconditioner.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_AbstractFactoryStd.hpp>
#include <Thyra_DefaultPreconditioner.hpp>
#include <Thyra_LinearOpSourceBase.hpp>
#include <Thyra_TpetraLinearOp.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>

namespace Harmos {
namespace {

// Null if it is none.
Teuchos::RCP<const feti::DualSystem> dualSystem(const Thyra::LinearOpSourceBase<double>& source) {
  using Wrapper = Thyra::TpetraLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
  const auto wrapper = Teuchos::rcp_dynamic_cast<const Wrapper>(source.getOp());
  return wrapper.is_null()
             ? Teuchos::null
             : Teuchos::rcp_dynamic_cast<const feti::DualSystem>(wrapper->getConstTpetraOperator());
}

ParameterSpec parameters() {
  ParameterSpec spec("Harmos FETI", "Preconditioner of the dual problem.");
  spec.choice("Type", "Dirichlet",
              {{"Dirichlet", "Schur complements of the subdomains"},
               {"lumped", "boundary blocks of their stiffness matrices: cheap, weaker"},
               {"deflation", "that of the stages, balanced by adaptive coarse vectors"}},
              "Approximation of the inverse of F.");
  spec.choice("Scaling", "multiplicity",
              {{"multiplicity", "all copies of a dof take an equal share of a jump"},
               {"stiffness", "the softer copy takes a larger share"}},
              "Of the types Dirichlet and lumped.");
  return spec;
}

} // namespace

bool FetiPreconditionerFactory::isCompatible(const Thyra::LinearOpSourceBase<double>& source) const {
  return !dualSystem(source).is_null();
}

Teuchos::RCP<Thyra::PreconditionerBase<double>> FetiPreconditionerFactory::createPrec() const {
  return Teuchos::rcp(new Thyra::DefaultPreconditioner<double>);
}

void FetiPreconditionerFactory::initializePrec(
    const Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>& source,
    Thyra::PreconditionerBase<double>* preconditioner, Thyra::ESupportSolveUse) const {
  using Kind = feti::DualSystem::Preconditioner;
  const Teuchos::RCP<const feti::DualSystem> system = dualSystem(*source);
  if (system.is_null())
    throw InputError("Harmos' preconditioners are those of a feti::DualSystem, wrapped by "
                     "Thyra::createConstLinearOp()");
  const Teuchos::ParameterList list =
      parameters().validated(list_.is_null() ? Teuchos::ParameterList() : *list_, "the parameters given");
  const std::string type = list.get<std::string>("Type");
  const Kind kind = type == "Dirichlet" ? Kind::Dirichlet : type == "lumped" ? Kind::Lumped : Kind::Deflation;
  const auto scaling = list.get<std::string>("Scaling") == "stiffness"
                           ? feti::PreconditionerScaling::Stiffness
                           : feti::PreconditionerScaling::Multiplicity;
  dynamic_cast<Thyra::DefaultPreconditioner<double>&>(*preconditioner)
      .initializeUnspecified(Thyra::createConstLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>(
          system->preconditioner(kind, scaling)));
}

void FetiPreconditionerFactory::uninitializePrec(
    Thyra::PreconditionerBase<double>* preconditioner,
    Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* source, Thyra::ESupportSolveUse* use) const {
  dynamic_cast<Thyra::DefaultPreconditioner<double>&>(*preconditioner).uninitialize();
  if (source != nullptr)
    *source = Teuchos::null;
  if (use != nullptr)
    *use = Thyra::SUPPORT_SOLVE_UNSPECIFIED;
}

void FetiPreconditionerFactory::setParameterList(const Teuchos::RCP<Teuchos::ParameterList>& list) {
  if (!list.is_null()) {
    list->setName("Harmos FETI");
    parameters().validated(*list, "the parameters given");
  }
  list_ = list;
}

Teuchos::RCP<Teuchos::ParameterList> FetiPreconditionerFactory::unsetParameterList() {
  const Teuchos::RCP<Teuchos::ParameterList> list = list_;
  list_ = Teuchos::null;
  return list;
}

Teuchos::RCP<const Teuchos::ParameterList> FetiPreconditionerFactory::getValidParameters() const {
  return Teuchos::parameterList(parameters().defaults());
}

void enableHarmosPreconditioner(Stratimikos::DefaultLinearSolverBuilder& builder, const std::string& name) {
  builder.setPreconditioningStrategyFactory(
      Teuchos::abstractFactoryStd<Thyra::PreconditionerFactoryBase<double>, FetiPreconditionerFactory>(),
      name);
}

} // namespace Harmos
