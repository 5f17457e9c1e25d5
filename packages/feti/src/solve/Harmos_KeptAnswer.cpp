// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_KeptAnswer.hpp"

#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

namespace Harmos::feti::Details {

void KeptAnswer::keep(const MultiVector& lambda, const Teuchos::RCP<const MultiVector>& mu, double gradient,
                      double equality, int inner, const Patience& patience) {
  kept_ = {Teuchos::rcp(new MultiVector(lambda, Teuchos::Copy)),
           mu.is_null() ? Teuchos::null : Teuchos::rcp(new MultiVector(*mu, Teuchos::Copy)), gradient,
           equality};
  patience_ = patience;
  least_ = {gradient, inner};
  isAstray_ = false;
}

void KeptAnswer::observe(int inner, double gradient) {
  if (!isThere())
    return;
  if (gradient < 0.5 * least_.gradient)
    least_ = {gradient, inner};
  isAstray_ = isAstray_ || gradient > patience_.rise * kept_->gradient;
}

bool KeptAnswer::replace(qp::Result& result, MultiVector& lambda, const Teuchos::RCP<MultiVector>& mu) const {
  if (!kept_ || result.converged() || result.reason == qp::Reason::Interrupted)
    return false;
  Tpetra::deep_copy(lambda, *kept_->lambda);
  if (!mu.is_null())
    Tpetra::deep_copy(*mu, *kept_->mu);
  result.reason = qp::Reason::Converged;
  result.projectedGradientNorm = kept_->gradient;
  result.equalityNorm = kept_->equality;
  return true;
}

void KeptAnswer::exchange(qp::StateArchive<MultiVector>& archive, const MultiVector& lambda,
                          const Teuchos::RCP<const MultiVector>& mu) {
  bool isKept = isThere();
  archive.number("answer kept", isKept);
  if (!isKept) {
    forget();
    return;
  }
  if (!kept_)
    keep(lambda, mu, 0.0, 0.0, 0, {});
  archive.vector("answer kept: lambda", *kept_->lambda);
  if (!kept_->mu.is_null())
    archive.rowVector("answer kept: mu", *kept_->mu);
  archive.number("answer kept: gradient", kept_->gradient);
  archive.number("answer kept: equality", kept_->equality);
  archive.number("answer kept: patience", patience_.iterations);
  archive.number("answer kept: rise", patience_.rise);
  archive.number("answer kept: astray", isAstray_);
  archive.number("answer kept: least gradient", least_.gradient);
  archive.number("answer kept: iterations", least_.inner);
}

} // namespace Harmos::feti::Details
