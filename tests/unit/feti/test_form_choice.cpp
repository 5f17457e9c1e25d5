// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_FormChoice.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// A cube of 20³ nodes: more boundary than a square has, for its size.
const FactorizationEstimate cube = {8000, 2402, 2.5e6, 5e9};

double ratio(const FactorizationEstimate& estimate, int members, int products,
             const LocalInverseOptions& options) {
  return predict(DualForm::Condensed, estimate, members, options).seconds(products) /
         predict(DualForm::Implicit, estimate, members, options).seconds(products);
}

} // namespace

// What the model is for: dense blocks pay off with the number of products, and of subdomains that share one.
TEST(FormChoice, condensed_pays_with_products_and_sharing) {
  const LocalInverseOptions options;
  EXPECT_GT(ratio(cube, 1, 1, options), 1.0);
  EXPECT_LT(ratio(cube, 1, 1000, options), 1.0);
  EXPECT_LT(ratio(cube, 64, 1, options), ratio(cube, 1, 1, options));
  EXPECT_LT(ratio(cube, 64, 10, options), 1.0);
}

// Written formulas, by hand: 64 members of a square of 257² nodes.
TEST(FormChoice, formulas) {
  const FactorizationEstimate square = {66049, 1024, 2.4e6, 1e9};
  MachineRates rates;
  rates.sparseFlops = rates.denseFlops = rates.solveFlops = rates.solveBytes = rates.streamBytes =
      rates.setupEntries = rates.orderingEntries = 1.0;
  LocalInverseOptions options;
  const FormPrediction implicit = predict(DualForm::Implicit, square, 64, options, rates);
  EXPECT_DOUBLE_EQ(implicit.setupSeconds, 1e9 + 2 * 2.4e6);
  EXPECT_DOUBLE_EQ(implicit.productSeconds, 2 * 16 * 2.4e6 + 64 * 4 * 2.4e6);
  EXPECT_DOUBLE_EQ(implicit.bytes, 12 * 2.4e6);
  const double b = 1024;
  FormPrediction condensed = predict(DualForm::Condensed, square, 64, options, rates);
  EXPECT_DOUBLE_EQ(condensed.setupSeconds, 1e9 + 2.4e6 + b * b * b);
  EXPECT_DOUBLE_EQ(condensed.productSeconds, 64 * 2 * b * b);
  EXPECT_DOUBLE_EQ(condensed.bytes, 12 * 2.4e6 + 16 * b * b);
  condensed = predict(DualForm::Condensed, square, 1, options, rates); // packed
  EXPECT_DOUBLE_EQ(condensed.productSeconds, 4 * b * b);
  EXPECT_DOUBLE_EQ(condensed.bytes, 12 * 2.4e6 + 12 * b * b);
  options.keepSchur = true;
  EXPECT_DOUBLE_EQ(predict(DualForm::Condensed, square, 1, options, rates).productSeconds, 8 * b * b);
  options.precision = Precision::Single;
  EXPECT_DOUBLE_EQ(predict(DualForm::Condensed, square, 1, options, rates).productSeconds, 4 * b * b);
}

// The same decision on all ranks, within the budget, or an error that says what is needed.
TEST(FormChoice, honours_the_memory_budget) {
  const TestModel model = testModel(2, 16);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  LocalInverseOptions options;
  options.share = false;
  const FormChoice free = chooseForm(system, constraints, options, nullptr, 100, 0.0);
  EXPECT_EQ(free.form, DualForm::Condensed);
  const FormChoice bounded = chooseForm(system, constraints, options, nullptr, 100, 1e6);
  EXPECT_EQ(bounded.form, DualForm::Condensed);
  ASSERT_LT(bounded.implicit.bytes, bounded.condensed.bytes);
  const double between = 0.5 * (bounded.implicit.bytes + bounded.condensed.bytes) / 1048576.0;
  EXPECT_EQ(chooseForm(system, constraints, options, nullptr, 100, between).form, DualForm::Implicit);
  const DualForm wanted = DualForm::Condensed;
  EXPECT_THROW(chooseForm(system, constraints, options, &wanted, 100, between), InputError);
  EXPECT_THROW(chooseForm(system, constraints, options, nullptr, 100, 1e-6), InputError);
}

// Two interior dofs, coupled to each other and to all 50 of the boundary: their columns of L have 52 and 51
// entries. The Schur complement is no part of the factors.
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
  const FactorizationEstimate estimate = analyseFactorization(makeLocalMatrix(b + 2, entries), boundary);
  EXPECT_EQ(estimate.rows, b + 2);
  EXPECT_EQ(estimate.boundary, b);
  // The two columns may be kept in one front, whose upper triangle counts too.
  EXPECT_GE(estimate.entries, 3.0);
  EXPECT_LE(estimate.entries, 4.0);
}
