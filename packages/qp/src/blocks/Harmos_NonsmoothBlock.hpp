// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveFace.hpp"

#include <memory>
#include <vector>

namespace Harmos::qp {

/// How a face is brought up to date.
struct FaceUpdate {
  double xNoise = 0.0;        ///< an entry that is beyond its end by less has not reached it
  double gradientNoise = 0.0; ///< multipliers of the wrong sign that are smaller are rounding errors
  double stepLength = 0.0;    ///< t: pairs are judged by z = x − tg
  double turn = 0.0;          ///< of the gradient, by which a slipping pair may be wrong and go on as it is
  bool keepsSprings = false;  ///< springs stay those of the face before; holding and freeing go on
};

/// How limits follow the solution.
struct FollowUpdate {
  double stepLength = 0.0; ///< t: they go where x − tg is
  double share = 1.0;      ///< s of the way
};

/// What an update of a face finds, beside the face: sums of one rank.
struct FaceTally {
  double violation2 = 0.0; ///< of free entries from where terms are finite, squared
  double wrong2 = 0.0;     ///< of multipliers that push the wrong way, squared
  double distance2 = 0.0;  ///< of held entries from where they are held now, squared
  double turned = 0.0;     ///< pairs that slip along another tangent, or have begun or ended to slip
};

/// Terms ψ of the cost that bend, or are infinite, where others are smooth:
///
///     min ½xᵀAx − bᵀx + Σψ_i(x_i)   subject to   Cx = c,
///
/// all terms of one kind that a rank has. ψ_i is convex, of one entry or a pair of entries that one rank has,
/// and no entry is in two blocks. Solvers ask for nothing but what is here: how ψ projects and pulls, and for
/// the face, which is a generalised derivative of its prox at z = x − tg (a semismooth Newton method: Qi,
/// Sun, Math. Program. 58, 1993; of prox and natural residual: Facchinei, Pang, Finite-Dimensional
/// Variational Inequalities, 2003, chapter 8): entries that are held, tangents, and curvatures (ActiveFace).
///
/// Arrays are those of one rank's entries: of the solution, and of its gradient Ax − b + Cᵀμ, in update()
/// with the springs of the face before, in project(x, g) with addForces(). All functions are local.
///
/// Guarded by tests/unit/qp/test_blocks.cpp; docs/qp.md shows how to write one.
class NonsmoothBlock {
 public:
  /// What solvers have to know of the terms.
  struct Kind {
    bool isSet = true;             ///< ψ is zero or infinite, of all of them
    bool isPiecewiseLinear = true; ///< its prox is; false: derivatives turn from point to point
    bool isCost = true;            ///< false: ψ depends on the solution, and there is no cost that falls
  };

  virtual ~NonsmoothBlock() = default;

  virtual Kind kind() const = 0;

  /// Sets to 1 the entries that the terms are about.
  virtual void mark(char* entries) const = 0;

  /// x ← the nearest point where the terms are finite.
  virtual void project(double* x) const = 0;

  /// y ← y + ∇ψ(x), of terms that are no sets.
  virtual void addForces(const double* /*x*/, double* /*y*/) const {}

  /// The face at x, where the gradient is g: sets the states of its entries, and appends to the slips and
  /// springs, which are those of the blocks before this one.
  /// @param before the face that x was found on. @param face in: with its states.
  virtual void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
                      ActiveFace& face, FaceTally& tally) const = 0;

  /// x ← where the face holds it.
  virtual void moveToFace(const ActiveFace& face, double* x) const = 0;

  /// g ← what is left of a gradient at x, within the terms' domain, that x − αg, α > 0, can follow: the
  /// projected gradient.
  virtual void project(const double* x, double* g) const = 0;

  /// d ← its part along which ψ does not grow for ever; returns the square of what was taken away. To take
  /// all of d away is safe: what leads to no end is then not found unbounded.
  virtual double recede(double* d) const = 0;

  // Of terms that depend on the solution.

  /// They become those of x − tg. @param g null: of x.
  virtual void follow(const double* /*x*/, const double* /*g*/, const FollowUpdate& /*how*/) {}
  /// Takes what they hold out of a face.
  virtual void release(ActiveFace& /*face*/) const {}
  /// Appends to the couplings of a face.
  virtual void couple(ActiveFace& /*face*/) const {}
  /// x ← where terms that have followed it hold it; without a face before.
  virtual void moveToLimits(const ActiveFace& /*face*/, double* /*x*/) const {}
  /// What they depend on as a number an entry, and back.
  virtual void putLimits(double* /*limits*/) const {}
  virtual void takeLimits(const double* /*limits*/) {}
};

/// The nonsmooth terms of a problem, of one rank.
using Blocks = std::vector<std::shared_ptr<NonsmoothBlock>>;

} // namespace Harmos::qp
