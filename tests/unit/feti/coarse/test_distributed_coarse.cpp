// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestFeti.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace test_distributed_coarse {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

using Inverse = CoarseOptions::Inverse;

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

double distance(const MultiVector& a, const MultiVector& b) {
  MultiVector difference(a, Teuchos::Copy);
  difference.update(-1.0, b, 1.0);
  return norm(difference);
}

MultiVector randomVector(const Constraints& constraints) {
  MultiVector v(constraints.rowMap(), 1);
  qp::BoundOps<Scalar, MultiVector>::setRandom(v);
  return v;
}

// Without every third row.
MultiVector someRows(const Constraints& constraints) {
  MultiVector mask(constraints.rowMap(), 1);
  const auto view = mask.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) = constraints.rowMap()->getGlobalElement(static_cast<LocalOrdinal>(r)) % 3 == 0 ? 0.0 : 1.0;
  return mask;
}

// Gᵀ(G_FG_Fᵀ)⁻Gv, by the equality rows.
MultiVector onFace(const CoarseSpace& coarse, const MultiVector& mask, const MultiVector& v) {
  const Teuchos::RCP<const Operator> rows = coarse.equalityRows();
  MultiVector w(rows->getRangeMap(), 1), result(v.getMap(), 1);
  rows->apply(v, w);
  coarse.faceGram()->build(mask)->solve(w);
  rows->apply(w, result, Teuchos::TRANS);
  return result;
}

void forAllForms(const std::function<void(const CoarseOptions&)>& check) {
  for (Inverse inverse : {Inverse::Rows, Inverse::Solves, Inverse::Auto})
    for (int group : {0, 1, 3}) {
      CoarseOptions options;
      options.inverse = inverse;
      options.groupRanks = group;
      check(options);
    }
}

TestModel floating(TestModel model) {
  for (Subdomain& subdomain : model.subdomains)
    subdomain.fixed.clear();
  return model;
}

} // namespace

// The same coarse space in shares: projector, least-norm solutions, faces, and ‖Gλ‖ as the norm of equality
// rows; for held and for floating bodies, where a row of G is left out.
TEST(DistributedCoarse, is_the_replicated_one) {
  for (const TestModel& model : {testModel(4, 2), floating(testModel(3, 3, true))}) {
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows);
    const ReplicatedCoarse whole(system, constraints);
    const MultiVector v = randomVector(constraints), mask = someRows(constraints);
    MultiVector projected(v, Teuchos::Copy);
    whole.project(projected);
    const MultiVector face = onFace(whole, mask, v);
    const std::vector<double> e = whole.multiply(v);
    MultiVector particular(constraints.rowMap(), 1);
    whole.addTransposed(1.0, whole.solve(e), particular);
    MultiVector masked(v.getMap(), 1);
    masked.elementWiseMultiply(1.0, *mask.getVector(0), v, 0.0);
    const std::vector<double> r = whole.multiply(masked);
    const std::vector<double> least = whole.minimumNormSolution(mask, r);
    const double size = norm(v);
    // κ of these matrices is some hundred; a face's some ten thousand.
    forAllForms([&](const CoarseOptions& options) {
      const DistributedCoarse coarse(system, constraints, options);
      EXPECT_EQ(coarse.dimension(), whole.dimension());
      EXPECT_EQ(coarse.kernelDimension(), whole.kernelDimension());
      EXPECT_LT(coarse.inaccuracy(), 1e-12);
      // A pivot that comes last is no larger than the least of the other order, and seldom much smaller.
      EXPECT_GT(coarse.smallestPivotRatio(), 0.03 * whole.smallestPivotRatio());
      EXPECT_LT(coarse.smallestPivotRatio(), 30.0 * whole.smallestPivotRatio());
      double dependent = 0.0;
      for (char is : coarse.dependentMotions())
        dependent += is;
      EXPECT_EQ(globalSum(*testComm(), dependent), whole.kernelDimension() - whole.dimension());
      MultiVector x(v, Teuchos::Copy);
      coarse.project(x);
      EXPECT_LT(distance(x, projected), 1e-12 * size);
      x.putScalar(0.0);
      coarse.addTransposed(1.0, coarse.solve(e), x);
      EXPECT_LT(distance(x, particular), 1e-12 * size);
      EXPECT_LT(distance(onFace(coarse, mask, v), face), 1e-9 * norm(face));
      MultiVector w(coarse.equalityRows()->getRangeMap(), 1), g(whole.coarseMap(), 1);
      coarse.equalityRows()->apply(v, w);
      whole.equalityRows()->apply(v, g);
      EXPECT_NEAR(norm(w), norm(g), 1e-12 * size);
      std::vector<double> another = coarse.minimumNormSolution(mask, r);
      for (std::size_t k = 0; k < another.size(); ++k)
        another[k] -= least[k];
      EXPECT_LT(coarse.norm(another), 1e-9 * whole.norm(least));
    });
  }
}

// What a face takes from a vector is found from the vector itself as by its product with the rows; sums of
// the ranks come with it.
TEST(DistributedCoarse, solves_for_vectors_and_sums_along) {
  for (const TestModel& model : {testModel(4, 2), floating(testModel(3, 3, true))}) {
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows);
    const MultiVector mask = someRows(constraints);
    MultiVector v = randomVector(constraints);
    v.elementWiseMultiply(1.0, *mask.getVector(0), v, 0.0); // there is an answer
    const int ranks = testComm()->getSize(), rank = testComm()->getRank();
    const auto check = [&](const CoarseSpace& coarse) {
      const Teuchos::RCP<const Operator> rows = coarse.equalityRows();
      const auto maker = coarse.faceGram();
      for (bool isWhole : {true, false}) {
        const auto gram = isWhole ? maker->whole() : maker->build(mask);
        MultiVector expected(rows->getRangeMap(), 1), found(rows->getRangeMap(), 1), a(v.getMap(), 1),
            b(v.getMap(), 1);
        rows->apply(v, expected);
        if (!isWhole)
          gram->solve(expected);
        std::vector<double> sums = {1.0, 1.0 + rank};
        ASSERT_TRUE(gram->solveFor(v, found, sums));
        EXPECT_EQ(sums, (std::vector<double>{1.0 * ranks, 0.5 * ranks * (ranks + 1)}));
        rows->apply(expected, a, Teuchos::TRANS);
        rows->apply(found, b, Teuchos::TRANS);
        EXPECT_LT(distance(a, b), 1e-9 * norm(a));
      }
    };
    check(ReplicatedCoarse(system, constraints));
    forAllForms(
        [&](const CoarseOptions& options) { check(DistributedCoarse(system, constraints, options)); });
  }
}

// The solvers of the dual problem see no difference.
TEST(DistributedCoarse, solves_the_dual_problem) {
  const TestFeti feti(testModel(3, 3));
  const TestDualSolution expected = solveDual(feti.dual, feti.coarse, 1e-11);
  ASSERT_TRUE(expected.result.converged());
  forAllForms([&](const CoarseOptions& options) {
    const DistributedCoarse coarse(feti.system, feti.constraints, options);
    const DualProblem dual(feti.system, feti.constraints, feti.inverses, feti.dualOperator, coarse);
    const TestDualSolution found = solveDual(dual, coarse, 1e-11);
    ASSERT_TRUE(found.result.converged());
    EXPECT_NEAR(found.result.counters.hessianApplications, expected.result.counters.hessianApplications, 1);
    EXPECT_LT(distance(*found.lambda, *expected.lambda), 1e-9 * norm(*expected.lambda));
    const TornSolution torn =
        recover(feti.system, feti.constraints, feti.inverses, coarse, dual, *found.lambda, found.mu);
    const KktAudit result = audit(feti.system, feti.constraints, torn);
    EXPECT_LT(result.equilibrium, 1e-9);
    EXPECT_LT(result.gluingJump, 1e-9);
  });
}

// Where a load cannot be held the same subdomain is named.
TEST(DistributedCoarse, names_what_cannot_be_held) {
  const TestModel model = floating(testModel(2, 2, true));
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  const LocalInverses inverses = makeLocalInverses(system, constraints);
  const DualOperator dualOperator(constraints, inverses);
  forAllForms([&](const CoarseOptions& options) {
    const DistributedCoarse coarse(system, constraints, options);
    try {
      const DualProblem dual(system, constraints, inverses, dualOperator, coarse);
      ADD_FAILURE() << "a load that nothing balances was taken";
    } catch (const NumericalError& error) {
      EXPECT_NE(std::string(error.what()).find("unbalanced load"), std::string::npos) << error.what();
    }
  });
}

} // namespace test_distributed_coarse
