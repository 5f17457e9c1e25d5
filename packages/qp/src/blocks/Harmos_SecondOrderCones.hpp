// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FollowingLimits.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::qp::Kernels {

/// Bounds, discs and limits that follow as second-order cones,
///
///     s = (f·(x_k − l_k), x_i − c, x_j − c) ∈ K = {s_0 ≥ |s_1|},   z ∈ K,   sᵀz = 0,
///
/// for interior points: s_0 is constant where a limit is given, there are no s_1 where a bound is alone. z is
/// what the gradient has to be. The scaling W with Wz = W⁻¹s is that of Nesterov and Todd (SIAM J. Optim. 8,
/// 1998; as in Vandenberghe, The CVXOPT linear and quadratic cone program solvers, 2010).
///
/// Where limits follow, the gradient at x_k is that of the cone, y_k = f|y_i|, where friction acts; what
/// friction is has y_k = 0 there. That is added to the gradient as shift() (de Saxcé, Feng, Math. Comput.
/// Modelling 28, 1998).
///
/// All arrays are those of one rank. Guarded by tests/unit/qp/test_following_limits.cpp.
class SecondOrderCones {
 public:
  /// @param limits null: none follows. @param lower, upper null for none.
  SecondOrderCones(std::size_t entries, const double* lower, const double* upper,
                   const std::vector<Disc>* discs, const FollowingLimits* limits);

  std::size_t size() const { return cones_.size(); }

  /// x moves into all cones, at least by `distance` from bounds and half a radius from rims, and to what has
  /// no room; z = τs⁻¹.
  void begin(double distance, double tau, double* x);

  /// Scales at the present s and z. @param q the diagonal of A, about.
  void scale(double q);

  /// sᵀz of each cone, at the first of its entries.
  void putProducts(double* products) const;
  /// One at these entries.
  void putOnes(double* ones) const;

  /// r ← r + στs⁻¹ − shift, in the place of a gradient; 0 where there is no room.
  void addCentring(double sigmaTau, double* r) const;
  /// r ← r + shift − z; 0 where there is no room.
  void subtractDual(double* r) const;
  /// y ← y + W⁻²p.
  void addCurvature(const double* p, double* y) const;
  /// v ← Dv, D = (1 + W⁻²/q)⁻¹; 0 where there is no room.
  void weigh(double* v) const;

  /// What dx makes of s and z. @return the longest step within the cones, at most one.
  double findStep(const double* dx, double sigmaTau);
  void advance(double length);

 private:
  struct Cone {
    int size;     // of s
    int index[3]; // −1: s is constant there
    double factor[3], base[3];
    double s[3], z[3], ds[3], dz[3];
    double scaling[3][3]; // W⁻²
    double weight[3][3];  // D
    bool follows;
  };

  void add(const Cone& cone) { cones_.push_back(cone); }
  static void evaluate(Cone& cone, const double* x);

  std::vector<Cone> cones_;
  struct Fixed {
    int index;
    double value;
  };
  std::vector<Fixed> fixed_;
};

} // namespace Harmos::qp::Kernels
