// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_InteriorPoint.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace Harmos {
namespace {

using Real = long double;
using Vector = std::vector<Real>;

class Barrier {
 public:
  explicit Barrier(const SmallQp& qp)
      : qp_(qp), n_(static_cast<std::size_t>(qp.size())), m_(static_cast<std::size_t>(qp.c.rows)) {}

  // Somewhere inside.
  Vector start() const {
    Vector x(n_, 0.0L);
    for (std::size_t i = 0; i < n_; ++i) {
      const Real l = lower(i), u = upper(i);
      x[i] = std::isfinite(l) && std::isfinite(u) ? 0.5L * (l + u)
             : std::isfinite(l)                   ? l + 1.0L
             : std::isfinite(u)                   ? u - 1.0L
                                                  : 0.0L;
    }
    for (const qp::Disc& disc : qp_.discs) {
      x[place(disc.first)] = disc.centre[0];
      x[place(disc.second)] = disc.centre[1];
    }
    return x;
  }

  // The longest part of a step that stays inside.
  Real inside(const Vector& x, const Vector& step) const {
    Real part = 1.0L;
    const auto isInside = [&](Real length) {
      for (std::size_t i = 0; i < n_; ++i)
        if (const Real at = x[i] + length * step[i]; !(at > lower(i)) || !(at < upper(i)))
          return false;
      for (const qp::Disc& disc : qp_.discs) {
        const std::size_t a = place(disc.first), b = place(disc.second);
        const Real p = x[a] + length * step[a] - disc.centre[0], q = x[b] + length * step[b] - disc.centre[1];
        if (!(p * p + q * q < static_cast<Real>(disc.radius) * disc.radius))
          return false;
      }
      return true;
    };
    while (!isInside(part) && part > 1e-30L)
      part *= 0.9L;
    return part > 1e-30L ? (part < 1.0L ? 0.9L * part : part) : 0.0L;
  }

  // Newton's step for min ½xᵀAx − bᵀx − t Σ log(slack), Cx = c; μ becomes the new multiplier.
  // @return ‖step‖ in the largest entry.
  Real step(Vector& x, Vector& mu, Real t) const {
    const std::size_t size = n_ + m_;
    std::vector<Vector> k(size, Vector(size + 1, 0.0L)); // with the right-hand side
    for (std::size_t i = 0; i < n_; ++i) {
      Real gradient = -static_cast<Real>(qp_.b[i]);
      for (std::size_t j = 0; j < n_; ++j) {
        k[i][j] = qp_.a(static_cast<int>(i), static_cast<int>(j));
        gradient += k[i][j] * x[j];
      }
      for (Real slack : {x[i] - lower(i), x[i] - upper(i)})
        if (std::isfinite(slack)) {
          gradient -= t / slack;
          k[i][i] += t / (slack * slack);
        }
      k[i][size] = -gradient;
    }
    for (const qp::Disc& disc : qp_.discs) {
      const std::size_t at[] = {place(disc.first), place(disc.second)};
      const Real y[] = {x[at[0]] - disc.centre[0], x[at[1]] - disc.centre[1]};
      const Real slack = static_cast<Real>(disc.radius) * disc.radius - y[0] * y[0] - y[1] * y[1];
      for (int p = 0; p < 2; ++p) {
        k[at[p]][size] -= 2.0L * t * y[p] / slack;
        for (int q = 0; q < 2; ++q)
          k[at[p]][at[q]] += (p == q ? 2.0L * t / slack : 0.0L) + 4.0L * t * y[p] * y[q] / (slack * slack);
      }
    }
    for (std::size_t r = 0; r < m_; ++r) {
      Real residual = qp_.cRhs[r];
      for (std::size_t j = 0; j < n_; ++j) {
        const Real entry = qp_.c(static_cast<int>(r), static_cast<int>(j));
        k[n_ + r][j] = k[j][n_ + r] = entry;
        residual -= entry * x[j];
      }
      k[n_ + r][size] = residual;
    }
    const Vector found = solved(std::move(k));
    // Slacks that are rounding errors: no more is to be had.
    if (!std::all_of(found.begin(), found.end(), [](Real value) { return std::isfinite(value); }))
      return 0.0L;
    const Vector direction(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(n_));
    const Real part = inside(x, direction);
    Real largest = 0.0L;
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] += part * direction[i];
      largest = std::max(largest, std::abs(direction[i]));
    }
    for (std::size_t r = 0; r < m_; ++r)
      mu[r] = found[n_ + r];
    return largest;
  }

 private:
  static std::size_t place(int entry) { return static_cast<std::size_t>(entry); }
  Real lower(std::size_t i) const { return qp_.lower.empty() ? -HUGE_VALL : qp_.lower[i]; }
  Real upper(std::size_t i) const { return qp_.upper.empty() ? HUGE_VALL : qp_.upper[i]; }

  // Elimination with pivoting of rows.
  static Vector solved(std::vector<Vector> k) {
    const std::size_t n = k.size();
    for (std::size_t c = 0; c < n; ++c) {
      std::size_t pivot = c;
      for (std::size_t r = c + 1; r < n; ++r)
        if (std::abs(k[r][c]) > std::abs(k[pivot][c]))
          pivot = r;
      std::swap(k[c], k[pivot]);
      for (std::size_t r = c + 1; r < n; ++r) {
        const Real factor = k[r][c] / k[c][c];
        for (std::size_t j = c; j <= n; ++j)
          k[r][j] -= factor * k[c][j];
      }
    }
    Vector x(n, 0.0L);
    for (std::size_t r = n; r-- > 0;) {
      Real sum = k[r][n];
      for (std::size_t j = r + 1; j < n; ++j)
        sum -= k[r][j] * x[j];
      x[r] = sum / k[r][r];
    }
    return x;
  }

  const SmallQp& qp_;
  std::size_t n_, m_;
};

} // namespace

std::vector<double> interiorPoint(const SmallQp& qp, std::vector<double>* multipliers) {
  const Barrier barrier(qp);
  Vector x = barrier.start(), mu(static_cast<std::size_t>(qp.c.rows), 0.0L);
  // Solutions are off by O(t), O(√t) where a multiplier vanishes with its slack.
  for (Real t = 1.0L; t > 1e-17L; t *= 0.2L) {
    constexpr int mostSteps = 60;
    Real last = HUGE_VALL;
    for (int k = 0; k < mostSteps && last > 1e-3L * t; ++k)
      last = barrier.step(x, mu, t);
  }
  if (multipliers != nullptr)
    multipliers->assign(mu.begin(), mu.end());
  return {x.begin(), x.end()};
}

} // namespace Harmos
