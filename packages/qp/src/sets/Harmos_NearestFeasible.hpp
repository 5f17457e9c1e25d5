// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_VectorOps.hpp"

#include <cmath>
#include <limits>

namespace Harmos::qp {

/// The feasible point next to a given one,
///
///     min ½‖x − z‖²   subject to   C̄x = c̄ and the bounds,   C̄C̄ᵀ = I.
///
/// x = Π(v), v = z − C̄ᵀν, Π onto the bounds, where ν minimises the convex φ(ν) = ½‖v‖² − ½‖v − Π(v)‖² + c̄ᵀν,
/// ∇φ = c̄ − C̄Π(v). Newton's method on its pieces: each is an active set, where x_F = v_F, and a step costs a
/// factorisation of C_FC_Fᵀ. Where that is singular, what it leaves of −∇φ is added to Newton's direction;
/// where φ does not fall, steps are halved, and one along −∇φ comes last: of length 1 it always falls there,
/// ‖C̄‖ = 1. No product with A.
///
/// Guarded by tests/unit/qp/newton/test_first_active_set.cpp and
/// tests/unit/qp/newton/test_descent_of_sets.cpp.
template<class Scalar, class MV, class OP>
class NearestFeasible {
 public:
  enum class Outcome {
    Found,
    Unsettled, ///< too few steps: x() meets the equalities, but not all bounds
    None       ///< the equalities cannot be met on the set to begin with
  };

  /// Discs are left out, but in findSmoothly(): Π is piecewise linear. @param rows orthonormal, or none. Both
  /// to outlive this.
  NearestFeasible(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows)
      : feasible_{problem.lowerBound().get(), problem.upperBound().get(), nullptr},
        discs_(problem.feasibleSet().discs),
        others_(othersOf(problem)),
        rows_(rows),
        x_(MVT::Clone(*problem.rhs(), 1)),
        v_(MVT::Clone(*x_, 1)),
        work_(MVT::Clone(*x_, 1)) {
    gatherBlocks();
    if (rows_.isPresent()) {
      residual_ = rows_.makeVector();
      direction_ = rows_.makeVector();
      values_ = Teuchos::rcpFromRef(rows_.values());
    }
  }

  /// @param set in: where to begin; out: the set of x(), or what it was if there is none. @param active
  /// receives how many entries of it are active.
  /// @note Collective.
  Outcome find(const MV& z, int mostSets, ActiveFace& set, long long& active) {
    noise_ = touching * norm<Scalar>(z);
    MVT::Assign(z, *v_);
    height_ = 0.0;
    return settle(mostSets, false, set, active);
  }

  /// The same from no set, where find() crawls: where all forces of a body are at their bounds, C_FC_Fᵀ knows
  /// nothing of its motions, and of many such bodies each changes the entries of one at a time. Bounds are
  /// smoothed first (Chen, Mangasarian, Comput. Optim. Appl. 5, 1996), C̄DC̄ᵀ regular then, and all bodies move
  /// at once; the width falls until find()'s steps get on from there.
  /// @note Collective; a factorisation for each of some ten to thirty steps.
  /// @param stiffness with discs: q, to make curvatures of. The set is that of the smoothed point then.
  Outcome findSmoothly(const MV& z, ActiveFace& set, long long& active, double stiffness = 1.0) {
    constexpr double reduction = 0.3, widest = 3.0, finest = 1e-7;
    constexpr int mostSteps = 12, mostSets = 3;
    if (!rows_.isPresent())
      return find(z, mostSets, set, active);
    const Teuchos::RCP<MV> slope = MVT::Clone(z, 1), v = MVT::CloneCopy(z);
    const double size = norm<Scalar>(z) / std::sqrt(static_cast<double>(MVT::GetGlobalLength(z)));
    double height = 0.0;
    for (double width = widest; width > finest; width *= reduction) {
      if (!smoothe(*v, height, width * size, mostSteps, *slope))
        return Outcome::None;
      if (width > 3e-3 || discs_ != nullptr)
        continue;
      noise_ = touching * norm<Scalar>(z);
      MVT::Assign(*v, *v_);
      height_ = height;
      const Outcome outcome = settle(mostSets, true, set, active);
      if (outcome == Outcome::Found)
        return outcome;
    }
    if (discs_ == nullptr)
      return Outcome::Unsettled;
    // What is outside by more than the last width.
    MVT::Assign(*v, *v_);
    const FeasibleSet<MV> whole = {feasible_.lower, feasible_.upper, discs_};
    for (int pass = 0; pass < 2; ++pass) { // the second for what was at its other bound
      moveToFace(set);
      MVT::MvAddMv(stiffness, *x_, -stiffness, *v_, *work_);
      active =
          Terms::update(whole, *x_, *work_, {finest * size, stiffness * finest * size, 1.0 / stiffness}, set)
              .active;
    }
    return Outcome::Found;
  }

  const MV& x() const { return *x_; }

  /// Equalities that are a bit off from here on: forces at their bounds do not balance by chance then, and a
  /// body that they hold alone turns until something else holds it.
  void unbalance(double size) {
    const Teuchos::RCP<MV> shifted = rows_.makeVector();
    rows_.setRandom(*shifted);
    MVT::MvAddMv(size / norm<Scalar>(*shifted), *shifted, 1.0, rows_.values(), *shifted);
    values_ = shifted;
  }

  /// Other bounds from here on; to outlive this.
  void setBounds(const MV* lower, const MV* upper, const LocalDiscs* discs) {
    feasible_.lower = lower;
    feasible_.upper = upper;
    discs_ = discs;
    gatherBlocks();
  }

  /// Adds pairs of v that are outside of their discs to the set that was found. @param stepLength 1/‖A‖, to
  /// make curvatures of. @return how many entries of it are active. @note Collective.
  long long addSlips(const FeasibleSet<MV>& feasible, double stepLength, ActiveFace& set) {
    moveToFace(set);
    MVT::MvAddMv(1.0, *x_, -1.0, *v_, *work_);
    return Terms::update(feasible, *x_, *work_, {touching * norm<Scalar>(*x_), noise_, stepLength}, set)
        .active;
  }

  /// How many entries of a set are active. @note Collective.
  long long count(const ActiveFace& set) {
    constexpr double unmoved = std::numeric_limits<double>::max();
    ActiveFace copy = set;
    return update(*v_, *v_, unmoved, unmoved, copy).active;
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Terms = BlockOps<Scalar, MV>;
  using Faces = FaceOps<Scalar, MV>;

  // What is neither bound nor disc, and where it can be; springs stay what they are.
  static Blocks othersOf(const Problem<Scalar, MV, OP>& problem) {
    const std::size_t sets = Terms::setsOf(problem.feasibleSet()).size();
    Blocks result;
    for (std::size_t k = sets; k < problem.blocks().size(); ++k)
      if (problem.blocks()[k]->kind().isCost)
        result.push_back(problem.blocks()[k]);
    return result;
  }
  void gatherBlocks() {
    blocks_ = Terms::setsOf(feasible_);
    blocks_.insert(blocks_.end(), others_.begin(), others_.end());
  }
  FaceChange update(const MV& x, const MV& g, double xNoise, double gradientNoise, ActiveFace& set) const {
    return Terms::update(blocks_, x, g, {xNoise, gradientNoise, 0.0, 0.0, true}, set);
  }

  // Newton's steps from v on. @param fromV the first set is that of v.
  Outcome settle(int mostSets, bool fromV, ActiveFace& set, long long& active) {
    Outcome outcome = Outcome::None;
    ActiveFace next = set;
    if (fromV) {
      updateSet(next);
      updateSet(next); // what was at its other bound
    }
    for (int k = 0; k < mostSets; ++k) {
      const bool isMet = k == 0 ? begin(next) : descend(next);
      if (isMet) {
        outcome = Outcome::Unsettled;
        set = next;
      }
      if (updateSet(next) == 0 && isMet) {
        outcome = Outcome::Found;
        break;
      }
    }
    active = count(set);
    if (outcome == Outcome::Found) {
      moveToFace(set);
      Terms::project(blocks_, *x_);
    }
    return outcome;
  }

  // Newton's method for C̄Π_w(v) = c̄, v = z − C̄ᵀν; the residual falls.
  bool smoothe(MV& v, double& height, double width, int mostSteps, MV& slope) {
    constexpr double enough = 0.1, least = 1e-3;
    const Teuchos::RCP<MV> trial = MVT::Clone(v, 1);
    const FeasibleSet<MV> whole = {feasible_.lower, feasible_.upper, discs_};
    std::vector<Slip> rims;
    const auto residualAt = [&](const MV& at, MV& weights) {
      Bounds::projectSmoothly(at, whole, width, *x_, weights, rims);
      findResidual();
      return norm<Scalar>(*residual_);
    };
    double residual = residualAt(v, slope);
    for (int k = 0; k < mostSteps && residual > enough * width; ++k) {
      const Teuchos::RCP<const FaceGram<MV>> gram = rows_.weightedGram(slope, rims);
      MVT::Assign(*residual_, *direction_);
      gram->solve(*direction_);
      double length = 1.0, next = 0.0;
      for (; length > least; length *= 0.5) {
        MVT::Assign(v, *trial);
        rows_.addTransposed(-length, *direction_, *trial);
        next = residualAt(*trial, slope);
        if (next < (1.0 - 0.1 * length) * residual)
          break;
      }
      if (!(next < residual) || length <= least)
        return false;
      MVT::Assign(*trial, v);
      height += length * dot<Scalar>(*values_, *direction_);
      residual = next;
    }
    return residual <= width;
  }

  // What only touches stays as it was, whatever the rounding errors of sums over other numbers of ranks.
  static constexpr double touching = 1e-9;
  static constexpr double rounding = 1e-12;  // of φ
  static constexpr double sufficient = 1e-4; // part of what its slope promises

  // x = v where the set is free, else the bounds.
  void moveToFace(const ActiveFace& active) {
    MVT::Assign(*v_, *x_);
    Terms::moveToFace(blocks_, active, *x_);
  }

  void subtractRows(double factor, const MV& nu) {
    rows_.addTransposed(-factor, nu, *v_);
    height_ += factor * dot<Scalar>(*values_, nu);
  }

  // From a set that need not be that of Π(v): Newton's step alone, where it leads to the equalities.
  bool begin(const ActiveFace& active) {
    moveToFace(active);
    if (!rows_.isPresent())
      return true;
    const Teuchos::RCP<MV> before = MVT::CloneCopy(*v_);
    findDirection(active);
    subtractRows(1.0, *direction_);
    if (meetsRows(active))
      return true;
    MVT::Assign(*before, *v_);
    height_ = 0.0;
    return false;
  }

  // A step that makes φ smaller; whether x on the face meets the equalities then.
  bool descend(const ActiveFace& active) {
    moveToFace(active);
    if (!rows_.isPresent())
      return true;
    const Teuchos::RCP<MV> before = MVT::CloneCopy(*v_);
    const double height = height_, last = value();
    Terms::project(blocks_, *x_);
    findResidual();
    const Teuchos::RCP<MV> downwards = rows_.makeVector();
    MVT::Assign(*residual_, *downwards);
    moveToFace(active);
    findDirection(active);
    const double slope = dot<Scalar>(*downwards, *direction_);
    const auto valueAt = [&](const MV& direction, double length) {
      MVT::Assign(*before, *v_);
      height_ = height;
      subtractRows(length, direction);
      return value();
    };
    // On nearly singular faces Newton's direction is longer than anything that is allowed.
    constexpr int mostHalvings = 30, mostDoublings = 60;
    double length = 1.0;
    bool falls = false;
    for (int k = 0; k <= mostHalvings && !falls; ++k) {
      falls = valueAt(*direction_, length) <= last - sufficient * length * slope + rounding * std::abs(last);
      if (!falls)
        length *= 0.5;
    }
    if (falls && meetsRows(active))
      return true;
    // On a singular face φ falls at a constant rate until entries change their state.
    const MV& direction = falls ? *direction_ : *downwards;
    if (!falls)
      length = 1.0;
    double reached = valueAt(direction, length);
    for (int k = 0; k < mostDoublings; ++k, length *= 2.0) {
      const double further = valueAt(direction, 2.0 * length);
      if (!(further < reached))
        break;
      reached = further;
    }
    valueAt(direction, length);
    return false;
  }

  // Newton's, from x on the face; a second time for what rounding left, and for what a singular face leaves.
  void findDirection(const ActiveFace& active) {
    const Teuchos::RCP<const FaceGram<MV>> gram = rows_.faceGram(active);
    findResidual();
    MVT::Assign(*residual_, *direction_);
    gram->solve(*direction_);
    const Teuchos::RCP<MV> image = MVT::Clone(*x_, 1), rest = rows_.makeVector();
    MVT::MvInit(*image, 0.0);
    rows_.addTransposed(1.0, *direction_, *image);
    Faces::mask(*image, active);
    rows_.apply(*image, *rest);
    MVT::MvAddMv(1.0, *residual_, -1.0, *rest, *rest);
    MVT::Assign(*rest, *residual_);
    gram->solve(*residual_);
    MVT::MvAddMv(1.0, *direction_, 1.0, *residual_, *direction_);
    MVT::MvAddMv(1.0, *direction_, 1.0, *rest, *direction_);
  }

  // A face that misses the equalities does so by more than rounding errors.
  bool meetsRows(const ActiveFace& active) {
    moveToFace(active);
    findResidual();
    const double scale = norm<Scalar>(*x_) + norm<Scalar>(*values_);
    return norm<Scalar>(*residual_) <= std::sqrt(std::numeric_limits<double>::epsilon()) * scale;
  }

  // C̄x − c̄.
  void findResidual() {
    rows_.apply(*x_, *residual_);
    MVT::MvAddMv(1.0, *residual_, -1.0, *values_, *residual_);
  }

  // φ.
  double value() {
    MVT::Assign(*v_, *work_);
    Terms::project(blocks_, *work_);
    MVT::MvAddMv(1.0, *v_, -1.0, *work_, *work_);
    return 0.5 * (dot<Scalar>(*v_, *v_) - dot<Scalar>(*work_, *work_)) + height_;
  }

  // To the entries that Π moves; how many have changed.
  long long updateSet(ActiveFace& set) {
    moveToFace(set);
    MVT::MvAddMv(1.0, *x_, -1.0, *v_, *work_);
    return update(*x_, *work_, touching * norm<Scalar>(*x_), noise_, set).changed;
  }

  FeasibleSet<MV> feasible_; // without discs
  const LocalDiscs* discs_;
  Blocks others_, blocks_; // beside bounds; bounds and these
  const EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> x_, v_, work_;
  Teuchos::RCP<MV> residual_, direction_; // of the rows
  Teuchos::RCP<const MV> values_;         // c̄
  double height_ = 0.0;                   // c̄ᵀν
  double noise_ = 0.0;
};

} // namespace Harmos::qp
