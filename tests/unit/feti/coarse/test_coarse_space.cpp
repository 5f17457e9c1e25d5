// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_TestFeti.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_coarse_space {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

} // namespace

TEST(CoarseSpace, rows_of_G_are_orthonormal_and_P_is_a_projector) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const TestFeti feti(testModel(3, 2), form);
    const ReplicatedCoarse& coarse = feti.coarse;
    EXPECT_EQ(coarse.dimension(), feti.system.kernelDimension());
    // GGᵀ = I.
    for (int k = 0; k < coarse.dimension(); ++k) {
      std::vector<double> unit(static_cast<std::size_t>(coarse.dimension()), 0.0);
      unit[static_cast<std::size_t>(k)] = 1.0;
      MultiVector column(feti.constraints.rowMap(), 1);
      coarse.addGt(1.0, unit, column);
      const std::vector<double> image = coarse.applyG(column);
      for (std::size_t i = 0; i < image.size(); ++i)
        EXPECT_NEAR(image[i], unit[i], 1e-13);
    }
    // P² = P, GP = 0.
    MultiVector v(feti.constraints.rowMap(), 1);
    qp::BoundOps<Scalar, MultiVector>::setRandom(v);
    coarse.project(v);
    MultiVector again(v, Teuchos::Copy);
    coarse.project(again);
    again.update(-1.0, v, 1.0);
    EXPECT_LT(norm(again), 1e-13 * norm(v));
    for (double entry : coarse.applyG(v))
      EXPECT_NEAR(entry, 0.0, 1e-13 * norm(v));
  }
}

// G̃λ̃ = ẽ: the shift balances the loads of all rigid motions.
TEST(CoarseSpace, shift_balances_the_loads) {
  const TestFeti feti(testModel(2, 4));
  const std::vector<double> balanced = feti.coarse.applyUnscaled(*feti.dual.shift());
  std::vector<double> load(balanced.size(), 0.0);
  for (int i = 0; i < feti.system.size(); ++i)
    for (int k = 0; k < feti.system.kernel(i).columns; ++k)
      for (std::size_t j = 0; j < feti.system.rhs(i).size(); ++j)
        load[static_cast<std::size_t>(feti.system.kernelOffset(i) + k)] +=
            feti.system.kernel(i).column(k)[j] * feti.system.rhs(i)[j];
  globalSum(*testComm(), load);
  for (std::size_t k = 0; k < load.size(); ++k)
    EXPECT_NEAR(balanced[k], load[k], 1e-14);
}

// Nothing holds the two bodies together but a tie to each other: G̃ has one dependent row (both may move
// together). With loads in balance the coarse space works with the remaining rows; without balance the body
// is named.
TEST(CoarseSpace, rank_deficiency_is_found_and_judged_by_the_load) {
  TestModel model = testModel(2, 2, true);
  for (Subdomain& subdomain : model.subdomains)
    subdomain.fixed.clear();
  {
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows);
    const ReplicatedCoarse coarse(system, constraints);
    EXPECT_EQ(coarse.kernelDimension(), 8);
    EXPECT_EQ(coarse.dimension(), 7);
    EXPECT_EQ(coarse.dependentColumns().size(), 1u);
    const LocalInverses inverses = makeLocalInverses(system, constraints);
    const DualOperator dualOperator(constraints, inverses);
    EXPECT_THROW(DualProblem(system, constraints, inverses, dualOperator, coarse), NumericalError);
  }
  // Loads −1 and +1 on the first dof of the first and the last subdomain.
  for (Subdomain& subdomain : model.subdomains) {
    changeLoad(subdomain, [&](std::vector<double>& load) {
      std::fill(load.begin(), load.end(), 0.0);
      load[0] = subdomain.number == 0 ? -1.0 : (subdomain.number == 7 ? 1.0 : 0.0);
    });
  }
  const TestFeti feti(model);
  const TestDualSolution solution = solveDual(feti.dual, feti.coarse, 1e-11);
  ASSERT_TRUE(solution.result.converged());
  const TornSolution torn = recover(feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dual,
                                    *solution.lambda, solution.mu);
  const KktAudit result = audit(feti.system, feti.constraints, torn);
  EXPECT_LT(result.equilibrium, 1e-9);
  EXPECT_LT(result.gluingJump, 1e-9);
  // Loads that balance themselves within each subdomain, up to rounding: 0.1 + 0.2 − 0.3 is not zero.
  for (Subdomain& subdomain : model.subdomains) {
    changeLoad(subdomain, [](std::vector<double>& load) {
      std::fill(load.begin(), load.end(), 0.0);
      load[0] = 0.1;
      load[1] = 0.2;
      load[2] = -0.3;
    });
  }
  const TestFeti balanced(model);
  EXPECT_TRUE(solveDual(balanced.dual, balanced.coarse, 1e-11).result.converged());
}

// Dense and sparse factors give the same projector, and on faces the same solutions; GGᵀ = I in either form.
TEST(CoarseSpace, dense_and_sparse_factors_agree) {
  const TestFeti feti(testModel(4, 2));
  const ReplicatedCoarse dense(feti.system, feti.constraints, 1000), sparse(feti.system, feti.constraints, 0);
  ASSERT_TRUE(dense.factor().isDense());
  ASSERT_FALSE(sparse.factor().isDense());
  ASSERT_EQ(dense.dimension(), sparse.dimension());
  MultiVector a(feti.constraints.rowMap(), 1), b(feti.constraints.rowMap(), 1);
  qp::BoundOps<Scalar, MultiVector>::setRandom(a);
  b.assign(a);
  dense.project(a);
  sparse.project(b);
  const std::vector<double> first = fromVector(a), second = fromVector(b);
  for (std::size_t k = 0; k < first.size(); ++k)
    EXPECT_NEAR(first[k], second[k], 1e-13);

  // A face without the inequality rows of even number.
  MultiVector mask(feti.constraints.rowMap(), 1);
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < view.extent(0); ++r) {
      const auto row = static_cast<int>(r);
      const bool active = feti.constraints.rowType(row) == RowType::Inequality &&
                          feti.constraints.rowMap()->getGlobalElement(row) % 2 == 0;
      view(r, 0) = active ? 0.0 : 1.0;
    }
  }
  for (const ReplicatedCoarse* coarse : {&dense, &sparse}) {
    // G M Gᵀ x for x = solveOnFace(r) is r.
    std::vector<double> r(static_cast<std::size_t>(coarse->dimension()));
    for (std::size_t k = 0; k < r.size(); ++k)
      r[k] = std::sin(1.0 + static_cast<double>(k));
    const std::vector<double> x = coarse->solveOnFace(coarse->faceFactor(mask), r);
    MultiVector v(feti.constraints.rowMap(), 1);
    coarse->addGt(1.0, x, v);
    v.elementWiseMultiply(1.0, *mask.getVector(0), v, 0.0);
    const std::vector<double> image = coarse->applyG(v);
    for (std::size_t k = 0; k < r.size(); ++k)
      EXPECT_NEAR(image[k], r[k], 1e-11);
  }
}

// The least-norm solution of a singular coarse system: among all solutions the one orthogonal to the null
// vector, which moves both bodies together.
// A chain of stiff springs held by one that is softer by ten orders of magnitude: of what a matrix of doubles
// knows of its slowest motion six digits are lost, and with them GGᵀ = I. Of a long double's the root of its
// condition is left.
TEST(CoarseSpace, weak_support_of_what_is_stiff) {
  if (std::numeric_limits<long double>::digits <= std::numeric_limits<double>::digits)
    GTEST_SKIP() << "long double is no longer than double here";
  constexpr int n = 12;
  constexpr long double soft = 1e-10L;
  std::vector<int> rows, columns;
  std::vector<long double> values;
  for (int i = 0; i < n; ++i) {
    rows.push_back(i);
    columns.push_back(i);
    values.push_back((i == 0 ? soft : 1.0L) + (i + 1 < n ? 1.0L : 0.0L));
    if (i + 1 < n) {
      rows.push_back(i + 1);
      columns.push_back(i);
      values.push_back(-1.0L);
    }
  }
  std::vector<double> scale;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (rows[k] == columns[k])
      scale.push_back(std::sqrt(static_cast<double>(values[k])));
  // The largest entry of L⁻¹AL⁻ᵀ − I.
  const auto defect = [&](const feti::CoarseFactor& factor) {
    double largest = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> unit(n, 0.0);
      unit[k] = 1.0;
      const std::vector<double> w = factor.solveLt(unit);
      std::vector<long double> image(n, 0.0L);
      for (std::size_t e = 0; e < values.size(); ++e) {
        const auto i = static_cast<std::size_t>(rows[e]), j = static_cast<std::size_t>(columns[e]);
        image[i] += values[e] * w[j];
        if (i != j)
          image[j] += values[e] * w[i];
      }
      const std::vector<double> back = factor.solveL({image.begin(), image.end()});
      for (std::size_t i = 0; i < n; ++i)
        largest = std::max(largest, std::abs(back[i] - unit[i]));
    }
    return largest;
  };
  for (int mostDense : {n, 0}) {
    const feti::CoarseFactor exact(n, rows, columns, values, 0.0, mostDense, scale);
    ASSERT_EQ(exact.rank(), n);
    EXPECT_LE(defect(exact), 2e-8); // 100 ε√κ, κ = 4n / soft at most
    const feti::CoarseFactor rounded(n, rows, columns, std::vector<double>(values.begin(), values.end()), 0.0,
                                     mostDense, scale);
    EXPECT_GT(defect(rounded), 1e-6) << "the case does not show what it is about";
  }
}

TEST(CoarseSpace, minimum_norm_solution_of_a_singular_system) {
  TestModel model = testModel(2, 2, true);
  for (Subdomain& subdomain : model.subdomains)
    subdomain.fixed.clear();
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  for (int mostDense : {0, 1000}) {
    const ReplicatedCoarse coarse(system, constraints, mostDense);
    MultiVector ones(constraints.rowMap(), 1);
    ones.putScalar(1.0);
    // r = G̃G̃ᵀ e for e without a share in the null vector, whose entries are all equal for equal subdomains.
    const std::vector<double> all = {1, -2, 3, -4, 5, -6, 7, -4};
    std::vector<double> e;
    for (int column : coarse.ownColumns())
      e.push_back(all[static_cast<std::size_t>(column)]);
    MultiVector v(constraints.rowMap(), 1);
    coarse.addTransposed(1.0, e, v);
    const std::vector<double> x = coarse.minimumNormSolution(ones, coarse.multiply(v));
    for (std::size_t k = 0; k < e.size(); ++k)
      EXPECT_NEAR(x[k], e[k], 1e-12) << mostDense;
  }
}

} // namespace test_coarse_space
