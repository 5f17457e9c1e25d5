// SPDX-License-Identifier: BSD-3-Clause

/// The estimate of how wrong the forces of given rows are, against how wrong they are.

#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_ForceErrors.hpp"
#include "Harmos_RowErrors.hpp"
#include "Harmos_TestFeti.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_force_errors {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

struct Estimate {
  std::vector<ForceError> errors;
  std::vector<double> forces; // of the given rows of this rank
  RowForces rows;
};

struct Estimator {
  const TestFeti& feti;
  DualPreconditioner preconditioner;
  explicit Estimator(const TestFeti& f)
      : feti(f),
        preconditioner(f.system, f.constraints, f.inverses, PreconditionerKind::Dirichlet,
                       PreconditionerScaling::Multiplicity) {}

  TornSolution solution(double tolerance) const {
    const TestDualSolution dual = solveDual(feti.dual, feti.coarse, tolerance);
    EXPECT_TRUE(dual.result.converged()) << dual.result.explanation;
    return recover(feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dual, *dual.lambda,
                   dual.mu);
  }

  // @param factor of M⁻¹r. @param group of all rows.
  Estimate of(const TornSolution& torn, double factor = 1.0, int group = 0, double area = 0.0,
              const RowForces* before = nullptr) const {
    MultiVector jumps(feti.constraints.rowMap(), 1), correction(feti.constraints.rowMap(), 1);
    feti.constraints.residual(torn.displacement, *torn.multiplier, jumps);
    keepErrors(feti.constraints, *torn.multiplier, jumps);
    preconditioner.apply(jumps, correction);
    correction.scale(factor);
    Estimate result;
    result.forces = feti.constraints.givenMultipliers(*torn.multiplier);
    result.rows = rowForces(feti.constraints, *torn.multiplier, jumps, correction);
    result.errors = forceErrors(
        feti.constraints, result.rows, before,
        {std::vector<int>(result.forces.size(), group), 2, std::vector<double>(result.forces.size(), area)});
    return result;
  }
};

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(globalSum(*testComm(), sum));
}

} // namespace

// The estimate takes the preconditioner for the inverse, and eigenvalues of their product lie between 1 and
// some ten: it is asked to be right to that factor, either way. On these it is between 0.23 and 8 times the
// error.
TEST(ForceErrors, are_about_as_large_as_estimated) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
    for (int elements : {4, 8}) {
      const TestFeti feti(testModel(3, elements), form);
      const Estimator estimator(feti);
      const Estimate exact = estimator.of(estimator.solution(1e-12));
      const double size = difference(exact.forces, std::vector<double>(exact.forces.size(), 0.0));
      EXPECT_NEAR(exact.errors[0].force, size, 1e-12 * size);
      EXPECT_LT(exact.errors[0].relative(), 1e-9);
      for (double tolerance : {1e-2, 1e-4, 1e-6}) {
        const Estimate loose = estimator.of(estimator.solution(tolerance));
        const double wrong = difference(loose.forces, exact.forces);
        EXPECT_GT(loose.errors[0].error, 0.1 * wrong) << elements << " " << tolerance;
        EXPECT_LT(loose.errors[0].error, 10.0 * wrong) << elements << " " << tolerance;
        EXPECT_EQ(loose.errors[1].force, 0.0); // of no row
        EXPECT_EQ(loose.errors[1].error, 0.0);
      }
    }
}

TEST(ForceErrors, contacts_lose_no_more_than_they_have) {
  const TestFeti feti(testModel(2, 4), DirichletForm::Primal);
  const Estimator estimator(feti);
  const TornSolution torn = estimator.solution(1e-4);
  // One way or the other each row is asked for more than it has.
  const ForceError lost = estimator.of(torn, 1e6).errors[0], gained = estimator.of(torn, -1e6).errors[0];
  EXPECT_GT(std::max(lost.error, gained.error), lost.force);
  const ForceError plain = estimator.of(torn).errors[0];
  EXPECT_LT(std::min(lost.error, gained.error), 0.9e6 * plain.error);
}

// Of rows with an area, in another norm.
TEST(ForceErrors, tractions_are_looked_at_by_themselves) {
  const TestFeti feti(testModel(2, 4), DirichletForm::Primal);
  const Estimator estimator(feti);
  const TornSolution torn = estimator.solution(1e-3);
  const ForceError none = estimator.of(torn).errors[0];
  EXPECT_EQ(none.traction, 0.0);
  EXPECT_EQ(none.tractionError, 0.0);
  EXPECT_EQ(none.relativeTraction(), 0.0);
  const double area = 0.25;
  const Estimate estimate = estimator.of(torn, 1.0, 0, area);
  double largest = 0.0;
  for (const double force : estimate.forces)
    largest = std::max(largest, std::abs(force));
  const ForceError& error = estimate.errors[0];
  EXPECT_DOUBLE_EQ(error.traction, globalMax(*testComm(), largest) / area);
  EXPECT_DOUBLE_EQ(error.smallestArea, area);
  EXPECT_EQ(error.error, none.error);
  // The largest of n numbers against their Euclidean norm.
  const double rows = globalSum(*testComm(), static_cast<double>(estimate.forces.size()));
  EXPECT_LE(error.tractionError * area, error.error);
  EXPECT_GE(error.tractionError * area * std::sqrt(rows), error.error);
}

// An estimate that was too small for the way that tractions have gone since is raised by as much, up to ten
// times.
TEST(ForceErrors, an_answer_before_measures_the_estimate) {
  const TestFeti feti(testModel(2, 4), DirichletForm::Primal);
  const Estimator estimator(feti);
  const TornSolution loose = estimator.solution(1e-2), better = estimator.solution(1e-4);
  const double area = 0.25;
  for (double factor : {0.01, 1e3}) {
    const Estimate before = estimator.of(loose, factor, 0, area);
    const ForceError plain = estimator.of(better, factor, 0, area).errors[0],
                     measured = estimator.of(better, factor, 0, area, &before.rows).errors[0];
    EXPECT_EQ(measured.error, plain.error);
    EXPECT_EQ(measured.traction, plain.traction);
    if (factor > 1.0) {
      EXPECT_EQ(measured.tractionError, plain.tractionError);
    } else {
      EXPECT_GT(measured.tractionError, 3.0 * plain.tractionError);
      EXPECT_LE(measured.tractionError, 10.0 * plain.tractionError * (1.0 + 1e-15));
    }
  }
}

TEST(ForceErrors, rows_of_no_group_do_not_count) {
  const TestFeti feti(testModel(2, 4), DirichletForm::Primal);
  const Estimator estimator(feti);
  const TornSolution torn = estimator.solution(1e-4);
  for (const ForceError& error : estimator.of(torn, 1.0, -1).errors) {
    EXPECT_EQ(error.force, 0.0);
    EXPECT_EQ(error.relative(), 0.0);
  }
  EXPECT_TRUE(std::isinf((ForceError{0.0, 1.0}).relative()));
}

} // namespace test_force_errors
