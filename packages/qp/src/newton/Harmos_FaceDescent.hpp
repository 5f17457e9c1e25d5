// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DescentOfSets.hpp"
#include "Harmos_FrozenSides.hpp"
#include "Harmos_Strategy.hpp"

namespace Harmos::qp {

/// From the best iterate on, faces descend (DescentOfSets): then the method converges from everywhere.
template<class Scalar, class MV, class OP>
class FaceDescent : public Strategy<Scalar, MV, OP> {
 public:
  using typename Strategy<Scalar, MV, OP>::State;

  /// @param sides forces of terms are to be quadratic.
  FaceDescent(State& state, const FrozenSides<Scalar, MV, OP>& sides)
      : Strategy<Scalar, MV, OP>(state), sides_(sides), descent_(state.problem, state.rows, state.solver) {}

  bool isAgainst(Trouble trouble) const override {
    return trouble == Trouble::NoFace || trouble == Trouble::NoProgress;
  }
  bool isOn() const { return descent_.isOn(); }
  bool seesToProgress() const override { return descent_.isOn(); }

  bool propose(const std::string& why) override {
    State& s = this->s_;
    if (descent_.isOn() || s.turns() || (!s.problem.kind().isSet && !sides_.areFrozen()))
      return false;
    const Teuchos::RCP<MV> present = MVT::CloneCopy(s.x);
    MVT::Assign(*s.best.x, s.x);
    if (!descent_.begin(s.face, s.active)) {
      MVT::Assign(*present, s.x);
      return false;
    }
    ++s.counters.descents;
    this->log(why + "; descent of sets from the best iterate");
    return true;
  }

  /// The cost is another one.
  void end() { descent_.end(); }
  /// See DescentOfSets.
  bool enter() { return descent_.enter(this->s_.face, this->s_.active); }
  bool isAstray() { return descent_.isAstray(this->s_.face); }
  /// Before the face is brought up to date.
  void keepCost() {
    if (descent_.isOn())
      cost_ = this->s_.solver.cost();
  }
  /// @param before the face that x was found on.
  bool leave(const ActiveFace& before) {
    State& s = this->s_;
    return descent_.leave(cost_, s.change.violation2 == 0.0, before, s.face, s.active);
  }

  void exchange(StateArchive<MV>& archive) override { descent_.exchange(archive); }

 private:
  using typename Strategy<Scalar, MV, OP>::MVT;

  const FrozenSides<Scalar, MV, OP>& sides_;
  DescentOfSets<Scalar, MV, OP> descent_;
  double cost_ = 0.0; // of what the last face has led to
};

/// Faces that are made of iterates far from the solutions on their faces may wander where A is badly
/// conditioned, as in the bending of slender bodies: faces are followed further.
template<class Scalar, class MV, class OP>
class LongerFaces : public Strategy<Scalar, MV, OP> {
 public:
  using typename Strategy<Scalar, MV, OP>::State;

  LongerFaces(State& state, const FaceDescent<Scalar, MV, OP>& descent)
      : Strategy<Scalar, MV, OP>(state), descent_(descent) {}

  bool isAgainst(Trouble trouble) const override { return trouble == Trouble::NoProgress; }

  bool propose(const std::string& why) override {
    constexpr double carefulReduction = 0.05, part = 0.2; // 0.5, 0.1, 0.02
    State& s = this->s_;
    if (descent_.isOn() || s.options.innerReduction < carefulReduction)
      return false;
    s.options.innerReduction *= part;
    s.progress.forget();
    this->log(why + "; smaller inner residuals on faces");
    return true;
  }

 private:
  const FaceDescent<Scalar, MV, OP>& descent_;
};

} // namespace Harmos::qp
