// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestFeti.hpp"

#include <Tpetra_Import.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_dual_preconditioner {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// The model with a material that jumps from subdomain to subdomain.
TestModel jumping(int s, int n, double factor) {
  TestModel model = testModel(s, n);
  for (Subdomain& subdomain : model.subdomains) {
    auto stiffness = std::make_shared<LocalMatrix>(*subdomain.stiffness);
    for (double& value : stiffness->values)
      value *= subdomain.number % 3 == 1 ? factor : 1.0;
    subdomain.stiffness = stiffness;
  }
  return model;
}

LocalInverseOptions withSchur() {
  LocalInverseOptions options;
  options.keepSchur = true;
  return options;
}

// y = B D⁻¹ B_Dᵀ x or y = B_D Bᵀ x with the entries of both, over all ranks.
std::vector<double> multiply(const TestFeti& feti, const ScaledConstraints& scaled,
                             const std::vector<double>& x) {
  MultiVector y(feti.constraints.rowMap(), 1);
  const Teuchos::RCP<MultiVector> in = toVector(x, feti.constraints.rowMap());
  const std::vector<double> overlap = feti.constraints.toOverlap(*in);
  MultiVector out(scaled.importer->getTargetMap(), 1);
  {
    const auto view = out.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (int i = 0; i < feti.system.size(); ++i) {
      std::vector<double> t(static_cast<std::size_t>(feti.system.matrix(i).rows()), 0.0);
      feti.constraints.addBt(i, overlap.data(), t.data());
      for (const Constraints::Entry& entry : scaled.entries[static_cast<std::size_t>(i)])
        view(static_cast<std::size_t>(entry.row), 0) += entry.value * t[static_cast<std::size_t>(entry.dof)];
    }
  }
  y.doExport(out, *scaled.importer, Tpetra::ADD);
  return fromVector(y);
}

// Largest over smallest eigenvalue of PM⁻¹P·PFP on the range of P, by the dense LᵀPM⁻¹PL, LLᵀ = PFP +
// trace·Q.
double conditionOf(const TestFeti& feti, const Operator* preconditioner) {
  const auto map = feti.constraints.rowMap();
  const int n = static_cast<int>(map->getGlobalNumElements());
  Dense f(n, n), m(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0);
    unit[static_cast<std::size_t>(j)] = 1.0;
    MultiVector y(map, 1);
    const auto e = toVector(unit, map);
    feti.dual.hessian()->apply(*e, y);
    const std::vector<double> column = fromVector(y);
    feti.coarse.project(*e);
    MultiVector z(map, 1);
    if (preconditioner != nullptr)
      preconditioner->apply(*e, z);
    else
      z.assign(*e);
    feti.coarse.project(z);
    const std::vector<double> other = fromVector(z);
    for (int i = 0; i < n; ++i) {
      f(i, j) = column[static_cast<std::size_t>(i)];
      m(i, j) = other[static_cast<std::size_t>(i)];
    }
  }
  Dense shifted = f;
  double trace = 0.0;
  for (int i = 0; i < n; ++i)
    trace += f(i, i) / n;
  for (int j = 0; j < n; ++j) { // + trace · Q
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0);
    unit[static_cast<std::size_t>(j)] = 1.0;
    const auto e = toVector(unit, map);
    feti.coarse.project(*e);
    const std::vector<double> p = fromVector(*e);
    for (int i = 0; i < n; ++i)
      shifted(i, j) += trace * ((i == j ? 1.0 : 0.0) - p[static_cast<std::size_t>(i)]);
  }
  // L of the shifted matrix.
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < k; ++j)
      shifted(k, k) -= shifted(k, j) * shifted(k, j);
    shifted(k, k) = std::sqrt(shifted(k, k));
    for (int i = k + 1; i < n; ++i) {
      for (int j = 0; j < k; ++j)
        shifted(i, k) -= shifted(i, j) * shifted(k, j);
      shifted(i, k) /= shifted(k, k);
    }
  }
  Dense image(n, n), lml(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = j; k < n; ++k)
        image(i, j) += m(i, k) * shifted(k, j);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = i; k < n; ++k)
        lml(i, j) += shifted(k, i) * image(k, j);
  const std::vector<double> spectrum = eigenvalues(lml);
  return spectrum.back() / spectrum[static_cast<std::size_t>(feti.coarse.dimension())];
}

} // namespace

// B_D Bᵀ = I whatever the scaling: (BD⁻¹Bᵀ)⁻¹ BD⁻¹Bᵀ.
TEST(DualPreconditioner, scaled_rows_are_a_left_inverse) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
    for (PreconditionerScaling scaling :
         {PreconditionerScaling::Multiplicity, PreconditionerScaling::Stiffness}) {
      const TestFeti feti(jumping(3, 2, 1e4), form, withSchur());
      const ScaledConstraints scaled = scaledConstraints(feti.system, feti.constraints, scaling);
      std::vector<double> x;
      for (long long k = 0; k < feti.constraints.dualDimension(); ++k)
        x.push_back(std::sin(1.0 + 0.37 * static_cast<double>(k)));
      const std::vector<double> y = multiply(feti, scaled, x);
      for (std::size_t k = 0; k < x.size(); ++k)
        EXPECT_NEAR(y[k], x[k], 1e-12);
    }
}

// Rows that depend on others, as those of a held edge in contact with a coarser surface, are seen by M all
// the same: the residual of rows that it maps to zero would never fall.
TEST(DualPreconditioner, rows_that_depend_on_others_are_seen) {
  for (PreconditionerScaling scaling :
       {PreconditionerScaling::Multiplicity, PreconditionerScaling::Stiffness}) {
    TestModel model = testModel(2, 3);
    const std::vector<ConstraintRow> once = model.rows; // of this rank
    const long long numbers = globalSum(*testComm(), static_cast<long long>(once.size()));
    ASSERT_GT(numbers, 0);
    for (ConstraintRow row : once) {
      row.number += numbers;
      model.rows.push_back(row);
    }
    const TestFeti feti(model, DirichletForm::Primal, withSchur());
    const DualPreconditioner preconditioner(feti.system, feti.constraints, feti.inverses,
                                            PreconditionerKind::Dirichlet, scaling);
    const auto map = feti.constraints.rowMap();
    for (std::size_t k = 0; k < map->getGlobalNumElements(); ++k) {
      std::vector<double> unit(map->getGlobalNumElements(), 0.0);
      unit[k] = 1.0;
      MultiVector image(map, 1);
      preconditioner.apply(*toVector(unit, map), image);
      EXPECT_GT(fromVector(image)[k], 0.0) << "row " << k;
    }
  }
}

// Stiffness scaling gives a jump to the softer side: with a factor φ between two subdomains, the stiff copy
// takes 1/(1 + φ) of it.
TEST(DualPreconditioner, stiffness_scaling_moves_the_softer_copy) {
  const double factor = 1e4;
  const TestFeti feti(jumping(2, 4, factor), DirichletForm::Dual, withSchur());
  const ScaledConstraints scaled =
      scaledConstraints(feti.system, feti.constraints, PreconditionerScaling::Stiffness);
  long long checked = 0;
  for (int i = 0; i < feti.system.size(); ++i) {
    std::map<int, int> rowsAt; // gluing of two copies: one row at each
    for (const Constraints::Entry& entry : feti.constraints.entries(i))
      ++rowsAt[entry.dof];
    const bool stiff = feti.system.subdomain(i).number % 3 == 1;
    for (const Constraints::Entry& entry : scaled.entries[static_cast<std::size_t>(i)]) {
      const auto copies = std::abs(entry.value) * std::sqrt(0.5);
      if (rowsAt[entry.dof] != 1 || !stiff || std::abs(copies - 1.0 / (1.0 + factor)) > 0.1)
        continue;
      EXPECT_NEAR(copies, 1.0 / (1.0 + factor), 1e-10);
      ++checked;
    }
  }
  EXPECT_GT(globalSum(*testComm(), checked), 10);
}

// What it is for: condition numbers on the range of P. Dirichlet beats lumped beats none; with a jump of 1e4
// in the material stiffness scaling beats multiplicity.
TEST(DualPreconditioner, condition_numbers) {
  const TestFeti plain(testModel(2, 6), DirichletForm::Primal, withSchur());
  const auto make = [](const TestFeti& feti, PreconditionerKind kind, PreconditionerScaling scaling) {
    return DualPreconditioner(feti.system, feti.constraints, feti.inverses, kind, scaling);
  };
  const double none = conditionOf(plain, nullptr);
  const auto lumpedOperator = make(plain, PreconditionerKind::Lumped, PreconditionerScaling::Multiplicity);
  const auto dirichletOperator =
      make(plain, PreconditionerKind::Dirichlet, PreconditionerScaling::Multiplicity);
  const double lumped = conditionOf(plain, &lumpedOperator),
               dirichlet = conditionOf(plain, &dirichletOperator);
  EXPECT_LT(dirichlet, 0.5 * lumped);
  EXPECT_LT(dirichlet, 0.5 * none);
  EXPECT_LT(dirichlet, 6.0);

  const TestFeti jump(jumping(2, 4, 1e4), DirichletForm::Primal, withSchur());
  const auto byStiffness = make(jump, PreconditionerKind::Dirichlet, PreconditionerScaling::Stiffness);
  const auto byMultiplicity = make(jump, PreconditionerKind::Dirichlet, PreconditionerScaling::Multiplicity);
  // The orthogonal projector keeps a few large eigenvalues whatever the scaling: only one that weighs rows by
  // stiffness would not (Klawonn, Widlund, with Q = M⁻¹). What the scaling gains is a factor of three.
  const double withJump = conditionOf(jump, nullptr), stiffness = conditionOf(jump, &byStiffness);
  EXPECT_LT(stiffness, 0.1 * withJump);
  EXPECT_LT(stiffness, 0.5 * conditionOf(jump, &byMultiplicity));
}

// The implicit form's S, by solves, is the same preconditioner.
TEST(DualPreconditioner, both_forms_give_the_same) {
  const TestModel model = testModel(2, 3);
  const TestFeti condensed(model, DirichletForm::Primal, withSchur()),
      implicit(model, DirichletForm::Primal, implicitOptions());
  for (PreconditionerKind kind : {PreconditionerKind::Lumped, PreconditionerKind::Dirichlet}) {
    const DualPreconditioner a(condensed.system, condensed.constraints, condensed.inverses, kind,
                               PreconditionerScaling::Multiplicity);
    const DualPreconditioner b(implicit.system, implicit.constraints, implicit.inverses, kind,
                               PreconditionerScaling::Multiplicity);
    MultiVector x(condensed.constraints.rowMap(), 1), y(condensed.constraints.rowMap(), 1),
        z(condensed.constraints.rowMap(), 1);
    qp::BoundOps<Scalar, MultiVector>::setRandom(x);
    a.apply(x, y);
    b.apply(x, z);
    const std::vector<double> first = fromVector(y), second = fromVector(z);
    for (std::size_t k = 0; k < first.size(); ++k)
      EXPECT_NEAR(first[k], second[k], 1e-12);
  }
}

} // namespace test_dual_preconditioner
