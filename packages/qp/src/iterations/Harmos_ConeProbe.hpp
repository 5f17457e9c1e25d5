// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_VectorOps.hpp"

#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::qp {

/// Decides whether equalities can be met at all where limits follow the solution: min ½‖C̄x − c̄‖² over the
/// cones
///
///     |x_i − c| ≤ f·(x_k − l_k),   x_k ≥ l_k,
///
/// which hold all points that satisfy their own limits, and the bounds of the others. By accelerated
/// projected gradients with restarts (Beck, Teboulle, SIAM J. Imaging Sci. 2, 2009; O'Donoghue, Candès,
/// Found. Comput. Math. 15, 2015), ‖C̄‖ ≤ 1; no product with A.
///
/// The proof is that of FeasibilityProbe: r = C̄x − c̄ with rᵀ(C̄y − c̄) ≥ ½‖r‖² for all y of the cones,
/// evaluated as it stands. In contact r is a motion that no friction hinders: it slides and rises at once.
///
/// Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class ConeProbe {
 public:
  enum class Verdict { Feasible, Infeasible, Undecided };

  /// @param rows orthonormal.
  ConeProbe(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows)
      : problem_(problem), rows_(rows), x_(MVT::CloneCopy(*problem.solution())) {}

  /// The point that was found: within the cones, next to the equalities.
  const MV& x() const { return *x_; }

  /// @param y receives the proof, in the user's rows, with norm 1. @note Collective.
  Verdict run(int mostSteps, MV& y, Certificate& certificate) {
    const Teuchos::RCP<MV> ahead = MVT::CloneCopy(*x_), last = MVT::CloneCopy(*x_), r = rows_.makeVector();
    Limits::projectOntoCones(*x_, problem_.feasibleSet(), problem_.followingLimits());
    MVT::Assign(*x_, *ahead);
    double momentum = 1.0;
    constexpr int between = 25;
    for (int step = 0; step < mostSteps; ++step) {
      if (step % between == 0) {
        rows_.residual(*x_, *r);
        const double residual = norm<Scalar>(*r);
        if (residual <= met * (norm<Scalar>(*x_) + rows_.valuesNorm()))
          return Verdict::Feasible;
        if (proves(*r, residual, y, certificate))
          return Verdict::Infeasible;
      }
      MVT::Assign(*x_, *last);
      rows_.residual(*ahead, *r);
      MVT::Assign(*ahead, *x_);
      rows_.addTransposed(-1.0, *r, *x_);
      Limits::projectOntoCones(*x_, problem_.feasibleSet(), problem_.followingLimits());
      MVT::MvAddMv(1.0, *x_, -1.0, *last, *last); // what it has moved by
      MVT::MvAddMv(1.0, *ahead, -1.0, *x_, *ahead);
      if (dot<Scalar>(*ahead, *last) > 0.0) { // uphill
        momentum = 1.0;
        MVT::Assign(*x_, *ahead);
        continue;
      }
      const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
      MVT::MvAddMv(1.0, *x_, (momentum - 1.0) / next, *last, *ahead);
      momentum = next;
    }
    return Verdict::Undecided;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;
  static constexpr double met = 1e-9;
  static constexpr double farther = 1e4; // than the points at hand: where the proof holds

  bool proves(const MV& r, double residual, MV& y, Certificate& certificate) {
    const Teuchos::RCP<MV> w = MVT::Clone(*x_, 1);
    MVT::MvInit(*w, 0.0);
    rows_.addTransposed(1.0 / residual, r, *w);
    const BoxInfimum infimum = Limits::coneInfimum(*w, problem_.feasibleSet(), problem_.followingLimits());
    const double gap = infimum.value - dot<Scalar>(r, rows_.values()) / residual;
    const double radius = farther * std::max({norm<Scalar>(*x_), infimum.boundNorm, rows_.valuesNorm()});
    if (!(gap >= 0.5 * residual) || !(infimum.openNorm * radius <= gap))
      return false;
    rows_.toUser(r, y);
    const double length = norm<Scalar>(y);
    MVT::MvScale(y, 1.0 / length);
    certificate.gap = gap * residual / length;
    certificate.defect = infimum.openNorm * residual / length;
    return true;
  }

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> x_;
};

} // namespace Harmos::qp
