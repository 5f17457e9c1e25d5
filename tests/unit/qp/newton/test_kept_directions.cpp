// SPDX-License-Identifier: BSD-3-Clause

/// Directions of outlying eigenvalues that one face has found spare them to all the others.

#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_KeptDirections.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_kept_directions {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using Rows = EqualityRows<Scalar, MultiVector, Operator>;
using Kept = KeptDirections<Scalar, MultiVector, Operator>;
using OPT = Belos::OperatorTraits<Scalar, MultiVector, Operator>;

constexpr int n = 120, bounded = 40, outliers = 12;

// Eigenvalues between 1 and 10 but for a dozen from 1e3 to 1e6, whose vectors mix all entries, those with
// bounds a little.
SmallQp softParts(std::mt19937& random, int equalities) {
  SmallQp qp = randomQp(random, n, equalities, false, 10.0);
  std::normal_distribution<double> normal;
  for (int k = 0; k < outliers; ++k) {
    std::vector<double> v(n);
    for (int i = 0; i < n; ++i)
      v[static_cast<std::size_t>(i)] = (i < bounded ? 0.05 : 1.0) * normal(random);
    const double length = norm(v), size = std::pow(10.0, 3.0 + 3.0 * k / (outliers - 1.0));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        qp.a(i, j) +=
            size * v[static_cast<std::size_t>(i)] * v[static_cast<std::size_t>(j)] / (length * length);
  }
  qp.lower.assign(n, -infinity);
  std::fill_n(qp.lower.begin(), bounded, 0.0);
  if (equalities > 0) {
    orthonormalizeRows(qp);
    // Met by what is not negative.
    qp.cRhs = product(qp.c, std::vector<double>(n, 0.1));
  }
  return qp;
}

struct Solved {
  Result result;
  std::vector<double> x;
};

Solved solved(const SmallQp& qp, int kept, double tolerance) {
  const DistributedQp distributed(qp);
  Dense identity(n, n);
  for (int i = 0; i < n; ++i)
    identity(i, i) = 1.0;
  distributed.precondition(identity);
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->sublist("Expert").sublist("PDAS").set("Kept directions", kept);
  const auto solver = TpetraSolverFactory().create("PDAS", list);
  solver->setProblem(distributed.problem);
  Solved outcome{solver->solve(), fromVector(*distributed.solution)};
  EXPECT_TRUE(outcome.result.converged()) << outcome.result.explanation;
  return outcome;
}

} // namespace

// Minimised along, whatever the face: the gradient carried along is that of the new point, which meets the
// rows as the old one did, and is at its bounds.
TEST(KeptDirections, are_valid_on_every_face) {
  std::mt19937 random(21);
  for (int equalities : {0, 3}) {
    const SmallQp qp = softParts(random, equalities);
    const DistributedQp distributed(qp);
    ASSERT_TRUE(distributed.problem->setProblem());
    const Rows rows(*distributed.problem, 100);
    Kept kept(*distributed.problem, rows);
    MultiVector columns(distributed.map, 5);
    columns.randomize();
    Counters counters;
    kept.add(columns, counters);
    kept.add(columns, counters); // nothing new
    EXPECT_EQ(kept.size(), 5);
    EXPECT_EQ(counters.hessianApplications, 5);

    MultiVector x(distributed.map, 1), g(distributed.map, 1), fresh(distributed.map, 1);
    x.randomize();
    const MultiVector before(x, Teuchos::Copy);
    const auto gradient = [&](MultiVector& y) {
      OPT::Apply(*distributed.problem->hessian(), x, y);
      y.update(-1.0, *distributed.problem->rhs(), 1.0);
    };
    gradient(g);
    kept.minimise(x, g);
    gradient(fresh);
    const double rounding = 1e-12 * 1e6 * std::sqrt(static_cast<double>(n)); // of ‖A‖‖x‖
    EXPECT_LE(distance(fromVector(g), fromVector(fresh)), rounding);
    const std::vector<double> moved = fromVector(x), start = fromVector(before);
    EXPECT_GT(distance(moved, start), 1e-3);
    for (std::size_t i = 0; i < bounded; ++i)
      EXPECT_EQ(moved[i], start[i]) << i;
    if (equalities > 0)
      EXPECT_LE(distance(product(qp.c, moved), product(qp.c, start)), 1e-9);
    // The minimum: minimised again, it stays; and directions made conjugate once are so.
    kept.minimise(x, g);
    EXPECT_LE(distance(fromVector(x), moved), 1e-8);
    MultiVector p(distributed.map, 1);
    p.randomize();
    kept.conjugate(p);
    const std::vector<double> once = fromVector(p);
    kept.conjugate(p);
    EXPECT_LE(distance(fromVector(p), once), 1e-8 * norm(once));
  }
}

TEST(KeptDirections, spare_products_and_change_no_answer) {
  std::mt19937 random(22);
  constexpr double tolerance = 1e-8;
  for (int equalities : {0, 3}) {
    int with = 0, without = 0;
    for (int k = 0; k < 5; ++k) {
      const SmallQp qp = softParts(random, equalities);
      const Solved kept = solved(qp, 60, tolerance), plain = solved(qp, 0, tolerance);
      with += kept.result.counters.hessianApplications;
      without += plain.result.counters.hessianApplications;
      EXPECT_EQ(kept.result.counters.safeguards, 0);
      // λ_min = 1 on the feasible set: ‖x − x*‖ ≤ ‖g^P‖ for each of the two; equalities to ten tolerances of
      // ‖A‖ beside.
      const double allowed = (2.0 + (equalities > 0 ? 1e6 * 10.0 * tolerance : 0.0)) * 10.0 * tolerance;
      EXPECT_LE(distance(kept.x, plain.x), allowed * norm(qp.b)) << equalities << " " << k;
    }
    // 1.5 and 4.7 times were measured.
    EXPECT_LE(1.3 * with, without) << equalities;
  }
}

} // namespace test_kept_directions
