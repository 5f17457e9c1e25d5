// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceSolver.hpp"
#include "Harmos_NearestFeasible.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::qp {

/// Makes primal-dual active sets descend: each face begins at a feasible point whose cost
/// f = ½xᵀAx − bᵀx is below that of the last one by a fixed part of what conjugate gradients gained on the
/// face between.
///
/// What a face leads to is brought back to the nearest feasible point. Where that costs too much of the gain,
/// a projected gradient step from the last point takes its place,
///
///     x ← Π(x_r − α g_r),   f(x) ≤ f(x_r) − ‖x − x_r‖²/(4α),
///
/// which holds for α ≤ 4/(3‖A‖) at the latest, Π the projection onto the equalities and bounds together. So
/// no set can come back for ever: the gain on a face vanishes with the projected gradient alone (gradient
/// projection and conjugate gradients in turns: Moré, Toraldo, SIAM J. Optim. 1, 1991, there for bounds).
///
/// A face costs no product more than without, a safe step one. Guarded by
/// tests/unit/qp/newton/test_descent_of_sets.cpp.
template<class Scalar, class MV, class OP>
class DescentOfSets {
 public:
  DescentOfSets(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows,
                FaceSolver<Scalar, MV, OP>& cg)
      : x_(*problem.solution()),
        cg_(cg),
        nearest_(problem, rows),
        reference_(MVT::Clone(x_, 1)),
        gradient_(MVT::Clone(x_, 1)),
        work_(MVT::Clone(x_, 1)),
        blocks_(problem.blocks()) {
    MVT::MvInit(*reference_, 0.0);
  }

  bool isOn() const { return isOn_; }
  /// The cost is another one.
  void end() { isOn_ = false; }

  /// Descends from now on: the problem's solution becomes the feasible point next to it.
  /// @return false if none is found; nothing has changed then.
  bool begin(ActiveFace& set, long long& active) {
    const Teuchos::RCP<MV> start = MVT::CloneCopy(x_);
    ActiveFace next = set;
    isOn_ = moveToFeasible(*start, next, active);
    if (isOn_)
      set = next;
    referenceCost_ = std::numeric_limits<double>::infinity();
    promised_ = 0.0;
    return isOn_;
  }

  /// After conjugate gradients have begun on a face: is it below the last one? If not, they begin at a safe
  /// step from there. @return false if no step descends: rounding errors.
  bool enter(ActiveFace& set, long long& active) {
    if (!isOn_)
      return true;
    constexpr double part = 0.1; // of the gain
    const double noise = 100.0 * std::numeric_limits<double>::epsilon() * std::abs(referenceCost_);
    double cost = cg_.cost(), limit = referenceCost_ - part * promised_ + noise;
    double step = firstStep();
    const Teuchos::RCP<MV> z = MVT::Clone(x_, 1);
    for (int k = 0; !(cost <= limit); ++k, step *= 0.5) {
      MVT::MvAddMv(1.0, *reference_, -step, *gradient_, *z);
      if (k == mostHalvings || !moveToFeasible(*z, set, active) || !cg_.start(set))
        return false;
      cost = cg_.cost();
      limit = referenceCost_ - moved2_ / (4.0 * step) + noise;
    }
    keep(cost);
    return true;
  }

  /// Whether conjugate gradients have left the bounds so far behind that the way back may cost what they have
  /// gained: ½‖A‖‖x − Π(x)‖², Π onto the bounds.
  bool isAstray(const ActiveFace& set) {
    if (!isOn_)
      return false;
    ActiveFace copy = set;
    MVT::MvInit(*work_, 0.0);
    constexpr double rounding = 10.0 * std::numeric_limits<double>::epsilon();
    const FaceChange change = BlockOps<Scalar, MV>::update(
        blocks_, x_, *work_, {rounding * norm<Scalar>(x_), 1.0, 0.0, 0.0, true}, copy);
    return change.changed > 0 && 0.5 * cg_.curvatureBound() * change.violation2 > referenceCost_ - cg_.cost();
  }

  /// What a face has led to, before the next one: x becomes feasible, and the set that of the point, without
  /// the entries that were freed.
  /// @param cost of x. @param before the set of the face. @param set that which primal-dual active sets go on
  /// with.
  /// @return whether there is a feasible point.
  bool leave(double cost, bool isFeasible, const ActiveFace& before, ActiveFace& set, long long& active) {
    if (!isOn_)
      return true;
    promised_ = std::max(0.0, referenceCost_ - cost);
    if (isFeasible) { // and what it has gained is safe
      keep(cost);
      promised_ = 0.0;
      return true;
    }
    const Teuchos::RCP<MV> z = MVT::CloneCopy(x_);
    ActiveFace next = set;
    if (!moveToFeasible(*z, next, active))
      return false;
    for (std::size_t i = 0; i < next.size() && i < before.size(); ++i)
      if (before[i] != 0 && set[i] == 0)
        next[i] = 0;
    set = next;
    active = nearest_.count(set);
    return true;
  }

  void exchange(StateArchive<MV>& archive) {
    archive.number("descent on", isOn_);
    if (!isOn_)
      return;
    archive.number("descent cost", referenceCost_);
    archive.number("descent promised", promised_);
    archive.vector("descent reference", *reference_);
    archive.vector("descent gradient", *gradient_);
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Nearest = NearestFeasible<Scalar, MV, OP>;
  static constexpr int mostSets = 50, mostHalvings = 40;

  bool moveToFeasible(const MV& z, ActiveFace& set, long long& active) {
    ActiveFace none(set.size(), 0);
    none.springs = set.springs;
    if (nearest_.find(z, mostSets, set, active) != Nearest::Outcome::Found) {
      if (nearest_.find(z, mostSets, none, active) != Nearest::Outcome::Found)
        return false;
      set = none;
    }
    MVT::MvAddMv(1.0, nearest_.x(), -1.0, *reference_, x_);
    moved2_ = dot<Scalar>(x_, x_);
    MVT::Assign(nearest_.x(), x_);
    return true;
  }

  // 1/‖A‖ where conjugate gradients have told a bound of it; else a long one.
  double firstStep() const {
    if (cg_.curvatureBound() > 0.0)
      return 1.0 / cg_.curvatureBound();
    const double length = norm<Scalar>(*reference_), slope = norm<Scalar>(*gradient_);
    return length > 0.0 && slope > 0.0 ? length / slope : 1.0;
  }

  void keep(double cost) {
    MVT::Assign(x_, *reference_);
    cg_.lagrangianGradient(*gradient_);
    referenceCost_ = cost;
  }

  MV& x_;
  FaceSolver<Scalar, MV, OP>& cg_;
  Nearest nearest_;
  Teuchos::RCP<MV> reference_, gradient_; // of the Lagrangian there
  Teuchos::RCP<MV> work_;
  Blocks blocks_;
  double referenceCost_ = std::numeric_limits<double>::infinity();
  double promised_ = 0.0; // what conjugate gradients have gained since
  double moved2_ = 0.0;
  bool isOn_ = false;
};

} // namespace Harmos::qp
