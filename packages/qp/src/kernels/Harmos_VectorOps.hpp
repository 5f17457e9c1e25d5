// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>

#include <vector>

namespace Harmos::qp {

/// xᵀy of one-column vectors. @note Collective.
template<class Scalar, class MV>
double dot(const MV& x, const MV& y) {
  std::vector<Scalar> result(1);
  Belos::MultiVecTraits<Scalar, MV>::MvDot(x, y, result);
  return result[0];
}

/// ‖x‖ of a one-column vector. @note Collective.
template<class Scalar, class MV>
double norm(const MV& x) {
  std::vector<double> result(1);
  Belos::MultiVecTraits<Scalar, MV>::MvNorm(x, result);
  return result[0];
}

} // namespace Harmos::qp
