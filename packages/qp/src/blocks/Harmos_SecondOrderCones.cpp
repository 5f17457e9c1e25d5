// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SecondOrderCones.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace Harmos::qp::Kernels {
namespace {

using Vector = const double*;

double product(int size, Vector a, Vector b) {
  double sum = 0.0;
  for (int k = 0; k < size; ++k)
    sum += a[k] * b[k];
  return sum;
}

double arm(int size, Vector s) {
  double sum = 0.0;
  for (int k = 1; k < size; ++k)
    sum += s[k] * s[k];
  return std::sqrt(sum);
}

// s_0² − |s_1|², without cancellation.
double determinant(int size, Vector s) {
  const double length = arm(size, s);
  return (s[0] - length) * (s[0] + length);
}

// The part of ds that leads to the boundary, at most one.
double longest(int size, Vector s, Vector ds) {
  // (s_0 + αd_0)² = |s_1 + αd_1|²: c + 2bα + aα², c > 0.
  double a = ds[0] * ds[0], b = s[0] * ds[0];
  for (int k = 1; k < size; ++k) {
    a -= ds[k] * ds[k];
    b -= s[k] * ds[k];
  }
  const double c = determinant(size, s);
  double result = 1.0;
  const double discriminant = b * b - a * c;
  if (a < 0.0 || (b < 0.0 && discriminant >= 0.0)) {
    const double root = std::sqrt(std::max(discriminant, 0.0));
    // The least positive root.
    const double first = b <= 0.0 ? c / (-b + root) : (-b - root) / a;
    if (first > 0.0)
      result = std::min(result, first);
  }
  if (ds[0] < 0.0)
    result = std::min(result, -s[0] / ds[0]);
  return result;
}

} // namespace

SecondOrderCones::SecondOrderCones(std::size_t entries, const double* lower, const double* upper,
                                   const std::vector<Disc>* discs, const FollowingLimits* limits) {
  std::vector<char> isTaken(entries, 0);
  std::vector<char> discFollows(discs != nullptr ? discs->size() : 0, 0);
  if (limits != nullptr)
    for (const FollowingLimit& limit : *limits) {
      Cone cone{};
      cone.size = limit.isDisc ? 3 : 2;
      cone.follows = true;
      cone.index[0] = limit.source;
      cone.factor[0] = limit.factor;
      cone.base[0] = lower[limit.source];
      if (limit.isDisc) {
        const auto d = static_cast<std::size_t>(limit.place);
        discFollows[d] = 1;
        const Disc& disc = (*discs)[d];
        cone.index[1] = disc.first;
        cone.index[2] = disc.second;
        cone.base[1] = disc.centre[0];
        cone.base[2] = disc.centre[1];
      } else {
        cone.index[1] = limit.place;
        cone.base[1] = limit.centre;
      }
      cone.factor[1] = cone.factor[2] = 1.0;
      for (int k = 1; k < cone.size; ++k)
        isTaken[static_cast<std::size_t>(cone.index[k])] = 1;
      if (!(limit.factor > 0.0)) {
        for (int k = 1; k < cone.size; ++k)
          fixed_.push_back({cone.index[k], cone.base[k]});
        continue;
      }
      isTaken[static_cast<std::size_t>(limit.source)] = 1;
      add(cone);
    }
  if (discs != nullptr)
    for (std::size_t d = 0; d < discs->size(); ++d) {
      const Disc& disc = (*discs)[d];
      isTaken[static_cast<std::size_t>(disc.first)] = isTaken[static_cast<std::size_t>(disc.second)] = 1;
      if (discFollows[d] != 0)
        continue;
      if (!(disc.radius > 0.0)) {
        fixed_.push_back({disc.first, disc.centre[0]});
        fixed_.push_back({disc.second, disc.centre[1]});
        continue;
      }
      add({3,
           {-1, disc.first, disc.second},
           {0.0, 1.0, 1.0},
           {disc.radius, disc.centre[0], disc.centre[1]},
           {},
           {},
           {},
           {},
           {},
           {},
           false});
    }
  for (std::size_t i = 0; i < entries; ++i) {
    const double low = lower != nullptr ? lower[i] : -std::numeric_limits<double>::infinity();
    const double high = upper != nullptr ? upper[i] : std::numeric_limits<double>::infinity();
    const bool hasLow = std::isfinite(low), hasHigh = std::isfinite(high);
    const int place = static_cast<int>(i);
    if (isTaken[i] != 0 || (!hasLow && !hasHigh))
      continue;
    if (hasLow && hasHigh && !(high > low))
      fixed_.push_back({place, low});
    else if (hasLow && hasHigh)
      add({2,
           {-1, place, -1},
           {0.0, 1.0, 0.0},
           {0.5 * (high - low), low + 0.5 * (high - low), 0.0},
           {},
           {},
           {},
           {},
           {},
           {},
           false});
    else
      add({1,
           {place, -1, -1},
           {hasLow ? 1.0 : -1.0, 0.0, 0.0},
           {hasLow ? low : high, 0.0, 0.0},
           {},
           {},
           {},
           {},
           {},
           {},
           false});
  }
}

void SecondOrderCones::evaluate(Cone& cone, const double* x) {
  for (int k = 0; k < cone.size; ++k)
    cone.s[k] = cone.index[k] < 0 ? cone.base[k] : cone.factor[k] * (x[cone.index[k]] - cone.base[k]);
}

void SecondOrderCones::begin(double distance, double tau, double* x) {
  for (const Fixed& fixed : fixed_)
    x[fixed.index] = fixed.value;
  for (Cone& cone : cones_) {
    evaluate(cone, x);
    if (cone.index[0] >= 0)
      cone.s[0] = std::max(cone.s[0], std::abs(cone.factor[0]) * distance);
    const double length = arm(cone.size, cone.s), most = 0.5 * cone.s[0];
    for (int k = 1; k < cone.size; ++k)
      cone.s[k] *= length > most ? most / length : 1.0;
    for (int k = 0; k < cone.size; ++k)
      if (cone.index[k] >= 0)
        x[cone.index[k]] = cone.base[k] + cone.s[k] / cone.factor[k];
    const double share = tau / determinant(cone.size, cone.s);
    for (int k = 0; k < cone.size; ++k)
      cone.z[k] = k == 0 ? share * cone.s[k] : -share * cone.s[k];
  }
}

void SecondOrderCones::scale(double q) {
  for (Cone& cone : cones_) {
    const int n = cone.size;
    const double sSize = std::sqrt(determinant(n, cone.s)), zSize = std::sqrt(determinant(n, cone.z));
    const double gamma = std::sqrt(0.5 * (1.0 + product(n, cone.s, cone.z) / (sSize * zSize)));
    double w[3]; // Jw̄
    for (int k = 0; k < n; ++k) {
      const double s = cone.s[k] / sSize, z = cone.z[k] / zSize;
      w[k] = (k == 0 ? s + z : z - s) / (2.0 * gamma);
    }
    const double factor = zSize / sSize; // β⁻²
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        cone.scaling[a][b] = factor * (2.0 * w[a] * w[b] - (a != b ? 0.0 : a == 0 ? 1.0 : -1.0));
    // D, by the adjugate of what is free.
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        if (cone.index[a] >= 0 && cone.index[b] >= 0)
          m[a][b] += cone.factor[a] * cone.factor[b] * cone.scaling[a][b] / q;
    const auto minor = [&](int a, int b) {
      const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
      return m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1];
    };
    const double whole = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        cone.weight[a][b] = minor(b, a) / whole;
  }
}

void SecondOrderCones::putProducts(double* products) const {
  for (const Cone& cone : cones_)
    products[cone.index[0] >= 0 ? cone.index[0] : cone.index[1]] = product(cone.size, cone.s, cone.z);
}

void SecondOrderCones::putOnes(double* ones) const {
  for (const Cone& cone : cones_)
    ones[cone.index[0] >= 0 ? cone.index[0] : cone.index[1]] = 1.0;
}

void SecondOrderCones::addCentring(double sigmaTau, double* r) const {
  for (const Cone& cone : cones_) {
    const double share = sigmaTau / determinant(cone.size, cone.s);
    for (int k = 0; k < cone.size; ++k)
      if (cone.index[k] >= 0)
        r[cone.index[k]] += cone.factor[k] * (k == 0 ? share : -share) * cone.s[k];
    if (cone.follows)
      r[cone.index[0]] -= cone.factor[0] * arm(cone.size, cone.z);
  }
  for (const Fixed& fixed : fixed_)
    r[fixed.index] = 0.0;
}

void SecondOrderCones::subtractDual(double* r) const {
  for (const Cone& cone : cones_) {
    for (int k = 0; k < cone.size; ++k)
      if (cone.index[k] >= 0)
        r[cone.index[k]] -= cone.factor[k] * cone.z[k];
    if (cone.follows)
      r[cone.index[0]] += cone.factor[0] * arm(cone.size, cone.z);
  }
  for (const Fixed& fixed : fixed_)
    r[fixed.index] = 0.0;
}

void SecondOrderCones::addCurvature(const double* p, double* y) const {
  for (const Cone& cone : cones_)
    for (int a = 0; a < cone.size; ++a)
      for (int b = 0; b < cone.size; ++b)
        if (cone.index[a] >= 0 && cone.index[b] >= 0)
          y[cone.index[a]] += cone.factor[a] * cone.factor[b] * cone.scaling[a][b] * p[cone.index[b]];
}

void SecondOrderCones::weigh(double* v) const {
  for (const Cone& cone : cones_) {
    double before[3] = {0, 0, 0};
    for (int k = 0; k < cone.size; ++k)
      if (cone.index[k] >= 0)
        before[k] = v[cone.index[k]];
    for (int k = 0; k < cone.size; ++k)
      if (cone.index[k] >= 0)
        v[cone.index[k]] = product(3, cone.weight[k], before);
  }
  for (const Fixed& fixed : fixed_)
    v[fixed.index] = 0.0;
}

double SecondOrderCones::findStep(const double* dx, double sigmaTau) {
  double result = 1.0;
  for (Cone& cone : cones_) {
    const int n = cone.size;
    const double share = sigmaTau / determinant(n, cone.s);
    for (int k = 0; k < n; ++k)
      cone.ds[k] = cone.index[k] >= 0 ? cone.factor[k] * dx[cone.index[k]] : 0.0;
    for (int k = 0; k < n; ++k)
      cone.dz[k] = (k == 0 ? share : -share) * cone.s[k] - cone.z[k] - product(n, cone.scaling[k], cone.ds);
    result = std::min({result, longest(n, cone.s, cone.ds), longest(n, cone.z, cone.dz)});
  }
  return result;
}

void SecondOrderCones::advance(double length) {
  for (Cone& cone : cones_)
    for (int k = 0; k < cone.size; ++k) {
      cone.s[k] += length * cone.ds[k];
      cone.z[k] += length * cone.dz[k];
    }
}

} // namespace Harmos::qp::Kernels
