// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows.hpp"
#include "Harmos_VectorOps.hpp"

#include <cmath>
#include <limits>

namespace Harmos::qp {

/// The feasible point next to a given one,
///
///     min ½‖x − z‖²   subject to   C̄x = c̄ and the bounds,
///
/// by primal-dual active sets: on each, x_F = z_F − C_Fᵀν with C̄x = c̄. No product with A.
///
/// Guarded by tests/unit/qp/test_first_active_set.cpp and tests/unit/qp/test_descent_of_sets.cpp.
template<class Scalar, class MV, class OP>
class NearestFeasible {
 public:
  enum class Outcome {
    Found,
    Unsettled, ///< x meets the equalities and the bounds of its set, but not all bounds
    None       ///< the equalities cannot be met on the set to begin with
  };

  /// @param rows orthonormal, or none. Both to outlive this.
  NearestFeasible(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows)
      : problem_(problem), rows_(rows), x_(MVT::Clone(*problem.rhs(), 1)), y_(MVT::Clone(*x_, 1)) {}

  /// @param set in: where to begin; out: the set of x(), or what it was if there is none. @param active
  /// receives how many entries of it are active.
  /// @note Collective; a factorisation of C_FC_Fᵀ for each set.
  Outcome find(const MV& z, int mostSets, LocalActiveSet& set, long long& active) {
    // What only touches stays as it was, whatever the rounding errors of sums over other numbers of ranks.
    constexpr double touching = 1e-9;
    LocalActiveSet next = set;
    Outcome outcome = Outcome::None;
    for (int k = 0; k < mostSets && solve(z, next); ++k) {
      set = next;
      const ActiveSetChange change =
          BT::updateActiveSet(*x_, *y_, problem_.lowerBound().get(), problem_.upperBound().get(),
                              touching * norm<Scalar>(*x_), touching * norm<Scalar>(z), next);
      outcome = change.changed == 0 ? Outcome::Found : Outcome::Unsettled;
      if (change.changed == 0)
        break;
    }
    constexpr double unmoved = std::numeric_limits<double>::max();
    active = BT::updateActiveSet(*x_, *y_, problem_.lowerBound().get(), problem_.upperBound().get(), unmoved,
                                 unmoved, set)
                 .active;
    if (outcome == Outcome::Found)
      BT::project(*x_, problem_.lowerBound().get(), problem_.upperBound().get());
    return outcome;
  }

  const MV& x() const { return *x_; }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;

  // x on a face, and the multipliers of its active bounds in y.
  bool solve(const MV& z, const LocalActiveSet& active) {
    MVT::Assign(z, *x_);
    BT::moveToBounds(*x_, problem_.lowerBound().get(), problem_.upperBound().get(), active);
    MVT::MvAddMv(1.0, *x_, -1.0, z, *y_);
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
      MVT::MvAddMv(1.0, *y_, -1.0, *correction, *y_);
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
};

} // namespace Harmos::qp
