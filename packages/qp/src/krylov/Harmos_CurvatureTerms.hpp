// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_VectorOps.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <functional>

namespace Harmos::qp {

/// The size of the terms that a curvature pᵀAp/‖p‖² is a sum of; it is known to ε times that, not to ε‖A‖.
///
/// With ξ_i of random size and sign, E[(p∘ξ)ᵀA(p∘ξ)] = E[ξ²]·Σ a_ii p_i², and for a positive semidefinite A
/// no term |a_ij p_i p_j| is larger than √(a_ii p_i²·a_jj p_j²): what cancels for p does not for p∘ξ. So a
/// small curvature that is a number of its own, as of a unit in which an entry is measured, is told from one
/// that is left of larger ones. Two samples, the larger one counts.
///
/// Guarded by tests/unit/qp/problems/test_tiny_curvatures.cpp.
///
/// @param apply y = Ax; called twice. @note Collective.
template<class Scalar, class MV>
double curvatureTerms(const std::function<void(const MV&, MV&)>& apply, const MV& p) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  const Teuchos::RCP<MV> random = MVT::Clone(p, 1), scaled = MVT::CloneCopy(p), image = MVT::Clone(p, 1);
  Bounds::setRandom(*random);
  const double length = norm<Scalar>(p);
  double terms = 0.0;
  constexpr int samples = 2;
  for (int k = 0; k < samples; ++k) {
    Bounds::multiply(*random, *scaled);
    apply(*scaled, *image);
    terms = std::max(terms, dot<Scalar>(*scaled, *image) / (length * length));
  }
  constexpr double meanSquare = 1.0 / 3.0; // of ξ, even within [−1, 1]
  return terms / meanSquare;
}

} // namespace Harmos::qp
