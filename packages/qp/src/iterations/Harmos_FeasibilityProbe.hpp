// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_MprgpIteration_def.hpp"

#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::qp {

/// Decides whether bounds and equalities can be met together: min ½‖C̄x − c̄‖² over the bounds, by MPRGP, with
/// no product with A.
///
/// At the minimiser, r = C̄x − c̄ satisfies rᵀ(C̄y − c̄) ≥ ‖r‖² for every y within the bounds (the optimality of
/// x); r ≠ 0 so proves that there is no feasible point (Farkas' lemma). The proof is checked as it stands,
/// not inferred from convergence: the infimum of rᵀ(C̄y − c̄) over the bounds is evaluated. Where r pushes
/// against an entry without a bound by a rounding error, the proof holds for all y up to a norm, and that is
/// asked to be 10⁶ times those at hand.
///
/// Guarded by tests/unit/qp/test_hard_problems.cpp, test_random_problems.cpp.
template<class Scalar, class MV, class OP>
class FeasibilityProbe {
 public:
  enum class Verdict { Feasible, Infeasible, Undecided };

  FeasibilityProbe(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows)
      : problem_(problem), rows_(rows) {}

  /// @param y receives the proof, in the user's rows, with norm 1. @note Collective.
  Verdict run(int mostSteps, MV& y, Certificate& certificate) {
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    Counters counters;
    const FeasibleSet<MV> feasible = problem_.feasibleSet();
    const Teuchos::RCP<MV> x = MVT::CloneCopy(*problem_.solution()), gradient = MVT::Clone(*x, 1),
                           rhs = MVT::Clone(*x, 1), r = rows_.makeVector(), work = rows_.makeVector();
    BoundOps<Scalar, MV>::project(*x, feasible);
    MVT::MvInit(*rhs, 0.0);
    rows_.addTransposed(1.0, rows_.values(), *rhs);
    MprgpIteration<Scalar, MV> iteration(
        [&](const MV& in, MV& out) {
          rows_.apply(in, *work);
          MVT::MvInit(out, 0.0);
          rows_.addTransposed(1.0, *work, out);
        },
        nullptr, feasible, MprgpOptions(), counters);
    MVT::MvInit(*gradient, 0.0);
    rows_.residual(*x, *r);
    rows_.addTransposed(1.0, *r, *gradient);
    iteration.start(x, gradient, rhs, rows_.norm2(), rows_.norm2());
    for (int step = 0; step <= mostSteps; ++step) {
      rows_.residual(*x, *r);
      const double residual = norm<Scalar>(*r), root = std::sqrt(rows_.norm2());
      const double size = root * norm<Scalar>(*x) + rows_.valuesNorm();
      if (residual <= 1e-9 * size)
        return Verdict::Feasible;
      if (proves(*r, residual, *x, y, certificate))
        return Verdict::Infeasible;
      // Rounding errors of the gradient: nothing more will come.
      if (std::sqrt(iteration.sums().projectedNorm2()) <= 1e-15 * root * size)
        break;
      const auto outcome = iteration.step();
      if (outcome == MprgpIteration<Scalar, MV>::Outcome::Breakdown ||
          outcome == MprgpIteration<Scalar, MV>::Outcome::Unbounded)
        break;
    }
    return Verdict::Undecided;
  }

 private:
  bool proves(const MV& r, double residual, const MV& x, MV& y, Certificate& certificate) {
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    const Teuchos::RCP<MV> w = MVT::Clone(x, 1);
    MVT::MvInit(*w, 0.0);
    rows_.addTransposed(1.0 / residual, r, *w);
    const BoxInfimum infimum = BoundOps<Scalar, MV>::boxInfimum(*w, problem_.feasibleSet());
    const double gap = infimum.value - dot<Scalar>(r, rows_.values()) / residual;
    // No size at hand is zero for a problem that has any: c̄ ≠ 0, or x = 0 would be feasible or out of bounds.
    const double radius =
        1e6 * std::max({norm<Scalar>(x), infimum.boundNorm, rows_.valuesNorm() / std::sqrt(rows_.norm2())});
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
};

} // namespace Harmos::qp
