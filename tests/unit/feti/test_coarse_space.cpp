// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestFeti.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
    const CoarseSpace& coarse = feti.coarse;
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
    qp::BoundTraits<Scalar, MultiVector>::setRandom(v);
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
    const CoarseSpace coarse(system, constraints);
    EXPECT_EQ(coarse.kernelDimension(), 8);
    EXPECT_EQ(coarse.dimension(), 7);
    EXPECT_EQ(coarse.dependentColumns().size(), 1u);
    const LocalInverses inverses = makeImplicitInverses(system);
    const DualOperator dualOperator(system, constraints, inverses);
    EXPECT_THROW(DualProblem(system, constraints, inverses, dualOperator, coarse), NumericalError);
  }
  // Loads −1 and +1 on the first dof of the first and the last subdomain.
  for (Subdomain& subdomain : model.subdomains) {
    std::fill(subdomain.load.begin(), subdomain.load.end(), 0.0);
    if (subdomain.number == 0)
      subdomain.load[0] = -1.0;
    if (subdomain.number == 7)
      subdomain.load[0] = 1.0;
  }
  const TestFeti feti(model);
  const TestDualSolution solution = solveDual(feti.dual, feti.coarse, 1e-11);
  ASSERT_TRUE(solution.result.converged());
  const TornSolution torn = recover(feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dual,
                                    *solution.lambda, solution.mu);
  const KktAudit result = audit(feti.system, feti.constraints, torn);
  EXPECT_LT(result.equilibrium, 1e-9);
  EXPECT_LT(result.gluingJump, 1e-9);
}
