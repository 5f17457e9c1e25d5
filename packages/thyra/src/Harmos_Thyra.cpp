// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Thyra.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_AbstractFactoryStd.hpp>
#include <Thyra_DefaultLinearOpSource.hpp>
#include <Thyra_TpetraLinearOp.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos {
namespace {

using Converter = Thyra::TpetraOperatorVectorExtraction<Scalar, LocalOrdinal, GlobalOrdinal, Node>;

// Null if it is none.
Teuchos::RCP<const feti::TornOperator> tornOperator(const Thyra::LinearOpSourceBase<double>& source) {
  using Wrapper = Thyra::TpetraLinearOp<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
  const auto wrapper = Teuchos::rcp_dynamic_cast<const Wrapper>(source.getOp());
  return wrapper.is_null()
             ? Teuchos::null
             : Teuchos::rcp_dynamic_cast<const feti::TornOperator>(wrapper->getConstTpetraOperator());
}

double norm(const MultiVector& x, std::size_t column) {
  return x.getVector(column)->norm2();
}

bool hasInequalities(const feti::FetiSolver& solver) {
  return solver.constraints()->inequalities() + solver.constraints()->limited() > 0;
}

} // namespace

Teuchos::RCP<const Thyra::VectorSpaceBase<double>> FetiLinearOpWithSolve::range() const {
  return forward_.is_null() ? Teuchos::null : forward_->range();
}

Teuchos::RCP<const Thyra::VectorSpaceBase<double>> FetiLinearOpWithSolve::domain() const {
  return forward_.is_null() ? Teuchos::null : forward_->domain();
}

std::string FetiLinearOpWithSolve::description() const {
  return solver_ ? "Harmos FETI, " + std::to_string(solver_->system().globalSubdomains()) + " subdomains"
                 : "Harmos FETI, not initialised";
}

bool FetiLinearOpWithSolve::opSupportedImpl(Thyra::EOpTransp transposed) const {
  return !forward_.is_null() && Thyra::opSupported(*forward_, transposed);
}

void FetiLinearOpWithSolve::applyImpl(Thyra::EOpTransp transposed, const Thyra::MultiVectorBase<double>& X,
                                      const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& Y, double alpha,
                                      double beta) const {
  Thyra::apply(*forward_, transposed, X, Y, alpha, beta);
}

bool FetiLinearOpWithSolve::solveSupportsImpl(Thyra::EOpTransp transposed) const {
  return Thyra::real_trans(transposed) == Thyra::NOTRANS;
}

bool FetiLinearOpWithSolve::solveSupportsSolveMeasureTypeImpl(Thyra::EOpTransp transposed,
                                                              const Thyra::SolveMeasureType& measure) const {
  return solveSupportsImpl(transposed) &&
         (measure.useDefault() || measure(Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS));
}

Thyra::SolveStatus<double>
FetiLinearOpWithSolve::solveImpl(Thyra::EOpTransp, const Thyra::MultiVectorBase<double>& B,
                                 const Teuchos::Ptr<Thyra::MultiVectorBase<double>>& X,
                                 Teuchos::Ptr<const Thyra::SolveCriteria<double>> criteria) const {
  HARMOS_REQUIRE(solver_ != nullptr, "the operator has not been initialised");
  const Teuchos::RCP<const MultiVector> b = Converter::getConstTpetraMultiVector(Teuchos::rcpFromRef(B));
  const Teuchos::RCP<MultiVector> x = Converter::getTpetraMultiVector(Teuchos::rcpFromPtr(X));
  const bool isAsked = !criteria.is_null() && !criteria->solveMeasureType.useDefault() &&
                       criteria->requestedTol != Thyra::SolveCriteria<double>::unspecifiedTolerance() &&
                       !hasInequalities(*solver_);
  Thyra::SolveStatus<double> status;
  status.solveStatus = Thyra::SOLVE_STATUS_CONVERGED;
  status.achievedTol = 0.0;
  MultiVector residual(b->getMap(), b->getNumVectors());
  for (std::size_t c = 0; c < b->getNumVectors(); ++c) {
    const feti::TornOperator::TornRhs rhs = operator_->torn(*b, c);
    solver_->setLoads(rhs.loads);
    solver_->setPrescribed(rhs.prescribed);
    solver_->setBounds(operator_->rows());
    const double size = norm(*b, c);
    double tolerance = solver_->tolerance();
    if (isAsked)
      tolerance = std::min(tolerance, criteria->requestedTol);
    double achieved = 0.0;
    while (true) {
      const feti::SolveReport& report = solver_->solve(tolerance);
      status.message = report.reason;
      if (solver_->hasSolution())
        operator_->join(solver_->displacement(), *x, c);
      if (!report.converged) {
        status.solveStatus = Thyra::SOLVE_STATUS_UNCONVERGED;
        break;
      }
      if (hasInequalities(*solver_)) {
        achieved = tolerance;
        break;
      }
      operator_->apply(*x, residual);
      residual.update(1.0, *b, -1.0);
      achieved = size > 0.0 ? norm(residual, c) / size : 0.0;
      constexpr double least = 1e-14;
      if (!isAsked || achieved <= criteria->requestedTol)
        break;
      if (tolerance <= least) {
        status.solveStatus = Thyra::SOLVE_STATUS_UNCONVERGED;
        status.message = "the residual asked for is below rounding errors";
        break;
      }
      tolerance = std::max(tolerance * std::min(0.3 * criteria->requestedTol / achieved, 0.1), least);
    }
    status.achievedTol = std::max(status.achievedTol, achieved);
    if (status.solveStatus != Thyra::SOLVE_STATUS_CONVERGED)
      break;
  }
  return status;
}

bool FetiLinearOpWithSolveFactory::isCompatible(const Thyra::LinearOpSourceBase<double>& source) const {
  return !tornOperator(source).is_null();
}

Teuchos::RCP<Thyra::LinearOpWithSolveBase<double>> FetiLinearOpWithSolveFactory::createOp() const {
  return Teuchos::rcp(new FetiLinearOpWithSolve);
}

void FetiLinearOpWithSolveFactory::initializeOp(
    const Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>& source,
    Thyra::LinearOpWithSolveBase<double>* op, Thyra::ESupportSolveUse) const {
  const Teuchos::RCP<const feti::TornOperator> torn = tornOperator(*source);
  if (torn.is_null())
    throw InputError("Harmos FETI solves with a feti::TornOperator, wrapped by Thyra::createConstLinearOp(); "
                     "an assembled matrix lacks the contributions of the subdomains");
  auto& feti = dynamic_cast<FetiLinearOpWithSolve&>(*op);
  // Graphs decide: matrices alone may be exchanged.
  const auto sameGraph = [](const feti::Subdomain& a, const feti::Subdomain& b) {
    return a.number == b.number && a.numbers == b.numbers && a.stiffness->offsets == b.stiffness->offsets &&
           a.stiffness->columns == b.stiffness->columns && a.fixed.size() == b.fixed.size() &&
           std::equal(a.fixed.begin(), a.fixed.end(), b.fixed.begin(),
                      [](const feti::FixedDof& x, const feti::FixedDof& y) { return x.dof == y.dof; });
  };
  const auto sameRow = [](const ConstraintRow& a, const ConstraintRow& b) {
    return a.kind == b.kind && a.number == b.number && a.disc == b.disc && a.terms.size() == b.terms.size() &&
           std::equal(a.terms.begin(), a.terms.end(), b.terms.begin(),
                      [](const ConstraintRow::Term& x, const ConstraintRow::Term& y) {
                        return x.dof == y.dof && x.coefficient == y.coefficient;
                      });
  };
  const auto reusable = [&] {
    const auto &mine = feti.operator_->subdomains(), &theirs = torn->subdomains();
    return std::equal(mine.begin(), mine.end(), theirs.begin(), theirs.end(), sameGraph) &&
           std::equal(feti.operator_->rows().begin(), feti.operator_->rows().end(), torn->rows().begin(),
                      torn->rows().end(), sameRow);
  };
  const int here = feti.solver_ && reusable() ? 1 : 0;
  int everywhere = 0;
  Teuchos::reduceAll(*torn->comm(), Teuchos::REDUCE_MIN, here, Teuchos::outArg(everywhere));
  if (everywhere == 1) {
    std::vector<std::shared_ptr<const LocalMatrix>> matrices;
    std::vector<std::shared_ptr<const feti::Kernel>> motions;
    for (const feti::Subdomain& subdomain : torn->subdomains()) {
      matrices.push_back(subdomain.stiffness);
      motions.push_back(subdomain.motions);
    }
    feti.solver_->setMatrices(matrices, motions);
  } else {
    feti.solver_ = std::make_unique<feti::FetiSolver>(torn->comm(), torn->subdomains(), torn->rows(),
                                                      list_.is_null() ? Teuchos::ParameterList() : *list_);
  }
  feti.source_ = source;
  feti.forward_ = source->getOp();
  feti.operator_ = torn;
}

void FetiLinearOpWithSolveFactory::uninitializeOp(
    Thyra::LinearOpWithSolveBase<double>* op, Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* source,
    Teuchos::RCP<const Thyra::PreconditionerBase<double>>* preconditioner,
    Teuchos::RCP<const Thyra::LinearOpSourceBase<double>>* approximateSource,
    Thyra::ESupportSolveUse* use) const {
  auto& feti = dynamic_cast<FetiLinearOpWithSolve&>(*op);
  if (source != nullptr)
    *source = feti.source_;
  if (preconditioner != nullptr)
    *preconditioner = Teuchos::null;
  if (approximateSource != nullptr)
    *approximateSource = Teuchos::null;
  if (use != nullptr)
    *use = Thyra::SUPPORT_SOLVE_UNSPECIFIED;
  feti.source_ = Teuchos::null;
  feti.forward_ = Teuchos::null;
  feti.operator_ = Teuchos::null;
  feti.solver_.reset();
}

void FetiLinearOpWithSolveFactory::setParameterList(const Teuchos::RCP<Teuchos::ParameterList>& list) {
  if (!list.is_null()) {
    list->setName("Harmos FETI");
    feti::FetiSolver::parameters().validated(*list, "the parameters given");
  }
  list_ = list;
}

Teuchos::RCP<Teuchos::ParameterList> FetiLinearOpWithSolveFactory::getNonconstParameterList() {
  return list_;
}

Teuchos::RCP<Teuchos::ParameterList> FetiLinearOpWithSolveFactory::unsetParameterList() {
  const Teuchos::RCP<Teuchos::ParameterList> list = list_;
  list_ = Teuchos::null;
  return list;
}

Teuchos::RCP<const Teuchos::ParameterList> FetiLinearOpWithSolveFactory::getParameterList() const {
  return list_;
}

Teuchos::RCP<const Teuchos::ParameterList> FetiLinearOpWithSolveFactory::getValidParameters() const {
  return Teuchos::parameterList(feti::FetiSolver::parameters().defaults());
}

void enableHarmos(Stratimikos::DefaultLinearSolverBuilder& builder, const std::string& name) {
  builder.setLinearSolveStrategyFactory(
      Teuchos::abstractFactoryStd<Thyra::LinearOpWithSolveFactoryBase<double>,
                                  FetiLinearOpWithSolveFactory>(),
      name);
}

} // namespace Harmos
