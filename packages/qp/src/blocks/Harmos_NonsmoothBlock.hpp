// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveFace.hpp"
#include "Harmos_MixedBits.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// How a face is brought up to date.
struct FaceUpdate {
  double xNoise = 0.0;        ///< an entry that is beyond its end by less has not reached it
  double gradientNoise = 0.0; ///< multipliers of the wrong sign that are smaller are rounding errors
  double stepLength = 0.0;    ///< t: pairs are judged by z = x − tg
  double turn = 0.0;          ///< of the gradient, by which a slipping pair may be wrong and go on as it is
  bool keepsSprings = false;
};

/// How limits follow the solution.
struct FollowUpdate {
  double stepLength = 0.0; ///< t: they go where x − tg is
  double share = 1.0;      ///< s of the way
};

/// What an update of a face finds and changes: sums of one rank.
class FaceTally {
 public:
  /// @param globalIndex the number of a local entry, whatever the distribution.
  explicit FaceTally(std::function<long long(std::size_t)> globalIndex)
      : globalIndex_(std::move(globalIndex)) {}

  double active = 0.0;       ///< held entries
  double changed = 0.0;      ///< entries, or pairs, whose part of the face is another
  double violation2 = 0.0;   ///< of free entries from where terms are finite, squared
  double wrong2 = 0.0;       ///< of multipliers that push the wrong way, squared
  double wrongForces2 = 0.0; ///< of ∇ψ(x) from what the springs of the face before make of it, squared
  double distance2 = 0.0;    ///< of held entries from where they are held now, squared
  double signature[2] = {0.0, 0.0};

  /// An entry's part of the face: the same face has the same signature, another one with all but certainty
  /// another.
  void sign(std::size_t entry, unsigned state) {
    sign(mix(2 * static_cast<std::uint64_t>(globalIndex_(entry)) + state));
  }
  /// What distinguishes faces beside states.
  void sign(std::size_t entry, std::uint64_t first, std::uint64_t second) {
    const std::uint64_t bits = mix(2 * static_cast<std::uint64_t>(globalIndex_(entry)) + 1 + first);
    add(bits, mix(bits + second));
  }

 private:
  void sign(std::uint64_t bits) { add(bits, bits); }
  // 32 bits an entry, so that sums over two million entries are exact.
  void add(std::uint64_t first, std::uint64_t second) {
    signature[0] += static_cast<double>(first >> 32);
    signature[1] += static_cast<double>(second & 0xffffffffULL);
  }

  std::function<long long(std::size_t)> globalIndex_;
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
/// Arrays are those of one rank's entries of the solution, of its gradient Ax − b + Cᵀμ, springs of the face
/// included. All functions are local.
///
/// Guarded by tests/unit/qp/test_blocks.cpp; docs/qp.md shows how to write one.
class NonsmoothBlock {
 public:
  /// What solvers have to know of the terms.
  struct Kind {
    bool isSet = true;             ///< ψ is zero or infinite
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

  /// The face at x, where the gradient is g, and how it differs from the one before. Sets states of its
  /// entries, and appends to the slips and springs, which are those of the blocks before this one.
  /// @param before the face that x was found on; empty: none.
  virtual void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
                      ActiveFace& face, FaceTally& tally) const = 0;

  /// x ← where the face holds it.
  virtual void moveToFace(const ActiveFace& face, double* x) const = 0;

  /// g ← what is left of a gradient at x, within the terms' domain, that x − αg, α > 0, can follow: the
  /// projected gradient.
  virtual void project(const double* x, double* g) const = 0;

  /// d ← its projection onto the directions along which ψ does not grow for ever; returns the square of what
  /// was taken away. Less than these is safe: no direction, unless a block knows better.
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
