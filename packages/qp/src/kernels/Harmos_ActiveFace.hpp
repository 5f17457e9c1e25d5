// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace Harmos::qp {

/// A pair of entries that moves along the tangent of its disc's rim: y = x − c has nᵀy = r, and tᵀy is free,
/// t ⊥ n. What the rim bends away from its tangent is a curvature κ ≥ 0 of the cost, ½κ(tᵀy)².
struct Slip {
  int first, second; ///< local
  double centre[2];
  double radius;
  double normal[2]; ///< n
  double curvature; ///< κ
};

/// An entry with a curvature of its own: its cost is ½κ(x − c)² on this side of its interval.
struct Spring {
  int entry; ///< local
  int side;  ///< −1 below the interval, 1 above
  double centre;
  double curvature; ///< κ
};

/// An entry, or a pair, that is held at a limit which follows a free entry: it goes along, dx = f·dx_k e.
struct Coupling {
  int first, second; ///< second −1 for an interval
  double along[2];   ///< e: the sign of the side; the normal of the rim
  double centre[2];
  int source; ///< of x_k
  double factor;
};

/// The affine space and the quadratic that the nonsmooth terms of a problem are replaced by near a point, as
/// far as this rank has entries of it: which entries are held, along which tangents pairs move, which entries
/// have curvatures of their own, and which follow others. All of it is data, see FaceOps::exchange().
///
/// The state of an entry is 0 where it is free, −1 or 1 where it is held at the lower or upper end of its
/// interval, `onRim` where it is held in a disc, `slips` where it moves along a tangent.
struct ActiveFace : std::vector<signed char> {
  using std::vector<signed char>::vector;
  static constexpr signed char onRim = 2, slips = 3;
  std::vector<Slip> slipping;      ///< of each pair whose state is `slips`
  std::vector<Spring> springs;     ///< of no account at held entries; by rising entries
  std::vector<Coupling> couplings; ///< see NonsmoothBlock::couple()
};

/// The name of ActiveFace until version 0.2.
using LocalActiveSet = ActiveFace;

namespace Kernels {

/// v_i ← 0 where the entry is held; of slipping pairs the part along the tangents is left.
void maskHeld(const ActiveFace& face, double* v);

/// y ← y + f κt(tᵀx) of slipping pairs; with fromCentre x − c in the place of x.
void addCurvature(const std::vector<Slip>& slipping, double f, const double* x, bool fromCentre, double* y);

/// y ← y + fκx of springs; with fromCentre x − c in the place of x.
void addSprings(const std::vector<Spring>& springs, double f, const double* x, bool fromCentre, double* y);

/// v ← q/(q + κ)·v at springs, at least `least`·v.
void soften(const std::vector<Spring>& springs, double q, double least, double* v);

/// z ← z + κ/(q + κ)²·v at springs.
void addStiff(const std::vector<Spring>& springs, double q, const double* v, double* z);

/// x ← c + q/(q + κ)(x − c) at springs that were none before: where x would go if A were q.
void moveToSprings(const std::vector<Spring>& before, const std::vector<Spring>& springs, double q,
                   double* x);

/// y ← y + f x_k e at what follows.
void addFollowing(const std::vector<Coupling>& couplings, const double* x, double* y);

/// The spring of an entry, or null: entries rise from call to call.
class SpringOf {
 public:
  explicit SpringOf(const std::vector<Spring>& springs) : next_(springs.begin()), end_(springs.end()) {}
  const Spring* operator()(int entry) {
    while (next_ != end_ && next_->entry < entry)
      ++next_;
    return next_ != end_ && next_->entry == entry ? &*next_ : nullptr;
  }

 private:
  std::vector<Spring>::const_iterator next_, end_;
};

} // namespace Kernels
} // namespace Harmos::qp
