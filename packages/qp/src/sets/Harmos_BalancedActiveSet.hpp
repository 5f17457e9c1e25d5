// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FollowingOps.hpp"
#include "Harmos_NearestFeasible.hpp"

#include <memory>

namespace Harmos::qp {

/// The next active set of PDAS where forces have limits on all sides, as friction has: that of the feasible
/// point next to x − y/q, y the gradient of the Lagrangian and q the stiffness of springs, one
/// an entry.
///
/// PDAS looks at each entry by itself. Where all forces on a body are at their limits they need not balance,
/// and where but one is not, that one has to balance the others whatever its own limit is: entries change
/// places without end. The feasible point knows what bodies do as a whole: they turn until something sticks.
/// At the solution the set is the solution's, for x is the feasible point next to x − y/q there.
///
/// Limits that follow the solution are those of x. Where they cannot hold a body, as they may far from the
/// solution, they are widened while the set is found.
///
/// Costs no product with A. Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class BalancedActiveSet {
 public:
  BalancedActiveSet(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows)
      : problem_(problem), rows_(rows) {}

  /// Whether there is such a set: equalities, and limits on both sides, or discs.
  bool isFit() const {
    return rows_.isPresent() && (problem_.hasDiscs() || problem_.feasibleSet().isTwoSided());
  }

  /// @param stiffness q; zero: not known.
  void aim(const MV& x, const MV& y, double stiffness) {
    aim_ = Teuchos::null;
    if (!(stiffness > 0.0) || !std::isfinite(stiffness))
      return;
    stiffness_ = stiffness;
    aim_ = MVT::CloneCopy(x);
    size_ = norm<Scalar>(x);
    MVT::MvAddMv(1.0, x, -1.0 / stiffness, y, *aim_);
  }

  bool isAimed() const { return !aim_.is_null(); }

  /// @param set in: where to begin; out: the set, or what it was. @param active receives how many entries of
  /// it are active. @return whether there is one.
  /// @note Collective; some factorisations of C_FC_Fᵀ, tens where many bodies turn.
  bool find(ActiveFace& set, long long& active) {
    if (aim_.is_null())
      return false;
    constexpr int mostSets = 4, mostWidenings = 20;
    constexpr double widening = 1.5;
    constexpr double unbalance = 1e-6;
    Nearest nearest(problem_, rows_);
    nearest.unbalance(unbalance * size_);
    const auto isFound = [&](bool smoothly) {
      ActiveFace next = set;
      long long count = 0;
      const typename Nearest::Outcome outcome = smoothly
                                                    ? nearest.findSmoothly(*aim_, next, count, stiffness_)
                                                    : nearest.find(*aim_, mostSets, next, count);
      if (outcome != Nearest::Outcome::Found)
        return false;
      set = next;
      active = count;
      return true;
    };
    if ((!problem_.hasDiscs() && isFound(false)) || isFound(true))
      return true;
    if (!problem_.hasFollowingLimits())
      return false;
    const auto copyOf = [](const Teuchos::RCP<const MV>& bound) {
      return bound.is_null() ? Teuchos::null : MVT::CloneCopy(*bound);
    };
    const Teuchos::RCP<MV> radii = MVT::Clone(*aim_, 1), lower = copyOf(problem_.lowerBound()),
                           upper = copyOf(problem_.upperBound());
    std::unique_ptr<LocalDiscs> discs;
    if (problem_.hasDiscs())
      discs = std::make_unique<LocalDiscs>(*problem_.feasibleSet().discs);
    problem_.limits(*radii);
    nearest.setBounds(lower.get(), upper.get(), discs.get());
    for (int k = 0; k < mostWidenings; ++k) {
      MVT::MvAddMv(widening, *radii, 0.0, *radii, *radii);
      FollowingOps<Scalar, MV>::vectorToLimits(problem_.followingLimits(), *radii, *lower, upper.get(),
                                               discs.get());
      if (isFound(true))
        return true;
    }
    return false;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Nearest = NearestFeasible<Scalar, MV, OP>;

  const Problem<Scalar, MV, OP>& problem_;
  const EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> aim_;                // x − y/q
  double size_ = 0.0, stiffness_ = 1.0; // ‖x‖; q
};

} // namespace Harmos::qp
