// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseSpace.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <functional>
#include <vector>

namespace Harmos::feti {

class SubdomainSum;

/// Part of the multipliers, span(U), eliminated from a quadratic program:
///
///     F' = F − WWᵀ,   d' = d − WUᵀd,   W = FU,   UᵀFU = I
///
/// min ½λᵀF'λ − λᵀd' is what is left of min ½λᵀFλ − λᵀd when it is minimised over U first, which changes
/// nothing else if U has no entries where λ has bounds and GU = 0. F'λ − d' = F(λ + Uα) − d for the α of
/// complete(): residuals, and the multipliers of Gλ = 0, are those of the whole problem (Nicolaides,
/// Deflation of conjugate gradients, SIAM J. Numer. Anal. 24, 1987; Dostál, Conjugate gradient method with
/// preconditioning by projector, Int. J. Comput. Math. 23, 1988).
///
/// U and W are dense: a product costs two products with W and a reduction of its columns.
/// Guarded by tests/unit/feti/test_adaptive_space.cpp.
class Deflation {
 public:
  /// @param coarse W is projected: F' is to be used between projections. @param vectors columns that span U;
  /// those that depend on the others are left out. They are changed.
  /// @param admit makes of vectors such as have no entries at bounds, and Gx = 0.
  /// @throws NumericalError on all ranks. @note Collective: twice as many products with F, in blocks.
  Deflation(const SubdomainSum& dual, const CoarseSpace& coarse, const Teuchos::RCP<MultiVector>& vectors,
            const std::function<void(MultiVector&)>& admit);

  /// Columns of U; none: nothing else may be asked for.
  int dimension() const { return dimension_; }
  /// Of U and W on this rank.
  double bytes() const;

  /// λ ← λ − UWᵀλ: what F' does not see. @note Collective.
  void removeSpan(MultiVector& lambda) const;
  /// d ← d − WUᵀd. @note Collective.
  void removeFromLoad(MultiVector& d) const;
  /// λ ← λ + U(Uᵀd − Wᵀλ). @note Collective.
  void complete(const MultiVector& d, MultiVector& lambda) const;

 private:
  void add(double factor, const MultiVector& of, const std::vector<double>& w, MultiVector& y) const;

  Teuchos::RCP<MultiVector> u_, w_;
  int dimension_ = 0;
};

} // namespace Harmos::feti
