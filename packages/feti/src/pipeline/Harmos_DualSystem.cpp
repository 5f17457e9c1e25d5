// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualSystem.hpp"

#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Errors.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti {
namespace {

// Of any columns; what it refers to it keeps.
class ProjectedPreconditioner : public Operator {
 public:
  // @param adaptive null: no vectors.
  ProjectedPreconditioner(Teuchos::RCP<const Operator> inner, Teuchos::RCP<const CoarseSpace> coarse,
                          Teuchos::RCP<const AdaptiveSpace> adaptive)
      : inner_(std::move(inner)), coarse_(std::move(coarse)), adaptive_(std::move(adaptive)) {}

  Teuchos::RCP<const Map> getDomainMap() const override { return inner_->getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }

  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
             Scalar beta) const override {
    MultiVector load(X, Teuchos::Copy), image(Y.getMap(), Y.getNumVectors());
    coarse_->project(load);
    if (adaptive_.is_null()) {
      inner_->apply(load, image);
    } else {
      MultiVector left(load, Teuchos::Copy);
      adaptive_->deflation()->removeFromLoad(left);
      inner_->apply(left, image);
      adaptive_->deflation()->complete(load, image);
    }
    coarse_->project(image);
    if (beta == 0.0)
      Y.scale(alpha, image);
    else
      Y.update(alpha, image, beta);
  }

 private:
  Teuchos::RCP<const Operator> inner_;
  Teuchos::RCP<const CoarseSpace> coarse_;
  Teuchos::RCP<const AdaptiveSpace> adaptive_;
};

} // namespace

DualSystem::DualSystem(DualStages stages) : stages_(std::move(stages)) {
  if (stages_.constraints->inequalities() + stages_.constraints->limited() > 0)
    throw InputError(
        "a problem with inequalities or limited forces is no linear system; solve it by a solver "
        "of the QP layer");
}

Teuchos::RCP<const Map> DualSystem::getDomainMap() const {
  return stages_.constraints->rowMap();
}

void DualSystem::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                       Scalar beta) const {
  stages_.problem->hessian()->apply(X, Y, mode, alpha, beta);
}

Teuchos::RCP<const Operator> DualSystem::preconditioner(Preconditioner kind, PreconditionerScaling scaling,
                                                        const Log& log) const {
  const DualStages& s = stages_;
  if (kind != Preconditioner::Deflation) {
    const PreconditionerKind inner =
        kind == Preconditioner::Dirichlet ? PreconditionerKind::Dirichlet : PreconditionerKind::Lumped;
    const auto made =
        Teuchos::rcp(new DualPreconditioner(*s.system, *s.constraints, *s.inverses, inner, scaling));
    return Teuchos::rcpWithEmbeddedObjPostDestroy<const Operator>(
        new ProjectedPreconditioner(made, s.coarse, Teuchos::null), s);
  }
  if (s.preconditioner.is_null() || s.adaptive.is_null() || !s.adaptive->isPossible())
    throw InputError(
        "the preconditioner by deflation needs a preconditioner and adaptive coarse vectors; set "
        "\"Dual operator/Preconditioner\" and \"Dual operator/Expert/Adaptive coarse vectors\"");
  if (!s.adaptive->isMade())
    s.adaptive->make(log);
  if (s.adaptive->deflation() == nullptr)
    throw InputError("there is no adaptive coarse vector above the threshold; use the preconditioner "
                     "\"Dirichlet\", or a lower \"Dual operator/Expert/Adaptive threshold\"");
  return Teuchos::rcpWithEmbeddedObjPostDestroy<const Operator>(
      new ProjectedPreconditioner(s.preconditioner, s.coarse, s.adaptive), s);
}

TornSolution DualSystem::recover(const MultiVector& lambda) const {
  const Teuchos::RCP<const Operator> rows = stages_.problem->equalityRows();
  const std::size_t size = rows.is_null() ? 0 : localSize(*rows->getRangeMap());
  return feti::recover(*stages_.system, *stages_.constraints, *stages_.inverses, *stages_.coarse,
                       *stages_.problem, lambda, std::vector<double>(size, 0.0));
}

} // namespace Harmos::feti
