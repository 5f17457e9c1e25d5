// SPDX-License-Identifier: BSD-3-Clause

/// Rows whose force is limited: the same wherever they are given, answers that an audit bears out and faults
/// that it finds, limits that change, and input that is refused.

#include "Harmos_DistributedCoarse.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_ReplicatedCoarse.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_limited_rows {

using namespace Harmos;

namespace {

constexpr double tolerance = 1e-9;
// Between what the most and the least loaded of the nine rows need.
constexpr double small = 0.05;

// The model's two membranes, glued with a limited force; with discs of two rows that a rank gives.
TestModel limited(double limit, bool hasDiscs) {
  TestModel model = testModel(2, 4, true);
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    model.rows[k].kind = ConstraintRow::Kind::Limited;
    model.rows[k].limit = limit;
    const std::size_t first = k - k % 2;
    if (hasDiscs && first + 1 < model.rows.size())
      model.rows[k].disc = model.rows[first].number;
  }
  return model;
}

Teuchos::ParameterList parameters() {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance);
  return list;
}

feti::AuditLimits limits() {
  return {feti::auditShare(tolerance)};
}

// The model's two membranes, which press on each other, with a second component that friction holds: rows
// of it are so many times as long, their coefficients as many times as small.
TestModel rubbing(double coefficient, double length) {
  TestModel model = testModel(2, 4);
  TestModel across = testModel(2, 4);
  const long long subdomains = globalSum(*testComm(), static_cast<long long>(model.subdomains.size()));
  constexpr long long second = 1000000; // numbers of its dofs begin here
  for (feti::Subdomain& subdomain : across.subdomains) {
    subdomain.number += static_cast<int>(subdomains);
    for (long long& dof : subdomain.numbers)
      dof += second;
    changeLoad(subdomain, [](std::vector<double>& load) {
      for (double& value : load)
        value *= 0.2;
    });
    model.subdomains.push_back(subdomain);
  }
  for (ConstraintRow row : across.rows) {
    row.kind = ConstraintRow::Kind::Limited;
    row.normal = row.number;
    row.bound = 0.0;
    row.coefficient = coefficient / length;
    for (ConstraintRow::Term& term : row.terms) {
      term.dof += second;
      term.coefficient *= length;
    }
    model.rows.push_back(row);
  }
  return model;
}

// Multipliers of limited rows, each times a factor.
feti::TornSolution tampered(const feti::FetiSolver& solver, double factor) {
  feti::TornSolution solution = solver.solution();
  const auto multiplier = Teuchos::rcp(new MultiVector(*solution.multiplier, Teuchos::Copy));
  {
    const auto view = multiplier->getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      if (solver.constraints()->rowType(static_cast<int>(r)) == feti::RowType::Limited)
        view(r, 0) *= factor;
  }
  solution.multiplier = multiplier;
  return solution;
}

} // namespace

// A sign that is wrong anywhere, and a bound, show in the audit.
TEST(LimitedRows, audit_finds_faults) {
  for (bool hasDiscs : {false, true}) {
    const TestModel model = limited(small, hasDiscs);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parameters());
    const feti::SolveReport& report = solver.solve();
    ASSERT_TRUE(report.converged) << report.reason;
    EXPECT_TRUE(feti::auditAgrees(solver.audit(), limits()));
    EXPECT_GT(solver.audit().frictionWork, 0.0);
    EXPECT_NEAR(solver.audit().largestLimit, small, 1e-15);
    EXPECT_LE(solver.audit().limitExcess, 1e-12);
    // Some stick and some slip, or the test says little.
    const feti::FrictionState state = solver.friction();
    long long slips = 0;
    for (double slip : state.slip)
      slips += std::abs(slip) > 1e-6 ? 1 : 0;
    slips = globalSum(*testComm(), slips);
    EXPECT_GT(slips, 0);
    EXPECT_LT(slips, solver.constraints()->limited());

    const feti::KktAudit turned = feti::audit(solver.system(), *solver.constraints(), tampered(solver, -1.0));
    EXPECT_FALSE(feti::auditAgrees(turned, limits()));
    EXPECT_LT(turned.frictionWork, 0.0);
    EXPECT_GT(turned.slipError, 1e-3 * turned.largestDisplacement);
    const feti::KktAudit strong = feti::audit(solver.system(), *solver.constraints(), tampered(solver, 1.01));
    EXPECT_FALSE(feti::auditAgrees(strong, limits()));
    EXPECT_NEAR(strong.limitExcess, 0.01 * small, 1e-10);
    // Less than the limit, and slips all the same.
    const feti::KktAudit weak = feti::audit(solver.system(), *solver.constraints(), tampered(solver, 0.99));
    EXPECT_FALSE(feti::auditAgrees(weak, limits()));
    EXPECT_GT(weak.slipError, 1e-3 * weak.largestDisplacement);
  }
}

// Limits and slips of before are data as bounds are: no factorisation, and the answer of a solver made for
// them.
TEST(LimitedRows, limits_change) {
  TestModel model = limited(small, true);
  feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parameters());
  ASSERT_TRUE(solver.solve().converged);
  const long long factors = static_cast<long long>(solver.factorizations().factorizations);
  for (ConstraintRow& row : model.rows) {
    row.limit = 1.5 * small;
    row.bound = 1e-3;
  }
  solver.setBounds(model.rows);
  ASSERT_TRUE(solver.solve().converged);
  EXPECT_EQ(static_cast<long long>(solver.factorizations().factorizations), factors);
  feti::FetiSolver fresh(testComm(), model.subdomains, model.rows, parameters());
  ASSERT_TRUE(fresh.solve().converged);
  EXPECT_NEAR(solver.audit().energy, fresh.audit().energy, 1e-9 * std::abs(fresh.audit().energy));
}

// A coefficient is one of forces of the rows as they are given, however long these are.
TEST(LimitedRows, coefficients_are_of_given_rows) {
  constexpr double coefficient = 0.3;
  double energy = 0.0;
  for (double length : {1.0, 3.0, 0.1}) {
    const TestModel model = rubbing(coefficient, length);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, parameters());
    const feti::SolveReport& report = solver.solve();
    ASSERT_TRUE(report.converged) << report.reason;
    EXPECT_TRUE(feti::auditAgrees(solver.audit(), limits()));
    // Some stick and some slip, or the coefficient would not matter.
    const feti::FrictionState state = solver.friction();
    long long slips = 0;
    for (double slip : state.slip)
      slips += std::abs(slip) > 1e-6 * length ? 1 : 0;
    slips = globalSum(*testComm(), slips);
    EXPECT_GT(slips, 0);
    EXPECT_LT(slips, solver.constraints()->limited());
    energy = length == 1.0 ? solver.audit().energy : energy;
    EXPECT_NEAR(solver.audit().energy, energy, 1e-8 * std::abs(energy)) << length;
  }
}

// Both rows of a disc are on one rank and have one scale; physical limits are those that were given.
TEST(LimitedRows, discs_stay_discs) {
  const TestModel model = limited(small, true);
  for (feti::RowWeights weights : {feti::RowWeights::None, feti::RowWeights::Stiffness}) {
    const feti::SubdomainSystem system(testComm(), model.subdomains, feti::DirichletForm::Primal);
    const feti::Constraints constraints(system, model.rows, weights);
    EXPECT_TRUE(constraints.hasDiscs());
    const long long discs = globalSum(*testComm(), static_cast<long long>(model.rows.size() / 2));
    EXPECT_EQ(globalSum(*testComm(), static_cast<long long>(constraints.discs().size())), discs);
    EXPECT_EQ(constraints.hasIntervals(), constraints.limited() > 2 * discs);
    for (const auto& [first, second] : constraints.discs()) {
      EXPECT_EQ(constraints.rowScale(first), constraints.rowScale(second));
      EXPECT_NEAR(constraints.limit(first) * constraints.rowScale(first), small, 1e-15);
    }
  }
}

// G_FG_Fᵀ with tangents, weighted or not, against the sum of its terms.
TEST(LimitedRows, tangents_in_the_coarse_problem) {
  const TestModel model = limited(small, true);
  const feti::SubdomainSystem system(testComm(), model.subdomains, feti::DirichletForm::Dual);
  const feti::Constraints constraints(system, model.rows);
  const feti::ReplicatedCoarse coarse(system, constraints);
  MultiVector mask(constraints.rowMap(), 1);
  mask.putScalar(1.0);
  std::vector<qp::Slip> slips;
  const auto n = static_cast<std::size_t>(coarse.kernelDimension());
  for (std::size_t k = 0; k < constraints.discs().size(); k += 2) {
    const auto [first, second] = constraints.discs()[k];
    const double angle = 1.0 + static_cast<double>(k);
    slips.push_back({first, second, {0, 0}, 1.0, {std::cos(angle), std::sin(angle)}, 0.5 * angle});
    const auto view = mask.getLocalViewHost(Tpetra::Access::ReadWrite);
    view(static_cast<std::size_t>(first), 0) = view(static_cast<std::size_t>(second), 0) = 0.0;
  }
  for (double q : {0.0, 2.0}) {
    // Σ of rows of G̃ᵀ, in full.
    std::vector<double> gram(n * n, 0.0);
    const auto add = [&](const std::vector<double>& row) {
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          gram[i * n + j] += row[i] * row[j];
    };
    const auto rowOf = [&](int row, double factor, std::vector<double>& sum) {
      const auto r = static_cast<std::size_t>(row);
      for (std::size_t k = coarse.rows().offsets()[r]; k < coarse.rows().offsets()[r + 1]; ++k)
        sum[static_cast<std::size_t>(coarse.rows().columns()[k])] += factor * coarse.rows().values()[k];
    };
    {
      const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
      for (std::size_t r = 0; r < view.extent(0); ++r)
        if (view(r, 0) != 0.0) {
          std::vector<double> row(n, 0.0);
          rowOf(static_cast<int>(r), 1.0, row);
          add(row);
        }
    }
    for (const qp::Slip& slip : slips) {
      const double weight = q > 0.0 ? std::sqrt(q / (q + slip.curvature)) : 1.0;
      std::vector<double> row(n, 0.0);
      rowOf(slip.first, -slip.normal[1] * weight, row);
      rowOf(slip.second, slip.normal[0] * weight, row);
      add(row);
    }
    globalSum(*testComm(), gram);
    // y of G_FG_Fᵀy = r, and L⁻¹(G̃_FG̃_Fᵀ)L⁻ᵀy again.
    std::vector<double> r(static_cast<std::size_t>(coarse.dimension()));
    for (std::size_t k = 0; k < r.size(); ++k)
      r[k] = std::sin(1.0 + static_cast<double>(k));
    const std::vector<double> y = coarse.solveOnFace(coarse.faceFactor(mask, slips, q), r);
    const std::vector<double> x = coarse.solveLt(y);
    std::vector<double> image(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        image[i] += gram[i * n + j] * x[j];
    const std::vector<double> back = coarse.solveL(image);
    for (std::size_t k = 0; k < r.size(); ++k)
      EXPECT_NEAR(back[k], r[k], 1e-9) << q;
    // The same in shares: Gᵀy of Gᵀr.
    MultiVector inDualSpace(constraints.rowMap(), 1), expected(constraints.rowMap(), 1);
    coarse.addGt(1.0, r, inDualSpace);
    coarse.addGt(1.0, y, expected);
    const feti::DistributedCoarse shared(system, constraints, {});
    shared.faceGram()->buildWithSlips(mask, slips, q)->solve(inDualSpace);
    inDualSpace.update(-1.0, expected, 1.0);
    std::vector<double> distance(1);
    inDualSpace.normInf(Teuchos::arrayViewFromVector(distance));
    EXPECT_LT(distance[0], 1e-9) << q;
  }
}

TEST(LimitedRows, what_makes_no_sense_is_refused) {
  const auto messageOf = [](const std::function<void(std::vector<ConstraintRow>&)>& spoil) {
    TestModel model = limited(small, true);
    spoil(model.rows);
    return inputErrorOf([&] { feti::FetiSolver(testComm(), model.subdomains, model.rows, parameters()); });
  };
  const auto spoilFirst = [](auto&& change) {
    return [change](std::vector<ConstraintRow>& rows) {
      for (ConstraintRow& row : rows)
        if (row.number == 0)
          change(row);
    };
  };
  EXPECT_NE(messageOf([](std::vector<ConstraintRow>& rows) {
              for (ConstraintRow& row : rows)
                row.limit = -1.0;
            }).find("has a limit of -1"),
            std::string::npos);
  EXPECT_NE(
      messageOf(spoilFirst([](ConstraintRow& row) { row.limit = 1.0; })).find("two rows with the same limit"),
      std::string::npos);
  EXPECT_NE(
      messageOf(spoilFirst([](ConstraintRow& row) { row.disc = 1000; })).find("two rows with the same limit"),
      std::string::npos);
}

} // namespace test_limited_rows
