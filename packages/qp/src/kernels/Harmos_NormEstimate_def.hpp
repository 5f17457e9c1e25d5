// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_NormEstimate.hpp"
#include "Harmos_VectorOps.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace Harmos::qp {

template<class Scalar, class MV>
double estimateNorm(const std::function<void(const MV&, MV&)>& apply, MV& start, int mostApplications,
                    int& applications) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const double startNorm = norm<Scalar>(start);
  if (!(startNorm > 0.0))
    return 0.0;
  Teuchos::RCP<MV> v = MVT::CloneCopy(start);
  MVT::MvScale(*v, 1.0 / startNorm);
  Teuchos::RCP<MV> previous = MVT::Clone(start, 1);
  MVT::MvInit(*previous, 0.0);
  Teuchos::RCP<MV> w = MVT::Clone(start, 1);
  std::vector<double> alpha, beta;
  double estimate = 0.0;
  for (int k = 0; k < mostApplications; ++k) {
    apply(*v, *w);
    ++applications;
    alpha.push_back(dot<Scalar>(*w, *v));
    MVT::MvAddMv(1.0, *w, -alpha.back(), *v, *w);
    if (k > 0)
      MVT::MvAddMv(1.0, *w, -beta.back(), *previous, *w);
    const double nextBeta = norm<Scalar>(*w);

    // Largest Ritz pair of the tridiagonal matrix; the last component of its vector gives the residual.
    const int size = k + 1;
    std::vector<double> d = alpha, e = beta, z(static_cast<std::size_t>(size * size)),
                        work(static_cast<std::size_t>(std::max(1, 2 * size)));
    e.resize(static_cast<std::size_t>(size));
    int info = 0;
    Teuchos::LAPACK<int, double>().STEQR('I', size, d.data(), e.data(), z.data(), size, work.data(), &info);
    const double ritz = std::max(d.back(), 0.0);
    const double residual = nextBeta * std::abs(z.back());
    estimate = ritz + residual;
    if (!std::isfinite(estimate) || residual <= 0.02 * ritz || nextBeta <= 1e-14 * estimate)
      break;
    beta.push_back(nextBeta);
    std::swap(previous, v);
    MVT::MvAddMv(1.0 / nextBeta, *w, 0.0, *w, *v);
  }
  return estimate;
}

} // namespace Harmos::qp
