// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RandomQp.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos {
namespace {

double unit(std::mt19937& random) {
  return std::uniform_real_distribution<double>(-1.0, 1.0)(random);
}

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

} // namespace

double norm(const std::vector<double>& x) {
  double sum = 0.0;
  for (double value : x)
    sum += value * value;
  return std::sqrt(sum);
}

double distance(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += (x[i] - y[i]) * (x[i] - y[i]);
  return std::sqrt(sum);
}

std::vector<double> product(const Dense& m, const std::vector<double>& x) {
  std::vector<double> y(static_cast<std::size_t>(m.rows), 0.0);
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j)
      y[static_cast<std::size_t>(i)] += m(i, j) * x[static_cast<std::size_t>(j)];
  return y;
}

std::vector<double> equalityResidual(const SmallQp& qp, const std::vector<double>& x) {
  std::vector<double> r = product(qp.c, x);
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] -= qp.cRhs[i];
  return r;
}

std::vector<double> lagrangianGradient(const SmallQp& qp, const std::vector<double>& x,
                                       const std::vector<double>& mu) {
  std::vector<double> g = product(qp.a, x);
  for (int i = 0; i < qp.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    g[k] -= qp.b[k];
    for (int r = 0; r < qp.c.rows; ++r)
      g[k] += qp.c(r, i) * mu[static_cast<std::size_t>(r)];
  }
  return g;
}

double farkasInfimum(const SmallQp& qp, const std::vector<double>& y, double radius) {
  double result = 0.0;
  for (int r = 0; r < qp.c.rows; ++r)
    result -= y[static_cast<std::size_t>(r)] * qp.cRhs[static_cast<std::size_t>(r)];
  for (int i = 0; i < qp.size(); ++i) {
    double w = 0.0;
    for (int r = 0; r < qp.c.rows; ++r)
      w += qp.c(r, i) * y[static_cast<std::size_t>(r)];
    const auto k = static_cast<std::size_t>(i);
    const double l = qp.lower.empty() ? -infinity : qp.lower[k],
                 u = qp.upper.empty() ? infinity : qp.upper[k];
    result += w > 0.0 ? w * std::max(l, -radius) : w * std::min(u, radius);
  }
  return result;
}

BuiltQp builtQp(std::mt19937& random, int n, int equalities, int nullity, bool degenerate) {
  BuiltQp built{{withSpectrum(randomOrthonormal(random, n), std::min(nullity, n - 1), 100.0),
                 {},
                 {},
                 {},
                 Dense(equalities, n),
                 {}},
                {}};
  SmallQp& qp = built.qp;
  for (double& value : qp.c.values)
    value = unit(random);
  std::vector<double> mu;
  for (int r = 0; r < equalities; ++r)
    mu.push_back(unit(random));
  std::vector<double> y;
  for (int i = 0; i < n; ++i) {
    const double x = unit(random), kind = unit(random);
    built.x.push_back(x);
    const double force = degenerate && unit(random) < 0.3 ? 0.0 : 0.2 + std::abs(unit(random));
    const double room = 0.2 + std::abs(unit(random));
    if (kind < -0.4) { // at the lower bound
      qp.lower.push_back(x);
      qp.upper.push_back(kind < -0.7 ? x + room : infinity);
      y.push_back(force);
    } else if (kind < 0.0) { // at the upper one
      qp.lower.push_back(kind < -0.2 ? x - room : -infinity);
      qp.upper.push_back(x);
      y.push_back(-force);
    } else {
      qp.lower.push_back(kind < 0.6 ? x - room : -infinity);
      qp.upper.push_back(kind > 0.3 ? x + room : infinity);
      y.push_back(0.0);
    }
  }
  qp.b.assign(static_cast<std::size_t>(n), 0.0);
  qp.b = lagrangianGradient(qp, built.x, mu);
  for (std::size_t i = 0; i < y.size(); ++i)
    qp.b[i] -= y[i];
  qp.cRhs = product(qp.c, built.x);
  return built;
}

void addDependentRows(std::mt19937& random, SmallQp& qp, int count) {
  const int old = qp.c.rows;
  Dense c(old + count, qp.size());
  for (int i = 0; i < qp.size(); ++i)
    for (int r = 0; r < old; ++r)
      c(r, i) = qp.c(r, i);
  for (int k = 0; k < count; ++k) {
    const double scale = std::pow(10.0, 3.0 * unit(random));
    double rhs = 0.0;
    for (int r = 0; r < old; ++r) {
      // The first is a plain repetition.
      const double factor = scale * (k == 0 ? (r == 0 ? 1.0 : 0.0) : unit(random));
      rhs += factor * qp.cRhs[static_cast<std::size_t>(r)];
      for (int i = 0; i < qp.size(); ++i)
        c(old + k, i) += factor * qp.c(r, i);
    }
    qp.cRhs.push_back(rhs);
  }
  qp.c = c;
}

SmallQp infeasibleQp(std::mt19937& random, int n, int kind) {
  SmallQp qp = randomQp(random, n, kind == 0 ? n % 2 : 1 + n % 2, kind != 1, 100.0);
  const auto last = static_cast<std::size_t>(n - 1);
  if (kind == 0) {
    qp.lower[last] = 0.5;
    qp.upper[last] = 0.25;
  } else if (kind == 1) {
    addDependentRows(random, qp, 1);
    qp.cRhs.back() += 0.3 * (std::abs(qp.cRhs.back()) + 1.0);
  } else {
    // Row 0 wants more than the box, or the orthant, can give.
    double most = 0.0;
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (kind == 2) {
        qp.lower[k] = -1.0;
        qp.upper[k] = 1.0;
        most += std::abs(qp.c(0, i));
      } else {
        qp.lower[k] = 0.0;
        qp.upper[k] = infinity;
        qp.c(0, i) = -0.1 - std::abs(qp.c(0, i));
      }
    }
    qp.cRhs[0] = most + 0.2;
    if (qp.c.rows > 1) // the second one alone can be met
      qp.cRhs[1] = kind == 2 ? 0.0 : std::abs(qp.c(1, 0)) * (qp.c(1, 0) > 0.0 ? 1.0 : -1.0);
  }
  return qp;
}

SmallQp unboundedQp(std::mt19937& random, int n, int equalities, bool bounds) {
  // d has entries of both signs and none that is small.
  std::vector<double> d;
  for (int i = 0; i < n; ++i)
    d.push_back((unit(random) < 0.0 ? -1.0 : 1.0) * (0.3 + std::abs(unit(random))));
  const double length = norm(d);
  for (double& value : d)
    value /= length;
  SmallQp qp{withSpectrum(randomOrthonormal(random, n, {d}), 1, 100.0),
             {},
             {},
             {},
             Dense(std::min(equalities, n - 2), n),
             {}};
  std::vector<double> feasible;
  double load = 0.0;
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    qp.b.push_back(unit(random));
    load += qp.b[k] * d[k];
    feasible.push_back(unit(random));
    if (!bounds)
      continue;
    const bool held = unit(random) < 0.5; // on the side from which d leads away
    qp.lower.push_back(held && d[k] > 0.0 ? feasible[k] - std::abs(unit(random)) : -infinity);
    qp.upper.push_back(held && d[k] < 0.0 ? feasible[k] + std::abs(unit(random)) : infinity);
  }
  for (int i = 0; i < n; ++i) // bᵀd = 0.5
    qp.b[static_cast<std::size_t>(i)] += (0.5 - load) * d[static_cast<std::size_t>(i)];
  for (int r = 0; r < qp.c.rows; ++r) {
    double dot = 0.0;
    for (int i = 0; i < n; ++i) {
      qp.c(r, i) = unit(random);
      dot += qp.c(r, i) * d[static_cast<std::size_t>(i)];
    }
    for (int i = 0; i < n; ++i)
      qp.c(r, i) -= dot * d[static_cast<std::size_t>(i)];
  }
  qp.cRhs = product(qp.c, feasible);
  return qp;
}

SmallQp followingQp(std::mt19937& random, int points, int tangents, int freeEntries, int equalities,
                    double factor) {
  const int n = points * (1 + tangents) + freeEntries;
  SmallQp qp = randomQp(random, n, equalities, false, 20.0);
  qp.lower.assign(at(n), -infinity);
  qp.upper.assign(at(n), infinity);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> inside(at(n));
  for (double& value : inside)
    value = uniform(random);
  for (int p = 0; p < points; ++p) {
    const int normal = p * (1 + tangents);
    qp.lower[at(normal)] = 0.0;
    inside[at(normal)] = std::abs(inside[at(normal)]) + 0.1;
    const double limit = factor * inside[at(normal)];
    for (int k = 1; k <= tangents; ++k)
      inside[at(normal + k)] = 0.6 * limit * uniform(random);
    if (tangents == 2)
      qp.discs.push_back({normal + 1, normal + 2, {0.0, 0.0}, 1e100});
    qp.follows.push_back({tangents == 2 ? p : normal + 1, tangents == 2, normal, factor});
  }
  for (int r = 0; r < equalities; ++r) {
    qp.cRhs[at(r)] = 0.0;
    for (int i = 0; i < n; ++i)
      qp.cRhs[at(r)] += qp.c(r, i) * inside[at(i)];
  }
  return qp;
}

SmallQp turningBodiesQp(std::mt19937& random, int bodies, int points, double factor) {
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  const int n = 2 * bodies * points;
  SmallQp qp{Dense(n, n),
             std::vector<double>(at(n)),
             std::vector<double>(at(n), -infinity),
             std::vector<double>(at(n), infinity),
             Dense(bodies, n),
             std::vector<double>(at(bodies), 0.0)};
  for (int body = 0; body < bodies; ++body)
    for (int p = 0; p < points; ++p) {
      const int normal = 2 * (body * points + p);
      qp.a(normal, normal) = qp.a(normal + 1, normal + 1) = uniform(random);
      qp.b[at(normal)] = uniform(random);                 // pressed
      qp.b[at(normal + 1)] = 4.0 * uniform(random) - 3.0; // and rubbed
      qp.lower[at(normal)] = 0.0;
      qp.c(body, normal + 1) = 1.0 / std::sqrt(points); // the sum of a body's friction is zero
      qp.follows.push_back({normal + 1, false, normal, factor});
    }
  return qp;
}

} // namespace Harmos
