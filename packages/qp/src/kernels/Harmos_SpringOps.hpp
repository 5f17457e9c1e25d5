// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_BoundTypes.hpp"

#include <cmath>

namespace Harmos::qp {

/// Soft bounds on vectors: what Kernels of Harmos_SoftBounds.hpp do, for all vector types. Null pointers:
/// there are none, and nothing is done. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_soft_bounds.cpp.
template<class Scalar, class MV>
struct SpringOps {
  using BT = BoundTraits<Scalar, MV>;

  /// @param random see Kernels::updateSprings(), by BoundOps::setRandom().
  static SpringChange update(const MV& x, const LocalSoftBounds& bounds, double noise, const MV& random,
                             LocalActiveSet& set) {
    const SpringChange local =
        Kernels::updateSprings(bounds.bounds(), BT::read(x), noise, BT::read(random), set.springs);
    double sums[] = {static_cast<double>(local.changed), local.wrong2, local.signature[0],
                     local.signature[1]};
    BT::sum(x, sums, 4);
    return {static_cast<long long>(sums[0]), sums[1], {sums[2], sums[3]}};
  }

  /// y ← y + fκx of springs; with fromCentre x − c in the place of x. Local.
  static void add(const LocalActiveSet& set, double f, const MV& x, bool fromCentre, MV& y) {
    if (!set.springs.empty())
      Kernels::addSprings(set.springs, f, BT::read(x), fromCentre, BT::write(y));
  }

  /// v ← Tv, T = q/(q + κ) at springs. Local.
  static void soften(const LocalActiveSet& set, double q, MV& v) { weigh(set, q, 0.0, v); }
  /// The same where equalities are met again by it: a part that is lost in rounding errors beside those of
  /// others would be none.
  static void share(const LocalActiveSet& set, double q, MV& v) {
    constexpr double least = 1e-9;
    weigh(set, q, least, v);
  }
  /// z ← z + (I − T)Tq⁻¹v at springs. Local.
  static void addStiff(const LocalActiveSet& set, double q, const MV& v, MV& z) {
    if (!set.springs.empty())
      Kernels::addStiff(set.springs, q, BT::read(v), BT::write(z));
  }

  /// y ← y + κ(x − Π(x)). Local.
  static void addForces(const LocalSoftBounds* bounds, const MV& x, MV& y) { correct(bounds, {}, x, y); }

  /// The same where y knows springs already. Local.
  static void correct(const LocalSoftBounds* bounds, const LocalActiveSet& set, const MV& x, MV& y) {
    if (bounds != nullptr)
      Kernels::correctSprings(bounds->bounds(), set.springs, BT::read(x), BT::write(y));
  }

  /// See Kernels::moveToSprings(). Local.
  static void move(const LocalActiveSet& before, const LocalActiveSet& set, double q, MV& x) {
    if (!set.springs.empty())
      Kernels::moveToSprings(before.springs, set.springs, q, BT::write(x));
  }

  /// Springs as a vector, and back. Local.
  static void toVector(const LocalSoftBounds& bounds, const LocalActiveSet& set, MV& sides) {
    Kernels::springsToSides(bounds.bounds(), set.springs, BT::write(sides));
  }
  static void fromVector(const LocalSoftBounds& bounds, const MV& sides, LocalActiveSet& set) {
    set.springs = Kernels::springsOfSides(bounds.bounds(), BT::read(sides));
  }

  /// dᵀκ(x − Π(x)).
  static double power(const LocalSoftBounds& bounds, const MV& x, const MV& d) {
    double sum = Kernels::softPower(bounds.bounds(), BT::read(x), BT::read(d));
    BT::sum(x, &sum, 1);
    return sum;
  }

  /// Σcf over springs, f a vector.
  static double atCentres(const LocalActiveSet& set, const MV& f) {
    const double* const values = BT::read(f);
    double sum = 0.0;
    for (const Spring& spring : set.springs)
      sum += spring.centre * values[spring.entry];
    BT::sum(f, &sum, 1);
    return sum;
  }

  /// The norm of what in d leads from intervals for ever: along it the cost grows without end.
  static double opposed(const LocalSoftBounds* bounds, const MV& d) {
    if (bounds == nullptr)
      return 0.0;
    double sum = Kernels::opposed2(bounds->bounds(), BT::read(d));
    BT::sum(d, &sum, 1);
    return std::sqrt(sum);
  }

 private:
  static void weigh(const LocalActiveSet& set, double q, double least, MV& v) {
    if (!set.springs.empty())
      Kernels::soften(set.springs, q, least, BT::write(v));
  }
};

} // namespace Harmos::qp
