// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_NearestFeasible.hpp"

#include <cmath>

namespace Harmos::qp {

/// A guess of the active set that costs no product with A: that of the problem with a number in the place of
/// A,
///
///     min ½s‖x‖² − bᵀx   subject to   C̄x = c̄ and the bounds,   s = bᵀb / bᵀM⁻¹b,
///
/// M⁻¹ the preconditioner, an approximation of A⁻¹: the feasible point next to b/s, see NearestFeasible.
///
/// In contact it knows what moves bodies as a whole: there loads and prescribed displacements meet gaps, and
/// forces of contact hold what nothing else holds. Strains are those of equal springs, one a row; the
/// active sets that follow mend what they are wrong about. Without loads s has no influence.
///
/// Pairs that stay in discs are free while it is found, and slip in it where they are outside.
///
/// Guarded by tests/unit/qp/newton/test_first_active_set.cpp.
template<class Scalar, class MV, class OP>
class FirstActiveSet {
 public:
  /// @param rows orthonormal, or none.
  FirstActiveSet(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows,
                 Counters& counters)
      : problem_(problem),
        b_(*problem.rhs()),
        nearest_(problem, rows),
        stiffness_(stiffness(problem, counters)) {}

  /// ‖b‖/s, about that of the solution; 0 without a preconditioner.
  double scale() const {
    return stiffness_ > 0.0 && std::isfinite(stiffness_) ? norm<Scalar>(b_) / stiffness_ : 0.0;
  }

  /// The feasible point, after find() has found it.
  const MV& x() const { return nearest_.x(); }

  /// @param set in: where to begin; out: the guess, or what it was. @param active receives how many entries
  /// of it are active.
  /// @return whether there is a guess: not without a preconditioner, and not where the equalities cannot be
  /// met on the set to begin with.
  /// @note Collective; a factorisation of C_FC_Fᵀ for each set.
  bool find(ActiveFace& set, long long& active) {
    if (!(scale() > 0.0))
      return false;
    for (signed char& state : set)
      state = state == ActiveFace::onRim || state == ActiveFace::slips ? 0 : state;
    set.slipping.clear();
    const Teuchos::RCP<MV> z = MVT::Clone(b_, 1);
    MVT::MvAddMv(1.0 / stiffness_, b_, 0.0, b_, *z);
    if (nearest_.find(*z, mostSets, set, active) == NearestFeasible<Scalar, MV, OP>::Outcome::None)
      return false;
    if (problem_.hasDiscs() && !problem_.hasFollowingLimits())
      active = nearest_.addSlips(problem_.feasibleSet(), 1.0 / stiffness_, set);
    return true;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  // A guess needs no more; half a ball with 8065 candidates took 6 to 13.
  static constexpr int mostSets = 12;

  double stiffness(const Problem<Scalar, MV, OP>& problem, Counters& counters) const {
    InFacePreconditioner<Scalar, MV, OP> preconditioner(problem, counters);
    if (!preconditioner.isPresent())
      return 0.0;
    const Teuchos::RCP<MV> y = MVT::Clone(b_, 1);
    preconditioner.apply(b_, ActiveFace{}, *y);
    return dot<Scalar>(b_, b_) / dot<Scalar>(b_, *y);
  }

  const Problem<Scalar, MV, OP>& problem_;
  const MV& b_;
  NearestFeasible<Scalar, MV, OP> nearest_;
  double stiffness_;
};

} // namespace Harmos::qp
