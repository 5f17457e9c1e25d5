// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"

#include <cmath>

namespace Harmos::qp {

/// Soft bounds on vectors: what Kernels of Harmos_SoftBounds.hpp do, for all vector types. Null pointers:
/// there are none, and nothing is done. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_soft_bounds.cpp.
template<class Scalar, class MV>
struct SpringOps {
  using BT = BoundTraits<Scalar, MV>;

  /// @param random see Kernels::updateSprings(), by BoundTraits::setRandom().
  static SpringChange update(const MV& x, const LocalSoftBounds& bounds, double noise, const MV& random,
                             LocalActiveSet& set) {
    SpringChange local;
    BT::read(x, [&](const double* entries) {
      BT::read(random, [&](const double* numbers) {
        local = Kernels::updateSprings(bounds.bounds(), entries, noise, numbers, set.springs);
      });
    });
    double sums[] = {static_cast<double>(local.changed), local.wrong2, local.signature[0],
                     local.signature[1]};
    BT::sum(x, sums, 4);
    return {static_cast<long long>(sums[0]), sums[1], {sums[2], sums[3]}};
  }

  /// y ← y + fκx of springs; with fromCentre x − c in the place of x. Local.
  static void add(const LocalActiveSet& set, double f, const MV& x, bool fromCentre, MV& y) {
    if (set.springs.empty())
      return;
    BT::read(x, [&](const double* from) {
      BT::write(y, [&](double* to) { Kernels::addSprings(set.springs, f, from, fromCentre, to); });
    });
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
    if (set.springs.empty())
      return;
    BT::read(v, [&](const double* from) {
      BT::write(z, [&](double* to) { Kernels::addStiff(set.springs, q, from, to); });
    });
  }

  /// y ← y + κ(x − Π(x)). Local.
  static void addForces(const LocalSoftBounds* bounds, const MV& x, MV& y) { correct(bounds, {}, x, y); }

  /// The same where y knows springs already. Local.
  static void correct(const LocalSoftBounds* bounds, const LocalActiveSet& set, const MV& x, MV& y) {
    if (bounds == nullptr)
      return;
    BT::read(x, [&](const double* from) {
      BT::write(y, [&](double* to) { Kernels::correctSprings(bounds->bounds(), set.springs, from, to); });
    });
  }

  /// See Kernels::moveToSprings(). Local.
  static void move(const LocalActiveSet& before, const LocalActiveSet& set, double q, MV& x) {
    if (!set.springs.empty())
      BT::write(x, [&](double* to) { Kernels::moveToSprings(before.springs, set.springs, q, to); });
  }

  /// Springs as a vector, and back. Local.
  static void toVector(const LocalSoftBounds& bounds, const LocalActiveSet& set, MV& sides) {
    BT::write(sides, [&](double* to) { Kernels::springsToSides(bounds.bounds(), set.springs, to); });
  }
  static void fromVector(const LocalSoftBounds& bounds, const MV& sides, LocalActiveSet& set) {
    BT::read(sides,
             [&](const double* from) { set.springs = Kernels::springsOfSides(bounds.bounds(), from); });
  }

  /// dᵀκ(x − Π(x)).
  static double power(const LocalSoftBounds& bounds, const MV& x, const MV& d) {
    double sum = 0.0;
    BT::read(x, [&](const double* at) {
      BT::read(d, [&](const double* along) { sum = Kernels::softPower(bounds.bounds(), at, along); });
    });
    BT::sum(x, &sum, 1);
    return sum;
  }

  /// Σcf over springs, f a vector.
  static double atCentres(const LocalActiveSet& set, const MV& f) {
    double sum = 0.0;
    BT::read(f, [&](const double* values) {
      for (const Spring& spring : set.springs)
        sum += spring.centre * values[static_cast<std::size_t>(spring.entry)];
    });
    BT::sum(f, &sum, 1);
    return sum;
  }

  /// The norm of what in d leads from intervals for ever: along it the cost grows without end.
  static double opposed(const LocalSoftBounds* bounds, const MV& d) {
    if (bounds == nullptr)
      return 0.0;
    double sum = 0.0;
    BT::read(d, [&](const double* along) { sum = Kernels::opposed2(bounds->bounds(), along); });
    BT::sum(d, &sum, 1);
    return std::sqrt(sum);
  }

 private:
  static void weigh(const LocalActiveSet& set, double q, double least, MV& v) {
    if (!set.springs.empty())
      BT::write(v, [&](double* to) { Kernels::soften(set.springs, q, least, to); });
  }
};

} // namespace Harmos::qp
