// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_BoundTypes.hpp"

#include <cmath>
#include <functional>

namespace Harmos::qp {

/// What a face means for vectors: T and κ of the linear problem on it. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_blocks.cpp and test_discs.cpp.
template<class Scalar, class MV>
struct FaceOps {
  using BT = BoundTraits<Scalar, MV>;

  /// v_i ← 0 where the entry is held; slipping pairs keep their part along the tangent. Local.
  static void mask(MV& v, const ActiveFace& face) { Kernels::maskHeld(face, BT::write(v)); }

  /// y ← y + f κt(tᵀx) of slipping pairs; with fromCentre x − c in the place of x. Local.
  static void addCurvature(const ActiveFace& face, double f, const MV& x, bool fromCentre, MV& y) {
    if (!face.slipping.empty())
      Kernels::addCurvature(face.slipping, f, BT::read(x), fromCentre, BT::write(y));
  }

  /// y ← y + fκx of springs; with fromCentre x − c in the place of x. Local.
  static void addSprings(const ActiveFace& face, double f, const MV& x, bool fromCentre, MV& y) {
    if (!face.springs.empty())
      Kernels::addSprings(face.springs, f, BT::read(x), fromCentre, BT::write(y));
  }

  /// y ← y + f(κ) x at the entries of slipping pairs. Local.
  static void addAtSlips(const ActiveFace& face, const std::function<double(double)>& f, const MV& x, MV& y) {
    const double* const xs = BT::read(x);
    double* const ys = BT::write(y);
    for (const Slip& slip : face.slipping)
      for (int entry : {slip.first, slip.second})
        ys[entry] += f(slip.curvature) * xs[entry];
  }

  /// v ← Tv, T = q/(q + κ) at springs. Local.
  static void soften(const ActiveFace& face, double q, MV& v) { weigh(face, q, 0.0, v); }
  /// The same where equalities are met again by it: a part that is lost in rounding errors beside those of
  /// others would be none.
  static void share(const ActiveFace& face, double q, MV& v) {
    constexpr double least = 1e-9;
    weigh(face, q, least, v);
  }
  /// z ← z + (I − T)Tq⁻¹v at springs. Local.
  static void addStiff(const ActiveFace& face, double q, const MV& v, MV& z) {
    if (!face.springs.empty())
      Kernels::addStiff(face.springs, q, BT::read(v), BT::write(z));
  }

  /// See Kernels::moveToSprings(). Local.
  static void moveToSprings(const ActiveFace& before, const ActiveFace& face, double q, MV& x) {
    if (!face.springs.empty())
      Kernels::moveToSprings(before.springs, face.springs, q, BT::write(x));
  }

  /// y ← y + what follows x. Local.
  static void addFollowing(const ActiveFace& face, const MV& x, MV& y) {
    Kernels::addFollowing(face.couplings, BT::read(x), BT::write(y));
  }

  /// Σcf over springs, f a vector.
  static double atCentres(const ActiveFace& face, const MV& f) {
    const double* const values = BT::read(f);
    double sum = 0.0;
    for (const Spring& spring : face.springs)
      sum += spring.centre * values[spring.entry];
    BT::sum(f, &sum, 1);
    return sum;
  }

  /// @param w along the tangents of slipping pairs, and at springs.
  static SlipSums slipSums(const ActiveFace& face, double q, const MV& w) {
    double sums[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
    const double* const ws = BT::read(w);
    for (const Slip& slip : face.slipping) {
      const double along = slip.normal[0] * ws[slip.second] - slip.normal[1] * ws[slip.first];
      sums[0] += along * along;
      sums[1] += std::pow(q / (q + slip.curvature) * along, 2);
      sums[2] += std::pow((q + slip.curvature) * slip.radius, 2);
    }
    for (const Spring& spring : face.springs) {
      const double entry = ws[spring.entry];
      sums[3] += entry * entry;
      sums[4] += std::pow(q / (q + spring.curvature) * entry, 2);
    }
    BT::sum(w, sums, 5);
    return {sums[0], sums[1], sums[3], sums[4], sums[2]};
  }

 private:
  static void weigh(const ActiveFace& face, double q, double least, MV& v) {
    if (!face.springs.empty())
      Kernels::soften(face.springs, q, least, BT::write(v));
  }
};

} // namespace Harmos::qp
