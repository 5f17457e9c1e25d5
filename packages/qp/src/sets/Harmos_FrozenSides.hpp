// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_FaceArchive.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_SpringOps.hpp"
#include "Harmos_VectorOps.hpp"

#include <limits>

namespace Harmos::qp {

/// On which sides of their soft bounds entries are: by where x is; or, where Newton's method goes in circles,
/// those of points from which the cost falls, until all else has settled (generalised Newton's method with
/// line search; Facchinei, SIAM J. Optim. 5, 1995).
///
/// Guarded by tests/unit/qp/test_soft_bounds.cpp.
template<class Scalar, class MV, class OP>
class FrozenSides {
 public:
  /// @param problem to outlive this.
  explicit FrozenSides(const Problem<Scalar, MV, OP>& problem) : problem_(problem) {
    if (!problem.hasSoftBounds())
      return;
    random_ = MVT::Clone(*problem.solution(), 1);
    BoundOps<Scalar, MV>::setRandom(*random_);
  }

  bool areFrozen() const { return areFrozen_; }

  /// Springs of a set by where x is.
  SpringChange update(const MV& x, double noise, LocalActiveSet& set) const {
    return Springs::update(x, *problem_.softBounds(), noise, *random_, set);
  }

  /// From x on, sides stay.
  void freeze(const MV& x, LocalActiveSet& set) {
    areFrozen_ = true;
    at_ = Teuchos::null;
    update(x, 0.0, set);
  }

  /// x is the answer for these sides, y the true gradient. With the quadratic that has the gradient of the
  /// cost at the point before, what leads from there to its least point leads downwards; along that line the
  /// slope of the cost rises, and is known from both ends.
  /// @return whether there is another set of sides, at a point below, where x is then.
  bool move(MV& x, const MV& y, LocalActiveSet& set) {
    constexpr int mostSteps = 1000;
    const Teuchos::RCP<MV> smooth = MVT::Clone(x, 1); // y without springs
    MVT::MvInit(*smooth, 0.0);
    Springs::addForces(problem_.softBounds(), x, *smooth);
    MVT::MvAddMv(1.0, y, -1.0, *smooth, *smooth);
    if (!at_.is_null() && !goDown(x, *smooth))
      return false;
    const double noise = 10.0 * std::numeric_limits<double>::epsilon() * norm<Scalar>(x);
    if (update(x, noise, set).changed == 0 || ++steps_ > mostSteps)
      return false;
    at_ = MVT::CloneCopy(x);
    gradient_ = smooth;
    return true;
  }

  void exchange(StateArchive<MV>& archive) {
    archive.number("pdas holds sides", areFrozen_);
    archive.number("pdas side steps", steps_);
    bool isThere = !at_.is_null();
    archive.number("pdas has sides", isThere);
    if (!isThere)
      return;
    if (at_.is_null()) {
      at_ = MVT::Clone(*random_, 1);
      gradient_ = MVT::Clone(*random_, 1);
    }
    archive.vector("pdas sides at", *at_);
    archive.vector("pdas sides gradient", *gradient_);
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Springs = SpringOps<Scalar, MV>;

  // Along the line from the point before to x. @return whether the cost falls.
  bool goDown(MV& x, MV& smooth) const {
    constexpr int mostHalvings = 60;
    const Teuchos::RCP<MV> d = MVT::Clone(x, 1), at = MVT::Clone(x, 1);
    MVT::MvAddMv(1.0, x, -1.0, *at_, *d);
    const double first = dot<Scalar>(*d, *gradient_), last = dot<Scalar>(*d, smooth);
    const auto slope = [&](double t) {
      MVT::MvAddMv(1.0, *at_, t, *d, *at);
      return (1.0 - t) * first + t * last + Springs::power(*problem_.softBounds(), *at, *d);
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

  const Problem<Scalar, MV, OP>& problem_;
  Teuchos::RCP<MV> random_;        // a number an entry
  Teuchos::RCP<MV> at_, gradient_; // the point that sides are those of, and its gradient without springs
  bool areFrozen_ = false;
  int steps_ = 0;
};

} // namespace Harmos::qp
