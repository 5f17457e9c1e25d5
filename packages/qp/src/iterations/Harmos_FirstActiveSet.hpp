// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows.hpp"
#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_VectorOps.hpp"

#include <cmath>
#include <limits>

namespace Harmos::qp {

/// A guess of the active set that costs no product with A: that of the problem with a number in the place of
/// A,
///
///     min ½s‖x‖² − bᵀx   subject to   C̄x = c̄ and the bounds,   s = bᵀb / bᵀM⁻¹b,
///
/// M⁻¹ the preconditioner, an approximation of A⁻¹. Primal-dual active sets solve it, each by a projection:
/// x_F = b_F/s − C_Fᵀν with C̄x = c̄.
///
/// In contact it knows what moves bodies as a whole: there loads and prescribed displacements meet gaps, and
/// forces of contact hold what nothing else holds. Strains are those of equal springs, one a row; the
/// active sets that follow mend what they are wrong about. Without loads s has no influence.
///
/// Guarded by tests/unit/qp/test_first_active_set.cpp.
template<class Scalar, class MV, class OP>
class FirstActiveSet {
 public:
  /// @param rows orthonormal, or none. All to outlive this.
  FirstActiveSet(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows,
                 Counters& counters)
      : problem_(problem),
        rows_(rows),
        x_(MVT::CloneCopy(*problem.rhs())),
        y_(MVT::Clone(*x_, 1)),
        stiffness_(stiffness(counters)) {}

  /// @param set in: where to begin; out: the guess, or what it was. @param active receives how many entries
  /// of it are active.
  /// @return whether there is a guess: not without a preconditioner, and not where the equalities cannot be
  /// met on the set to begin with.
  /// @note Collective; a factorisation of C_FC_Fᵀ for each set.
  bool find(LocalActiveSet& set, long long& active) {
    if (!(stiffness_ > 0.0) || !std::isfinite(stiffness_))
      return false;
    // What only touches stays as it was, whatever the rounding errors of sums over other numbers of ranks.
    constexpr double touching = 1e-9;
    LocalActiveSet next = set;
    bool found = false;
    for (int k = 0; k < mostSets && solve(next); ++k) {
      found = true;
      set = next;
      const ActiveSetChange change =
          BT::updateActiveSet(*x_, *y_, problem_.lowerBound().get(), problem_.upperBound().get(),
                              touching * norm<Scalar>(*x_), touching * norm<Scalar>(*problem_.rhs()), next);
      active = change.active;
      if (change.changed == 0)
        break;
    }
    return found;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  // A guess needs no more; half a ball with 8065 candidates took 6 to 13.
  static constexpr int mostSets = 12;

  double stiffness(Counters& counters) {
    InFacePreconditioner<Scalar, MV, OP> preconditioner(problem_, counters);
    if (!preconditioner.isPresent())
      return 0.0;
    const MV& b = *problem_.rhs();
    preconditioner.apply(b, LocalActiveSet{}, *y_);
    return dot<Scalar>(b, b) / dot<Scalar>(b, *y_);
  }

  // x on a face, and the multipliers of its active bounds in y.
  bool solve(const LocalActiveSet& active) {
    const MV& b = *problem_.rhs();
    MVT::MvAddMv(1.0 / stiffness_, b, 0.0, b, *x_);
    BT::moveToBounds(*x_, problem_.lowerBound().get(), problem_.upperBound().get(), active);
    MVT::MvAddMv(stiffness_, *x_, -1.0, b, *y_);
    if (!rows_.isPresent())
      return true;
    const Teuchos::RCP<const FaceGram> gram = rows_.faceGram(active);
    const Teuchos::RCP<MV> residual = rows_.makeVector(), correction = MVT::Clone(*x_, 1);
    const auto findResidual = [&] {
      rows_.apply(*x_, *residual);
      MVT::MvAddMv(1.0, *residual, -1.0, rows_.values(), *residual);
    };
    for (int pass = 0; pass < 2; ++pass) { // a second time for what rounding left
      findResidual();
      BT::scatter(gram->solve(BT::gather(*residual)), *residual);
      MVT::MvInit(*correction, 0.0);
      rows_.addTransposed(-1.0, *residual, *correction);
      MVT::MvAddMv(1.0, *y_, -stiffness_, *correction, *y_);
      BT::maskActive(*correction, active);
      MVT::MvAddMv(1.0, *x_, 1.0, *correction, *x_);
    }
    findResidual();
    // A face that misses the equalities does so by more than rounding errors.
    const double scale = norm<Scalar>(*x_) + norm<Scalar>(rows_.values());
    return norm<Scalar>(*residual) <= std::sqrt(std::numeric_limits<double>::epsilon()) * scale;
  }

  const Problem<Scalar, MV, OP>& problem_;
  const EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> x_, y_;
  double stiffness_;
};

} // namespace Harmos::qp
