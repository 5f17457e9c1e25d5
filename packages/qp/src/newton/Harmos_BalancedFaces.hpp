// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BalancedActiveSet.hpp"
#include "Harmos_Strategy.hpp"

#include <algorithm>

namespace Harmos::qp {

/// Where limits follow, or pairs turn: from the best iterate on, all faces are balanced (BalancedActiveSet)
/// with springs that get stiffer, and steps shorter with them, which leads out of circles. As stiff as A they
/// have no say any more. Where limits follow, springs as soft as the solution lead back into the circle:
/// faces that nothing holds were balanced with these before.
///
/// Guarded by tests/unit/qp/test_following_limits.cpp and test_discs.cpp.
template<class Scalar, class MV, class OP>
class BalancedFaces : public Strategy<Scalar, MV, OP> {
 public:
  using typename Strategy<Scalar, MV, OP>::State;

  explicit BalancedFaces(State& state) : Strategy<Scalar, MV, OP>(state), next_(state.problem, state.rows) {}

  bool isAgainst(Trouble trouble) const override { return trouble == Trouble::NoProgress; }

  bool propose(const std::string& why) override {
    constexpr double factor = 10.0, stiffAtFirst = 100.0;
    State& s = this->s_;
    const double stiffest = isAfterPath_
                                ? std::max(stiffAtFirst, s.solver.curvatureBound() / s.solver.stiffness())
                                : stiffAtFirst;
    if (!mayBalance() || stiffening_ >= stiffest)
      return false;
    stiffening_ *= isOn_ || !s.problem.kind().isCost ? factor : 1.0;
    isOn_ = true;
    if (s.best.isFound) {
      MVT::Assign(*s.best.x, s.x);
      s.face = s.best.face;
      next_.aim(s.x, *s.best.gradient, stiffening_ * s.solver.stiffness());
    }
    s.progress.forget();
    this->log(why + "; balanced active sets with springs " + scientific(stiffening_, 1) + " times as stiff");
    return true;
  }

  /// Onto the face. Where all that holds a body is at its limit, these forces need not balance, and where
  /// what is left holds it hardly, as the facets of a round body do, it is no better: another face does.
  /// @param mayChange whether another face is allowed.
  bool start(bool mayChange) {
    constexpr double hardly = 1e-4; // of all forces that there are; a few points that touch have some 1e-3
    State& s = this->s_;
    const bool isFit = next_.isFit() && mayChange;
    if (!(isOn_ && isFit) && s.solver.start(s.face, isFit ? hardly : 0.0))
      return true;
    if (!isFit)
      return false;
    if (!next_.isAimed()) // the first face is none that can hold bodies
      next_.aim(s.x, *s.y, s.solver.stiffness());
    return (next_.find(s.face, s.active) && s.solver.start(s.face)) || s.solver.start(s.face);
  }

  /// After each update of the face.
  void aim() {
    if (next_.isFit())
      next_.aim(this->s_.x, *this->s_.y, stiffening_ * this->s_.solver.stiffness());
  }

  /// Whether motions of bodies that hardly anything holds have grown: they do so with each face.
  bool isBlownUp() const {
    constexpr double blownUp = 1e3;
    return mayBalance() && !isOn_ && this->s_.expected > blownUp * this->s_.progress.least();
  }

  /// From another point.
  void beginAnew() {
    isOn_ = false;
    isAfterPath_ = true;
    stiffening_ = 1.0;
  }

  void exchange(StateArchive<MV>& archive) override {
    archive.number("pdas balances", isOn_);
    archive.number("pdas balances after path", isAfterPath_);
    archive.number("pdas stiffening", stiffening_);
  }

 private:
  using typename Strategy<Scalar, MV, OP>::MVT;

  bool mayBalance() const { return next_.isFit() && this->s_.turns(); }

  BalancedActiveSet<Scalar, MV, OP> next_;
  double stiffening_ = 1.0; // of the springs of next_
  bool isOn_ = false, isAfterPath_ = false;
};

} // namespace Harmos::qp
