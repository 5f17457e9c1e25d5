// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FirstActiveSet.hpp"
#include "Harmos_NewtonState.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

/// The first face of a semismooth Newton method. From a solution nearby, or where there is no better guess:
/// entries at a bound that the gradient pushes against it. The gradient costs a product where x is not zero.
///
/// Guarded by tests/unit/qp/newton/test_first_active_set.cpp.
template<class Scalar, class MV, class OP>
class FirstFace {
 public:
  using State = NewtonState<Scalar, MV, OP>;

  /// @param isCold nothing is known of the solution.
  FirstFace(State& state, bool isCold) : s_(state), isCold_(isCold) {}

  /// @return whether the state's solver has begun on the face already. @note Collective.
  bool find() {
    const bool hasStarted = findBounded();
    // Without limits there are forces that hold whatever can be held, and the face has a solution.
    if (isCold_)
      for (const auto& block : s_.problem.blocks())
        block->release(s_.face);
    return hasStarted;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Terms = BlockOps<Scalar, MV>;
  using Nearest = FirstActiveSet<Scalar, MV, OP>;
  using First = NewtonOptions::FirstFace;

  bool findBounded() {
    MVT::MvAddMv(-1.0, *s_.problem.rhs(), 0.0, *s_.problem.rhs(), *s_.y);
    addMultiplier();
    Bounds::split(s_.x, *s_.y, feasible(), 1.0, nullptr, s_.face);
    if (!s_.problem.kind().isSet)
      findSides();
    const First first = s_.options.firstFace;
    if (isCold_ && first != First::Gradient) {
      Nearest nearest(s_.problem, s_.rows, s_.counters);
      if (first == First::Nearest || isAtAllBounds(nearest.scale())) {
        if (nearest.find(s_.face, s_.active))
          return false;
      } else if (first == First::Tried && triesNearest(nearest)) {
        return true;
      }
    }
    ActiveFace pushed = s_.face;
    s_.change = Terms::update(feasible(), s_.x, *s_.y, {}, pushed);
    bool hasStarted = false;
    if (norm<Scalar>(s_.x) > 0.0)
      hasStarted = startsWithActive();
    else
      s_.face = pushed;
    s_.active = s_.change.active;
    return hasStarted;
  }

  FeasibleSet<MV> feasible() const { return s_.problem.feasibleSet(); }

  // Of terms with forces of their own: by the side where x is; where nothing is known, by that of the nearest
  // feasible point, see FirstActiveSet.
  void findSides() {
    Teuchos::RCP<MV> at = MVT::CloneCopy(s_.x);
    if (isCold_) {
      Nearest nearest(s_.problem, s_.rows, s_.counters);
      ActiveFace face = s_.face;
      long long active = 0;
      if (nearest.find(face, active))
        MVT::Assign(nearest.x(), *at);
    }
    Terms::update(Terms::withForces(s_.problem.blocks()), *at, *s_.y, {}, s_.face);
    if (!isCold_)
      s_.solver.knowSprings(s_.face);
  }

  // Whether x is at each bound there is: in contact, no load acts on a body as a whole. Elsewhere the
  // gradient knows the elasticity of what is pushed against the bounds. Where loads cancel, what is left of
  // them on a whole body is rounding errors.
  bool isAtAllBounds(double scale) {
    const auto count = [this](const MV& x) {
      const Teuchos::RCP<MV> none = MVT::Clone(x, 1);
      MVT::MvInit(*none, 0.0);
      ActiveFace face;
      const FeasibleSet<MV> bounds = {feasible().lower, feasible().upper, nullptr};
      return Terms::update(bounds, x, *none, {}, face).active;
    };
    constexpr double beyond = 1e100, rounding = 1e-10; // all bounds; of an entry
    const double entries = std::sqrt(static_cast<double>(MVT::GetGlobalLength(s_.x)));
    const double slack = std::max(std::numeric_limits<double>::min(), rounding * scale / entries);
    const Teuchos::RCP<MV> below = MVT::CloneCopy(s_.x), outside = MVT::Clone(s_.x, 1);
    // Just outside, those that x is at; far outside, all.
    MVT::MvInit(*outside, -slack);
    MVT::MvAddMv(1.0, s_.x, 1.0, *outside, *below);
    const long long here = count(*below);
    MVT::MvInit(*outside, -beyond);
    const long long all = count(*outside);
    return all > 0 && here == all;
  }

  // Loads on bodies as a whole: the face of the nearest point is much the better one for solids, and none at
  // all for membranes pushed evenly against others. The residual on it tells.
  bool triesNearest(Nearest& nearest) {
    ActiveFace face = s_.face;
    long long active = 0;
    if (!nearest.find(face, active))
      return false;
    const Teuchos::RCP<MV> load = MVT::CloneCopy(*s_.problem.rhs()), before = MVT::CloneCopy(s_.x);
    if (s_.rows.isPresent()) { // its part in the kernel of the rows
      const Teuchos::RCP<MV> removed = s_.rows.makeVector();
      s_.rows.apply(*load, *removed);
      s_.rows.addTransposed(-1.0, *removed, *load);
    }
    // On solids 0.01 to 0.12 was measured, where the face was none 0.2 to 1.
    constexpr double good = 0.15;
    if (!s_.solver.start(face) || s_.solver.residualNorm() > good * norm<Scalar>(*load)) {
      MVT::Assign(*before, s_.x);
      return false;
    }
    s_.face = face;
    s_.active = active;
    return true;
  }

  // If the gradient at zero, which costs nothing, mostly pushes against the bounds that x is at, its product
  // is made on the face where all of them are held, as the first one of that face's solution.
  // Pairs in discs slip where the step from x would lead out of them.
  bool startsWithActive() {
    constexpr double mostWrong = 0.1;
    const bool hasPairs = !isCold_ && s_.problem.hasDiscs();
    const Teuchos::RCP<MV> projected = MVT::CloneCopy(s_.x), free = MVT::CloneCopy(*s_.y);
    FaceOps<Scalar, MV>::mask(*free, s_.face);
    const double atBounds2 = dot<Scalar>(*s_.y, *s_.y) - dot<Scalar>(*free, *free);
    if (!hasPairs && s_.change.wrongSign2 <= mostWrong * atBounds2 && s_.solver.start(s_.face)) {
      s_.solver.lagrangianGradient(*s_.y);
      const double noise = 10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(s_.x);
      s_.change = Terms::update(feasible(), s_.x, *s_.y, {noise, 10.0 * s_.solver.attainable()}, s_.face);
      return s_.change.changed == 0;
    }
    MVT::Assign(*projected, s_.x);
    ++s_.counters.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*s_.problem.hessian(), s_.x, *s_.y);
    MVT::MvAddMv(1.0, *s_.y, -1.0, *s_.problem.rhs(), *s_.y);
    addMultiplier();
    FaceUpdate how;
    if (hasPairs)
      how.stepLength = Nearest(s_.problem, s_.rows, s_.counters).scale() / norm<Scalar>(*s_.problem.rhs());
    s_.change = Terms::update(feasible(), s_.x, *s_.y, how, s_.face);
    return false;
  }

  // Cᵀμ of the problem's multiplier.
  void addMultiplier() {
    if (!s_.rows.isPresent())
      return;
    const Teuchos::RCP<MV> mu = s_.rows.makeVector();
    s_.rows.toInternal(*s_.problem.multiplier(), *mu);
    s_.rows.addTransposed(1.0, *mu, *s_.y);
  }

  State& s_;
  bool isCold_;
};

} // namespace Harmos::qp
