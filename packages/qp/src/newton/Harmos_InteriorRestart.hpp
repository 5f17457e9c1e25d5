// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_InteriorPath.hpp"
#include "Harmos_Strategy.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace Harmos::qp {

/// Where limits follow, or pairs turn: to the face of the end of a path through interior points
/// (InteriorPath); the second one goes further.
///
/// Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class InteriorRestart : public Strategy<Scalar, MV, OP> {
 public:
  using typename Strategy<Scalar, MV, OP>::State;

  using IsOver = std::function<bool(const IterationState<MV>&)>;

  /// @param isOver whether a limit of iterations or time is reached. @param moved is told when it has led
  /// elsewhere.
  InteriorRestart(State& state, IsOver isOver, std::function<void()> moved)
      : Strategy<Scalar, MV, OP>(state), isOver_(std::move(isOver)), moved_(std::move(moved)) {}

  bool isAgainst(Trouble trouble) const override { return trouble != Trouble::ManyFaces; }

  bool propose(const std::string& why) override {
    constexpr int mostPaths = 2;
    State& s = this->s_;
    const double q = s.solver.stiffness();
    const int most = s.options.mostIterations - s.now.inner;
    if (!s.turns() || paths_ >= mostPaths || !(q > 0.0) || most <= 0)
      return false;
    ++paths_;
    this->log(why + "; restart from an interior point");
    ActiveFace springs;
    springs.springs = s.face.springs;
    InteriorPath<Scalar, MV, OP> path(s.problem, s.rows, s.options.cg, s.solver.kept(), s.options.mostKept,
                                      s.counters, springs);
    const bool isThrough = path.run(*s.best.x, q, paths_ == 1 ? 1e-8 : 1e-11, most, [&] {
      IterationState<MV> now = s.now;
      now.inner += path.steps();
      return isOver_(now);
    });
    if (!std::isfinite(norm<Scalar>(path.x()) + norm<Scalar>(path.y())))
      return false;
    MVT::Assign(path.x(), s.x);
    s.problem.follow();
    findFaceBeside(path.x(), path.y(), q);
    s.solver.knowSprings(s.face);
    s.now.inner += path.steps();
    // Its share is that of faces: what would take over where limits follow has no better way.
    s.options.budget = std::min(s.options.budget + path.steps(), s.options.mostIterations);
    s.progress = {};
    moved_();
    this->log(std::to_string(path.steps()) + " steps, " + (isThrough ? "path complete" : "path incomplete") +
              "; its active set is next");
    return true;
  }

  void exchange(StateArchive<MV>& archive) override { archive.number("pdas paths", paths_); }

 private:
  using typename Strategy<Scalar, MV, OP>::MVT;

  // That of x − y/q: what is outside is held.
  void findFaceBeside(const MV& x, const MV& y, double q) {
    constexpr double touching = 1e-9;
    State& s = this->s_;
    const Teuchos::RCP<MV> v = MVT::Clone(x, 1), inside = MVT::Clone(x, 1), gradient = MVT::Clone(x, 1);
    MVT::MvAddMv(1.0, x, -1.0 / q, y, *v);
    s.face.assign(s.face.size(), 0);
    s.face.slipping.clear();
    const double noise = touching * norm<Scalar>(x);
    const FeasibleSet<MV> feasible = s.problem.feasibleSet();
    for (int pass = 0; pass < 2; ++pass) { // the second for what was at its other bound
      MVT::Assign(*v, *inside);
      BlockOps<Scalar, MV>::moveToFace(feasible, s.face, *inside);
      MVT::MvAddMv(q, *inside, -q, *v, *gradient);
      s.active =
          BlockOps<Scalar, MV>::update(feasible, *inside, *gradient, {noise, q * noise, 1.0 / q}, s.face)
              .active;
    }
  }

  IsOver isOver_;
  std::function<void()> moved_;
  int paths_ = 0; // that were followed
};

} // namespace Harmos::qp
