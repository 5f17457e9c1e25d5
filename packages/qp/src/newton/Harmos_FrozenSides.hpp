// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Strategy.hpp"

#include <limits>

namespace Harmos::qp {

/// On which sides entries with forces of their own are (terms that are no sets): by where x is; or, where
/// Newton's method goes in circles, those of points from which the cost falls, until all else has settled,
/// and x goes from answer to answer as far as the cost falls on the way (generalised Newton's method with
/// line search; Facchinei, SIAM J. Optim. 5, 1995).
///
/// Guarded by tests/unit/qp/test_soft_bounds.cpp.
template<class Scalar, class MV, class OP>
class FrozenSides : public Strategy<Scalar, MV, OP> {
 public:
  using typename Strategy<Scalar, MV, OP>::State;

  explicit FrozenSides(State& state) : Strategy<Scalar, MV, OP>(state) {}

  bool isAgainst(Trouble trouble) const override { return trouble != Trouble::BadFace; }
  bool areFrozen() const { return areFrozen_; }
  bool seesToProgress() const override { return areFrozen_; }

  /// From the best iterate on, sides stay.
  bool propose(const std::string& why) override {
    State& s = this->s_;
    if (s.problem.kind().isSet || !s.problem.kind().isCost || areFrozen_)
      return false;
    MVT::Assign(*s.best.x, s.x);
    areFrozen_ = true;
    at_ = Teuchos::null;
    update(0.0);
    s.progress.forget();
    ++s.counters.descents;
    this->log(why + "; sides of soft bounds frozen at the best iterate until the rest has converged");
    return true;
  }

  /// x is the answer for these sides, y the true gradient. With the quadratic that has the gradient of the
  /// cost at the point before, what leads from there to its least point leads downwards; along that line the
  /// slope of the cost rises, and is known from both ends.
  /// @return whether there is another set of sides, at a point below, where x is then.
  bool move() {
    constexpr int mostSteps = 1000;
    State& s = this->s_;
    const Teuchos::RCP<MV> smooth = MVT::Clone(s.x, 1); // y without springs
    MVT::MvInit(*smooth, 0.0);
    Terms::addForces(s.problem.blocks(), s.x, *smooth);
    MVT::MvAddMv(1.0, *s.y, -1.0, *smooth, *smooth);
    if (!at_.is_null() && !goDown(*smooth))
      return false;
    const double noise = 10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(s.x);
    if (update(noise) == 0 || ++steps_ > mostSteps)
      return false;
    at_ = MVT::CloneCopy(s.x);
    gradient_ = smooth;
    s.progress.forget();
    return true;
  }

  void exchange(StateArchive<MV>& archive) override {
    archive.number("pdas holds sides", areFrozen_);
    archive.number("pdas side steps", steps_);
    bool isThere = !at_.is_null();
    archive.number("pdas has sides", isThere);
    if (!isThere)
      return;
    if (at_.is_null()) {
      at_ = MVT::Clone(this->s_.x, 1);
      gradient_ = MVT::Clone(this->s_.x, 1);
    }
    archive.vector("pdas sides at", *at_);
    archive.vector("pdas sides gradient", *gradient_);
  }

 private:
  using typename Strategy<Scalar, MV, OP>::MVT;
  using Terms = BlockOps<Scalar, MV>;

  // To the sides where x is; how many have changed.
  long long update(double noise) {
    State& s = this->s_;
    return Terms::update(Terms::withForces(s.problem.blocks()), s.x, *s.y, {noise}, s.face).changed;
  }

  // Along the line from the point before to x. @return whether the cost falls.
  bool goDown(MV& smooth) {
    constexpr int mostHalvings = 60;
    MV& x = this->s_.x;
    const Teuchos::RCP<MV> d = MVT::Clone(x, 1), at = MVT::Clone(x, 1), forces = MVT::Clone(x, 1);
    MVT::MvAddMv(1.0, x, -1.0, *at_, *d);
    const double first = dot<Scalar>(*d, *gradient_), last = dot<Scalar>(*d, smooth);
    const auto slope = [&](double t) {
      MVT::MvAddMv(1.0, *at_, t, *d, *at);
      MVT::MvInit(*forces, 0.0);
      Terms::addForces(this->s_.problem.blocks(), *at, *forces);
      return (1.0 - t) * first + t * last + dot<Scalar>(*forces, *d);
    };
    if (!(slope(0.0) < 0.0))
      return false;
    if (!(slope(1.0) > 0.0))
      return true;
    double below = 0.0, above = 1.0;
    for (int k = 0; k < mostHalvings; ++k) {
      const double middle = 0.5 * (below + above);
      (slope(middle) > 0.0 ? above : below) = middle;
    }
    MVT::MvAddMv(1.0, *at_, below, *d, x);
    MVT::MvAddMv(1.0 - below, *gradient_, below, smooth, smooth);
    return true;
  }

  Teuchos::RCP<MV> at_, gradient_; // the point that sides are those of, and its gradient without springs
  bool areFrozen_ = false;
  int steps_ = 0;
};

} // namespace Harmos::qp
