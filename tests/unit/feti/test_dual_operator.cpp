// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestFeti.hpp"

#include "Harmos_Errors.hpp"

#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace test_dual_operator {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// The operator as a dense matrix, on every rank.
Dense toDense(const Operator& op) {
  const auto map = op.getDomainMap();
  const int n = static_cast<int>(map->getGlobalNumElements());
  Dense result(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0);
    unit[static_cast<std::size_t>(j)] = 1.0;
    MultiVector y(map, 1);
    op.apply(*toVector(unit, map), y);
    const std::vector<double> column = fromVector(y);
    for (int i = 0; i < n; ++i)
      result(i, j) = column[static_cast<std::size_t>(i)];
  }
  return result;
}

// A subdomain inverse that fails.
class Broken : public LocalInverse, public BoundaryOperator {
 public:
  explicit Broken(int size) : size_(size) {}
  void apply(double*, int) const override { throw NumericalError("pivot lost"); }
  const BoundaryOperator& boundaryOperator() const override { return *this; }
  std::shared_ptr<const BoundaryOperator> schurComplement() const override { return nullptr; }
  int size() const override { return size_; }
  void apply(const double*, double*, int) const override { throw NumericalError("pivot lost"); }
  double bytes() const override { return 0.0; }
  double bytesRead(int) const override { return 0.0; }
  double flops() const override { return 0.0; }
  void roundSchurComplement() override {}
  void refactor(const LocalMatrix&, const Kernel&) override { throw NumericalError("pivot lost"); }
  FactorizationCounts counts() const override { return {}; }

 private:
  int size_;
};

} // namespace

TEST(DualOperator, is_symmetric_and_projected_positive_semidefinite) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const TestFeti feti(testModel(2, 2), form);
    const Dense f = toDense(feti.dualOperator), pfp = toDense(*feti.dual.hessian());
    for (int i = 0; i < f.rows; ++i)
      for (int j = 0; j < i; ++j)
        EXPECT_NEAR(f(i, j), f(j, i), 1e-13);
    const std::vector<double> spectrum = eigenvalues(pfp);
    // PFP vanishes on the image of Gᵀ, of the coarse dimension, and is definite on the rest.
    const auto zeros = static_cast<std::size_t>(feti.coarse.dimension());
    EXPECT_NEAR(spectrum[zeros - 1], 0.0, 1e-13);
    EXPECT_GT(spectrum[zeros], 1e-2);
  }
}

// PFP and Pd do not depend on the generalised inverse, F and d do.
TEST(DualOperator, projected_forms_do_not_depend_on_the_generalised_inverse) {
  const TestModel model = testModel(2, 2);
  const TestFeti one(model, DirichletForm::Primal, implicitOptions(1)), many(model);
  const Dense a = toDense(*one.dual.hessian()), b = toDense(*many.dual.hessian());
  double difference = 0.0, rawDifference = 0.0;
  for (std::size_t k = 0; k < a.values.size(); ++k)
    difference = std::max(difference, std::abs(a.values[k] - b.values[k]));
  const Dense rawA = toDense(one.dualOperator), rawB = toDense(many.dualOperator);
  for (std::size_t k = 0; k < rawA.values.size(); ++k)
    rawDifference = std::max(rawDifference, std::abs(rawA.values[k] - rawB.values[k]));
  EXPECT_LT(difference, 1e-12);
  EXPECT_GT(rawDifference, 1e-2); // the test would be empty if the inverses were the same
  const std::vector<double> pd = fromVector(*one.dual.rhs()), other = fromVector(*many.dual.rhs());
  for (std::size_t k = 0; k < pd.size(); ++k)
    EXPECT_NEAR(pd[k], other[k], 1e-12);
}

// The two forms, with and without sharing, in single precision: PFP is the same, to rounding or to what
// single precision loses.
TEST(DualOperator, forms_and_sharing_agree) {
  const TestModel model = testModel(3, 3);
  LocalInverseOptions options;
  const TestFeti reference(model, DirichletForm::Primal, options);
  const Dense expected = toDense(*reference.dual.hessian());
  for (DualForm form : {DualForm::Condensed, DualForm::Implicit})
    for (bool share : {true, false})
      for (Precision precision : {Precision::Double, Precision::Single}) {
        options.form = form;
        options.share = share;
        options.precision = precision;
        const TestFeti feti(model, DirichletForm::Primal, options);
        const Dense pfp = toDense(*feti.dual.hessian());
        double difference = 0.0;
        for (std::size_t k = 0; k < pfp.values.size(); ++k)
          difference = std::max(difference, std::abs(pfp.values[k] - expected.values[k]));
        EXPECT_LT(difference, precision == Precision::Double ? 1e-12 : 1e-5)
            << (form == DualForm::Condensed) << share;
      }
}

TEST(DualOperator, several_columns_scaling_and_accumulation) {
  const TestFeti feti(testModel(2, 2));
  const auto map = feti.constraints.rowMap();
  MultiVector x(map, 2), y(map, 2), single(map, 1), image(map, 1);
  x.getVectorNonConst(0)->putScalar(1.0);
  x.getVectorNonConst(1)->putScalar(-3.0);
  y.putScalar(0.5);
  feti.dualOperator.apply(x, y, Teuchos::NO_TRANS, 2.0, 4.0);
  single.putScalar(1.0);
  feti.dualOperator.apply(single, image);
  const std::vector<double> f = fromVector(image);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < view.extent(0); ++i) {
    const auto global = static_cast<std::size_t>(map->getGlobalElement(static_cast<LocalOrdinal>(i)));
    EXPECT_NEAR(view(i, 0), 2.0 * f[global] + 2.0, 1e-12);
    EXPECT_NEAR(view(i, 1), -6.0 * f[global] + 2.0, 1e-12);
  }
}

// A local solve that fails on one rank must neither hang the others nor pass unseen: NaN everywhere after a
// norm, then an agreed error.
TEST(DualOperator, local_failure_reaches_all_ranks) {
  const TestModel model = testModel(2, 2);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  // One rank of several fails, the one with the highest number.
  const bool fails = testComm()->getRank() == testComm()->getSize() - 1;
  const LocalInverses good = makeLocalInverses(system, constraints);
  std::vector<std::unique_ptr<LocalInverse>> broken;
  const std::vector<CongruenceClass> classes = congruenceClasses(system, constraints, true, 4);
  for (const CongruenceClass& item : classes)
    broken.push_back(std::make_unique<Broken>(static_cast<int>(item.boundary.size())));
  const LocalInverses bad(classes, std::move(broken));
  const DualOperator dualOperator(constraints, fails ? bad : good);
  MultiVector x(constraints.rowMap(), 1), y(constraints.rowMap(), 1);
  x.putScalar(1.0);
  dualOperator.apply(x, y);
  std::vector<double> norm(1);
  y.norm2(Teuchos::arrayViewFromVector(norm));
  EXPECT_TRUE(std::isnan(norm[0]));
  EXPECT_THROW(dualOperator.rethrowFailure(), NumericalError);
}

} // namespace test_dual_operator
