// SPDX-License-Identifier: BSD-3-Clause

/// Whatever a solver calls converged is: on problems at the edge of double precision, bounds, equalities and
/// the gradient with the multiplier that is returned are computed anew and held against the tolerance.

#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace test_adversarial {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

enum class Kind { TinyBoxes, NearlyDependentRows, IllConditioned, BadlyScaled, SmallUnits, LargeUnits };

void scale(SmallQp& qp, double matrix, double load) {
  for (double& value : qp.a.values)
    value *= matrix;
  for (double& value : qp.b)
    value *= load;
  for (std::vector<double>* values : {&qp.lower, &qp.upper, &qp.cRhs})
    for (double& value : *values)
      value *= load / matrix;
}

SmallQp adversary(std::mt19937& random, Kind kind, int n, int equalities) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const bool hard = kind == Kind::IllConditioned;
  SmallQp qp = randomQp(random, n, equalities, true, hard ? 1e12 : kind == Kind::BadlyScaled ? 1e6 : 100.0);
  qp.upper.resize(static_cast<std::size_t>(n), infinity);
  if (kind == Kind::SmallUnits)
    scale(qp, 1e9, 1e-9);
  if (kind == Kind::LargeUnits)
    scale(qp, 1e-9, 1e9);
  if (kind == Kind::TinyBoxes) {
    std::fill(qp.cRhs.begin(), qp.cRhs.end(), 0.0);
    for (std::size_t i = 0; i < qp.lower.size(); ++i) {
      qp.lower[i] = i % 2 == 1 ? -1e-13 : std::min(qp.lower[i], 0.0);
      qp.upper[i] = i % 2 == 1 ? 1e-13 : std::max(qp.upper[i], 0.0);
    }
  }
  if (kind == Kind::NearlyDependentRows && equalities == 2) {
    for (int j = 0; j < n; ++j)
      qp.c(1, j) = qp.c(0, j) + 1e-8 * qp.c(1, j);
    qp.cRhs[1] = qp.cRhs[0] + 1e-8 * qp.cRhs[1];
  }
  if (kind == Kind::BadlyScaled)
    for (int i = 0; i < n; ++i) {
      const double factor = std::pow(10.0, 3.0 * unit(random));
      const auto entry = static_cast<std::size_t>(i);
      for (int j = 0; j < n; ++j) {
        qp.a(i, j) *= factor;
        qp.a(j, i) *= factor;
      }
      qp.b[entry] *= factor;
      qp.lower[entry] /= factor;
      qp.upper[entry] /= factor;
      for (int r = 0; r < equalities; ++r)
        qp.c(r, i) *= factor;
    }
  return qp;
}

void expectWhatItClaims(const SmallQp& qp, const std::vector<double>& x, const std::vector<double>& mu,
                        double tolerance, const std::string& what) {
  std::vector<double> gradient = qp.c.rows > 0 ? lagrangianGradient(qp, x, mu) : product(qp.a, x);
  double projected2 = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (qp.c.rows == 0)
      gradient[i] -= qp.b[i];
    outside = std::max({outside, qp.lower[i] - x[i], x[i] - qp.upper[i]});
    double g = gradient[i];
    if (x[i] <= qp.lower[i])
      g = std::min(g, 0.0);
    if (x[i] >= qp.upper[i])
      g = std::max(g, 0.0);
    projected2 += g * g;
  }
  EXPECT_LE(outside, 0.0) << what;
  // Twice the tolerance, and the rounding errors of this evaluation.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const auto n = static_cast<double>(x.size());
  const double terms = norm(qp.a.values) * norm(x) + norm(qp.b) + norm(qp.c.values) * norm(mu);
  EXPECT_LE(std::sqrt(projected2), 2.0 * tolerance * norm(qp.b) + 4.0 * n * epsilon * terms) << what;
  if (qp.c.rows == 0)
    return;
  const std::vector<double> residual = equalityResidual(qp, x);
  for (int r = 0; r < qp.c.rows; ++r) {
    double row2 = 0.0;
    for (int j = 0; j < qp.c.columns; ++j)
      row2 += qp.c(r, j) * qp.c(r, j);
    EXPECT_LE(std::abs(residual[static_cast<std::size_t>(r)]),
              (2.0 * tolerance + 4.0 * n * epsilon) * std::sqrt(row2) * norm(x))
        << what;
  }
}

} // namespace

TEST(Adversarial, converged_is_converged) {
  for (Kind kind : {Kind::TinyBoxes, Kind::NearlyDependentRows, Kind::IllConditioned, Kind::BadlyScaled,
                    Kind::SmallUnits, Kind::LargeUnits}) {
    int converged = 0, runs = 0;
    for (int k = 0; k < 18; ++k) {
      std::mt19937 random(1000 * static_cast<unsigned>(kind) + static_cast<unsigned>(k));
      const int equalities = k % 3;
      const SmallQp qp = adversary(random, kind, 4 + k % 9, equalities);
      for (double tolerance : {1e-4, 1e-8})
        for (const char* name : {equalities > 0 ? "SMALBE" : "MPRGP", "PDAS"}) {
          const DistributedQp distributed(qp);
          const auto list = Teuchos::parameterList();
          list->set("Convergence Tolerance", tolerance);
          const auto solver = TpetraSolverFactory().create(name, list);
          solver->setProblem(distributed.problem);
          const Result result = solver->solve();
          ++runs;
          const std::string what = std::to_string(static_cast<int>(kind)) + " " + std::to_string(k) + " " +
                                   name + " " + std::to_string(tolerance);
          // What is out of reach is said to be.
          EXPECT_TRUE(result.converged() || result.reason == Reason::Stagnation ||
                      result.reason == Reason::IterationLimit)
              << what << ": " << result.explanation;
          if (!result.converged())
            continue;
          ++converged;
          expectWhatItClaims(qp, fromVector(*distributed.solution),
                             equalities > 0 ? fromVector(*distributed.multiplier) : std::vector<double>(),
                             tolerance, what);
        }
    }
    // A condition number of 1e12 leaves a tolerance of 1e-8 out of reach; all else mostly is not.
    EXPECT_GE(converged, runs / 4) << static_cast<int>(kind);
  }
}

} // namespace test_adversarial
