// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_FormChoice.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

namespace test_form_choice {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

constexpr auto none = PreconditionerKind::None, lumped = PreconditionerKind::Lumped,
               dirichlet = PreconditionerKind::Dirichlet;
constexpr auto implicit = DualForm::Implicit, condensed = DualForm::Condensed;

// A cube of 20³ nodes: more boundary than a square has, for its size.
const FactorizationEstimate cube = {8000, 2402, 2.5e6, 5e9, 1.5e6, 3e9, 1e10, 4e4, 2e4};

double ratio(const FactorizationEstimate& estimate, int members, int products) {
  return predict({condensed, dirichlet}, estimate, members, Precision::Double).seconds(products) /
         predict({implicit, dirichlet}, estimate, members, Precision::Double).seconds(products);
}

FormPrediction prediction(double setup, double product, double mebibytes) {
  FormPrediction result;
  result.setupSeconds = setup;
  result.productSeconds = product;
  result.bytes = mebibytes * 1048576.0;
  return result;
}

} // namespace

// What the model is for: dense blocks pay off with the number of products, and of subdomains that share one.
TEST(FormChoice, condensed_pays_with_products_and_sharing) {
  EXPECT_GT(ratio(cube, 1, 1), 1.0);
  EXPECT_LT(ratio(cube, 1, 1000), 1.0);
  EXPECT_LT(ratio(cube, 64, 1), ratio(cube, 1, 1));
  EXPECT_LT(ratio(cube, 64, 10), 1.0);
}

// Written formulas, by hand: 64 members of a square of 257² nodes.
TEST(FormChoice, formulas) {
  const FactorizationEstimate square = {66049, 1024, 2.4e6, 1e9, 2e6, 8e8, 1.5e9, 3e3, 7e3};
  MachineRates rates;
  rates.sparseFlops = rates.schurFlops = rates.denseFlops = rates.solveBytes = rates.sparseBytes =
      rates.streamBytes = rates.setupEntries = rates.setupRows = 1.0;
  const auto of = [&](DualForm form, PreconditionerKind kind, int members = 64,
                      Precision precision = Precision::Double) {
    return predict({form, kind}, square, members, precision, rates);
  };
  EXPECT_DOUBLE_EQ(of(implicit, none).setupSeconds, 1e9 + 66049 + 2.4e6);
  EXPECT_DOUBLE_EQ(of(implicit, none).productSeconds, 64 * 16 * 2.4e6);
  EXPECT_DOUBLE_EQ(of(implicit, none).bytes, 8 * 2.4e6);
  EXPECT_DOUBLE_EQ(of(implicit, none, 64, Precision::Single).productSeconds, 64 * 16 * 2.4e6); // refined
  EXPECT_DOUBLE_EQ(of(implicit, lumped).setupSeconds, 1e9 + 66049 + 2.4e6);
  EXPECT_DOUBLE_EQ(of(implicit, lumped).productSeconds, 64 * (16 * 2.4e6 + 12 * 3e3));
  EXPECT_DOUBLE_EQ(of(implicit, lumped).relativeProducts, 2.75); // 64.5 rows for each of the boundary
  EXPECT_DOUBLE_EQ(of(implicit, dirichlet).setupSeconds, 1e9 + 66049 + 2.4e6 + 8e8 + 65025 + 2e6);
  EXPECT_DOUBLE_EQ(of(implicit, dirichlet).productSeconds,
                   64 * (16 * 2.4e6 + 16 * 2e6 + 12 * (3e3 + 2 * 7e3)));
  EXPECT_DOUBLE_EQ(of(implicit, dirichlet).relativeProducts, 1.0);
  const double b = 1024;
  EXPECT_DOUBLE_EQ(of(condensed, none).setupSeconds, 1.5e9 + 65025 + 2e6 + b * b * b);
  EXPECT_DOUBLE_EQ(of(condensed, none).productSeconds, 64 * 2 * b * b);
  EXPECT_DOUBLE_EQ(of(condensed, none).bytes, 8 * 2e6 + 12 * 7e3 + 8 * b * b);
  EXPECT_DOUBLE_EQ(of(condensed, none, 1).productSeconds, 4 * b * b); // packed
  EXPECT_DOUBLE_EQ(of(condensed, dirichlet, 1).productSeconds, 8 * b * b);
  EXPECT_DOUBLE_EQ(of(condensed, dirichlet, 1, Precision::Single).productSeconds, 4 * b * b);
}

// The fastest that is allowed and fits; near-ties go to the first one, budgets are kept, and what the machine
// has not got is taken for what needs least.
TEST(FormChoice, decides) {
  const std::vector<FormPrediction> p = {prediction(1.0, 0.1, 100.0), prediction(0.5, 0.115, 10.0),
                                         prediction(0.5, 0.2, 20.0),  prediction(0.9, 0.3, 50.0),
                                         prediction(0.9, 0.1, 90.0),  prediction(0.4, 0.2, 8.0)};
  ASSERT_EQ(p.size(), dualForms().size());
  FormLimits limits;
  limits.products = 30; // 4.0, 3.95, 6.5, …
  EXPECT_EQ(bestOf(p, limits), 0U);
  limits.products = 10; // 2.0, 1.65
  EXPECT_EQ(bestOf(p, limits), 1U);
  limits.mayLump = false;
  EXPECT_EQ(bestOf(p, limits), 0U);
  limits.preconditioner = lumped;
  limits.form = condensed;
  EXPECT_EQ(bestOf(p, limits), 3U);
  // What was chosen before is kept, where it may be and fits.
  limits = {};
  limits.before = dualFormsFrom("implicit Dirichlet");
  EXPECT_EQ(bestOf(p, limits), 2U);
  limits.budgetMiB = limits.memoryMiB = 15.0;
  EXPECT_EQ(bestOf(p, limits), 1U);
  limits.budgetMiB = limits.memoryMiB = 0.0;
  limits.form = condensed;
  EXPECT_EQ(bestOf(p, limits), 0U);
  EXPECT_FALSE(dualFormsFrom("lumped implicit"));
  limits = {};
  limits.memoryMiB = 30.0;
  EXPECT_EQ(bestOf(p, limits), 1U);
  limits.memoryMiB = 5.0;
  EXPECT_EQ(bestOf(p, limits), 1U);
  limits.budgetMiB = 5.0;
  EXPECT_EQ(bestOf(p, limits), std::nullopt);
}

// The same decision on all ranks and in every run, within the budget, or an error that says what is needed.
TEST(FormChoice, honours_the_memory_budget) {
  const TestModel model = testModel(2, 16);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  LocalInverseOptions options;
  options.share = false;
  const auto choose = [&](double budgetMiB, std::optional<DualForm> form = std::nullopt) {
    FactorizationContext context;
    FormLimits limits;
    limits.budgetMiB = budgetMiB;
    limits.form = form;
    return chooseForm(system, constraints, options, limits, context);
  };
  const FormChoice bounded = choose(1e6);
  EXPECT_EQ(choose(0.0).forms.form, condensed);
  EXPECT_EQ(bounded.forms.form, condensed);
  EXPECT_EQ(bounded.forms.preconditioner, dirichlet);
  EXPECT_EQ(choose(1e6).reason, bounded.reason);
  const double most = bounded.of({condensed, dirichlet}).bytes, least = bounded.of({implicit, lumped}).bytes;
  ASSERT_LT(least, bounded.of({condensed, lumped}).bytes);
  const double between = 0.5 * (least + std::min(most, bounded.of({condensed, lumped}).bytes)) / 1048576.0;
  EXPECT_EQ(choose(between).forms.form, implicit);
  EXPECT_THROW(choose(between, condensed), InputError);
  EXPECT_THROW(choose(1e-6), InputError);
}

// Two interior dofs, coupled to each other and to all 50 of the boundary. The Schur complement, and what
// couples them to it, is no part of the factor.
TEST(FormChoice, analysis_counts_the_factors_without_the_dense_block) {
  constexpr int b = 50;
  std::vector<MatrixEntry> entries;
  for (int i = 0; i < b + 2; ++i)
    entries.push_back({i, i, 100.0});
  for (int hub : {b, b + 1})
    for (int i = 0; i < hub; ++i) {
      entries.push_back({i, hub, -1.0});
      entries.push_back({hub, i, -1.0});
    }
  std::vector<int> boundary;
  for (int i = 0; i < b; ++i)
    boundary.push_back(i);
  FactorizationContext context;
  const FactorizationEstimate estimate =
      analyseFactorization(makeLocalMatrix(b + 2, entries), boundary, context);
  EXPECT_EQ(estimate.rows, b + 2);
  EXPECT_EQ(estimate.boundary, b);
  // The two columns may be kept in one front, whose upper triangle counts too.
  EXPECT_GE(estimate.interiorEntries, 3.0);
  EXPECT_LE(estimate.interiorEntries, 4.0);
  EXPECT_EQ(estimate.blockEntries, b);
  EXPECT_EQ(estimate.couplingEntries, 2 * b);
  EXPECT_GE(estimate.entries, 3.0 + 3 * b); // of K: the diagonal, and each with both hubs
}

} // namespace test_form_choice
