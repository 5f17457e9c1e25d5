// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BalancedFaces.hpp"
#include "Harmos_FaceDescent.hpp"
#include "Harmos_FrozenSides.hpp"
#include "Harmos_InteriorRestart.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// What makes the semismooth Newton method converge where it does not by itself: strategies in the order in
/// which they are tried. What pays, and for which scenes, is measured: docs/ablation.md.
template<class Scalar, class MV, class OP>
class Globalization {
 public:
  using State = NewtonState<Scalar, MV, OP>;

  /// @param isOver whether a limit of iterations or time is reached.
  Globalization(State& state, std::function<bool(const IterationState<MV>&)> isOver)
      : s_(state),
        balanced_(state),
        interior_(state, std::move(isOver), [this] { balanced_.beginAnew(); }),
        sides_(state),
        descent_(state, sides_),
        longer_(state, descent_),
        order_{&balanced_, &interior_, &longer_, &sides_, &descent_} {}

  Globalization(const Globalization&) = delete;
  Globalization& operator=(const Globalization&) = delete;

  /// The order of escalation. @return whether there is a way on; where there was no face, x is on one then.
  bool findWayOn(Trouble trouble, const std::string& why) {
    return std::any_of(order_.begin(), order_.end(), [&](Strategy<Scalar, MV, OP>* strategy) {
      return strategy->isAgainst(trouble) && strategy->propose(why) &&
             (trouble != Trouble::NoFace || enterFace());
    });
  }

  /// Begins on the present face, or on one that holds more. @return false if there is no such point.
  bool enterFace() { return balanced_.start(!descent_.isOn()) && descent_.enter(); }
  /// Whether a face that cannot be entered means that no step decreases the cost.
  bool isAtEnd() const { return descent_.isOn(); }

  /// Whether steps on the present face have gone too far to come back.
  bool isAstray() { return descent_.isAstray(); }

  bool keepsSprings() const { return sides_.areFrozen(); }
  void beforeUpdate() { descent_.keepCost(); }
  void afterUpdate() { balanced_.aim(); }

  /// x is the answer for what is frozen, y the true gradient. @return whether there is a point below, where x
  /// is then.
  bool moveFromAnswer() {
    if (!sides_.areFrozen() || !sides_.move())
      return false;
    descent_.end();
    return true;
  }

  /// Whether a limit of faces is of no account.
  bool seesToProgress() const {
    return std::any_of(order_.begin(), order_.end(), [](const auto* s) { return s->seesToProgress(); });
  }
  bool descends() const { return descent_.isOn(); }
  /// To the next face, of sets that descend. @return whether there is a feasible point.
  bool leaveFace(const ActiveFace& before) { return descent_.leave(before); }

  /// What is wrong with the last faces; empty: nothing.
  std::string troubleOfFaces() {
    const bool isBlownUp = balanced_.isBlownUp();
    const bool isLost = s_.progress.isLost(s_.expected, s_.options.patience) || isBlownUp;
    // Where limits follow a face may be the same again and again until these settle; the first that comes
    // back after another one goes in circles, for there is no cost that falls on the way.
    const bool isCircle =
        s_.problem.kind().isCost ? s_.progress.isCircle(s_.change) : s_.progress.isBack(s_.change);
    return isBlownUp  ? "unbalanced forces have grown"
           : isLost   ? std::to_string(s_.options.patience) + " active sets without progress"
           : isCircle ? "an active set recurred"
                      : "";
  }

  void exchange(StateArchive<MV>& archive) {
    for (auto* strategy : order_)
      strategy->exchange(archive);
  }

 private:
  State& s_;
  BalancedFaces<Scalar, MV, OP> balanced_;
  InteriorRestart<Scalar, MV, OP> interior_;
  FrozenSides<Scalar, MV, OP> sides_;
  FaceDescent<Scalar, MV, OP> descent_;
  LongerFaces<Scalar, MV, OP> longer_;
  std::vector<Strategy<Scalar, MV, OP>*> order_;
};

} // namespace Harmos::qp
