// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_TestQp.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace test_constraints {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// All entries of B as (row, subdomain, dof) → value, on every rank.
std::map<std::tuple<long long, long long, int>, double> gatherB(const SubdomainSystem& system,
                                                                const Constraints& constraints) {
  struct Item {
    long long row, subdomain;
    int dof;
    double value;
  };
  std::vector<Item> mine;
  for (int i = 0; i < system.size(); ++i)
    for (const Constraints::Entry& entry : constraints.entries(i))
      mine.push_back({static_cast<long long>(constraints.overlapMap()->getGlobalElement(entry.row)),
                      system.subdomain(i).number, entry.dof, entry.value});
  std::map<std::tuple<long long, long long, int>, double> b;
  for (const Item& item : gatherAll(*testComm(), mine))
    b[{item.row, item.subdomain, item.dof}] += item.value;
  return b;
}

Dense gram(const std::map<std::tuple<long long, long long, int>, double>& b, int rows) {
  std::map<std::pair<long long, int>, std::vector<std::pair<long long, double>>> byDof;
  for (const auto& [place, value] : b)
    byDof[{std::get<1>(place), std::get<2>(place)}].emplace_back(std::get<0>(place), value);
  Dense result(rows, rows);
  for (const auto& item : byDof)
    for (const auto& [i, left] : item.second)
      for (const auto& [j, right] : item.second)
        result(static_cast<int>(i), static_cast<int>(j)) += left * right;
  return result;
}

} // namespace

// The paper's count: sN + 1 contact nodes, and m − 1 gluing rows at each dof with m copies.
TEST(Constraints, dimensions_follow_the_papers_count) {
  struct Case {
    int s, n;
    long long dual;
  };
  for (const Case& c : {Case{1, 8, 9}, Case{2, 8, 87}, Case{4, 8, 447}, Case{2, 32, 327}, Case{8, 2, 591}}) {
    const TestModel model = testModel(c.s, c.n);
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows);
    EXPECT_EQ(constraints.dualDimension(), c.dual) << c.s << " " << c.n;
    EXPECT_EQ(constraints.inequalities(), c.s * c.n + 1);
    EXPECT_EQ(static_cast<long long>(constraints.rowMap()->getGlobalNumElements()), c.dual);
    EXPECT_TRUE(constraints.rowMap()->isOneToOne());
  }
}

// BBᵀ = I: gluing rows orthonormal at cross points, contact rows (mean of the copies) orthogonal to them,
// also at contact nodes where subdomains of a body meet. One copy alone in a contact row gives κ(BBᵀ) = 5.8.
TEST(Constraints, rows_are_orthonormal_in_both_forms) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const TestModel model = testModel(3, 2);
    const SubdomainSystem system(testComm(), model.subdomains, form);
    const Constraints constraints(system, model.rows);
    const int m = static_cast<int>(constraints.dualDimension());
    const Dense bbt = gram(gatherB(system, constraints), m);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        EXPECT_NEAR(bbt(i, j), i == j ? 1.0 : 0.0, 1e-14) << i << " " << j;
  }
}

// With weights BD⁻¹Bᵀ = I, D the diagonals of K over the smallest at an interface, which vary from subdomain
// to subdomain by up to 1e6: also at cross points, contact rows and Dirichlet rows. The rows have the same
// kernel, bounds and scales as those without weights: they are combinations of them.
TEST(Constraints, weighted_rows_are_orthonormal_in_the_inner_product_of_the_weights) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    TestModel model = testModel(3, 2);
    for (Subdomain& subdomain : model.subdomains) {
      const auto stiffer = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : stiffer->values)
        value *= std::pow(10.0, static_cast<double>(subdomain.number * 5 % 7));
      subdomain.stiffness = stiffer;
    }
    const SubdomainSystem system(testComm(), model.subdomains, form);
    const Constraints plain(system, model.rows), weighted(system, model.rows, RowWeights::Stiffness);
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < system.size(); ++i)
      for (int local : *system.subdomain(i).interface)
        smallest = std::min(smallest, system.matrix(i).diagonal()[static_cast<std::size_t>(local)]);
    smallest = globalMin(*testComm(), smallest);
    struct Item {
      long long subdomain;
      int dof;
      double weight;
    };
    std::vector<Item> mine;
    for (int i = 0; i < system.size(); ++i)
      for (int local : *system.subdomain(i).interface)
        mine.push_back({system.subdomain(i).number, local,
                        system.matrix(i).diagonal()[static_cast<std::size_t>(local)] / smallest});
    std::map<std::pair<long long, int>, double> weight;
    for (const Item& item : gatherAll(*testComm(), mine))
      weight[{item.subdomain, item.dof}] = item.weight;
    auto b = gatherB(system, weighted);
    ASSERT_EQ(b.size(), gatherB(system, plain).size());
    for (auto& [place, value] : b)
      value /= std::sqrt(weight.at({std::get<1>(place), std::get<2>(place)}));
    const int m = static_cast<int>(weighted.dualDimension());
    const Dense bbt = gram(b, m);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        EXPECT_NEAR(bbt(i, j), i == j ? 1.0 : 0.0, 1e-13) << i << " " << j;
    for (int row = 0; row < static_cast<int>(localSize(*plain.rowMap())); ++row) {
      EXPECT_EQ(weighted.rowType(row), plain.rowType(row));
      EXPECT_NEAR(weighted.bound(row) / weighted.rowScale(row), plain.bound(row) / plain.rowScale(row),
                  1e-15);
    }
    // Zero where copies agree and prescribed values are met: u of a function of the dof number.
    TornVector u = system.zeroVector();
    for (int i = 0; i < system.size(); ++i)
      for (std::size_t k = 0; k < system.subdomain(i).numbers.size(); ++k)
        u[static_cast<std::size_t>(i)][static_cast<std::size_t>((*system.subdomain(i).interface)[k])] =
            std::cos(static_cast<double>(system.subdomain(i).numbers[k]));
    MultiVector y(weighted.rowMap(), 1), z(plain.rowMap(), 1);
    weighted.applyB(u, y);
    plain.applyB(u, z);
    const auto inWeights = y.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto inPlain = z.getLocalViewHost(Tpetra::Access::ReadOnly);
    for (int row = 0; row < static_cast<int>(localSize(*plain.rowMap())); ++row) {
      const auto k = static_cast<std::size_t>(row);
      if (plain.rowType(row) == RowType::Gluing)
        EXPECT_NEAR(inWeights(k, 0) / weighted.rowScale(row), 0.0, 1e-15);
      else
        EXPECT_NEAR(inWeights(k, 0) / weighted.rowScale(row), inPlain(k, 0) / plain.rowScale(row), 1e-14);
    }
  }
}

// Ties that meet, one of them redundant, and a row that leans on dofs they unite: the rows of B are
// independent, and the multipliers of the given rows exert what Bᵀλ does on each dof, whatever λ.
TEST(Constraints, given_multipliers_exert_the_forces_of_united_dofs) {
  for (RowWeights weights : {RowWeights::None, RowWeights::Stiffness}) {
    TestModel model = testModel(3, 2, true);
    for (Subdomain& subdomain : model.subdomains) {
      const auto stiffer = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : stiffer->values)
        value *= std::pow(10.0, static_cast<double>(subdomain.number * 5 % 4));
      subdomain.stiffness = stiffer;
    }
    struct Tie {
      long long number, dofs[2];
    };
    std::vector<Tie> ties;
    for (const ConstraintRow& row : model.rows)
      ties.push_back({row.number, {row.terms[0].dof, row.terms[1].dof}});
    ties = gatherAll(*testComm(), ties);
    std::sort(ties.begin(), ties.end(), [](const Tie& a, const Tie& b) { return a.number < b.number; });
    ASSERT_GE(ties.size(), 4u);
    const auto count = static_cast<long long>(ties.size());
    if (testComm()->getRank() == testComm()->getSize() - 1) {
      const auto add = [&](long long number, std::vector<ConstraintRow::Term> terms, double bound) {
        model.rows.push_back({ConstraintRow::Kind::Equality, number, std::move(terms), bound, 0.0});
      };
      add(count, {{ties[1].dofs[0], 2.0}, {ties[2].dofs[0], -2.0}}, 0.0);
      add(count + 1, {{ties[1].dofs[1], -1.0}, {ties[2].dofs[1], 1.0}}, 0.0); // follows from three others
      add(count + 2, {{ties[1].dofs[0], 1.0}, {ties[2].dofs[1], 0.5}, {ties[3].dofs[0], -2.0}}, 0.1);
    }
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows, weights);
    const Dense bbt = gram(gatherB(system, constraints), static_cast<int>(constraints.dualDimension()));
    EXPECT_GT(eigenvalues(bbt).front(), 1e-5 * eigenvalues(bbt).back()); // weights of up to 1e3

    MultiVector lambda(constraints.rowMap(), 1);
    {
      const auto view = lambda.getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t r = 0; r < view.extent(0); ++r)
        view(r, 0) = std::cos(
            static_cast<double>(constraints.rowMap()->getGlobalElement(static_cast<LocalOrdinal>(r))));
    }
    struct Force {
      long long dof;
      double value;
    };
    std::vector<Force> forces;
    const std::vector<double> overlap = constraints.toOverlap(lambda);
    for (int i = 0; i < system.size(); ++i) {
      const Subdomain& s = system.subdomain(i);
      std::vector<double> t(static_cast<std::size_t>(system.matrix(i).rows()), 0.0);
      constraints.addBt(i, overlap.data(), t.data());
      for (std::size_t k = 0; k < s.numbers.size(); ++k)
        forces.push_back({s.numbers[k], t[static_cast<std::size_t>((*s.interface)[k])]});
    }
    const std::vector<double> multipliers = constraints.givenMultipliers(lambda);
    ASSERT_EQ(multipliers.size(), model.rows.size());
    for (std::size_t r = 0; r < model.rows.size(); ++r)
      for (const ConstraintRow::Term& term : model.rows[r].terms)
        forces.push_back({term.dof, -multipliers[r] * term.coefficient});
    std::map<long long, double> left;
    double largest = 0.0;
    for (const Force& force : gatherAll(*testComm(), forces)) {
      left[force.dof] += force.value;
      largest = std::max(largest, std::abs(force.value));
    }
    for (const auto& [dof, value] : left)
      EXPECT_NEAR(value, 0.0, 1e-12 * largest) << dof;
  }
}

// 0.1 + 0.2 − 0.3 is not zero: scaled to one, what rounding leaves of a dof would be a row of its own.
TEST(Constraints, terms_of_a_dof_that_cancel_are_none) {
  TestModel model = testModel(2, 2);
  const auto cancel = [](ConstraintRow& row) {
    const long long dof = row.terms.front().dof;
    row.terms.front().coefficient = 0.1;
    row.terms.push_back({dof, 0.2});
    row.terms.push_back({dof, -0.3});
  };
  for (ConstraintRow& row : model.rows)
    if (row.number == 0)
      cancel(row);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Dual);
  const Constraints constraints(system, model.rows);
  long long small = 0, entries = 0;
  for (int i = 0; i < system.size(); ++i)
    for (const Constraints::Entry& entry : constraints.entries(i)) {
      small += entry.value != 0.0 && std::abs(entry.value) < 1e-12 ? 1 : 0;
      entries += 1;
    }
  EXPECT_GT(globalSum(*testComm(), entries), 0);
  EXPECT_EQ(globalSum(*testComm(), small), 0);
  // A row of such terms alone is told.
  for (ConstraintRow& row : model.rows)
    if (row.number == 0)
      row.terms = {{row.terms.front().dof, 0.1}, {row.terms.front().dof, 0.2}, {row.terms.front().dof, -0.3}};
  EXPECT_THROW(Constraints(system, model.rows), InputError);
}

// Two bodies that touch where both are tied to a third: a contact row between dofs that are one holds
// already, to rounding, and has no entries; one that they violate is refused.
TEST(Constraints, a_row_between_united_dofs_holds_already) {
  for (double gap : {0.25, 0.0, -0.25}) {
    TestModel model = testModel(2, 2, true);
    struct Tie {
      long long number, dofs[2];
    };
    std::vector<Tie> ties;
    for (const ConstraintRow& row : model.rows)
      ties.push_back({row.number, {row.terms[0].dof, row.terms[1].dof}});
    ties = gatherAll(*testComm(), ties);
    std::sort(ties.begin(), ties.end(), [](const Tie& a, const Tie& b) { return a.number < b.number; });
    if (testComm()->getRank() == 0) {
      // a = b, a third of each against all of it: 1/3 + 2/3 - 1 is a rounding error.
      const double third = 1.0 / 3.0;
      model.rows.push_back({ConstraintRow::Kind::Equality,
                            static_cast<long long>(ties.size()),
                            {{ties[1].dofs[0], 1.0}, {ties[2].dofs[0], -1.0}},
                            0.0,
                            0.0});
      model.rows.push_back(
          {ConstraintRow::Kind::Inequality,
           0,
           {{ties[1].dofs[1], third}, {ties[1].dofs[0], 2.0 * third - 1e-16}, {ties[2].dofs[1], -1.0}},
           gap,
           0.0});
    }
    const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
    if (gap < 0.0) {
      EXPECT_THROW(Constraints(system, model.rows), InputError);
      continue;
    }
    const Constraints constraints(system, model.rows);
    EXPECT_EQ(constraints.inequalities(), 1);
    for (const auto& [place, value] : gatherB(system, constraints))
      EXPECT_NE(std::get<0>(place), 0) << "an entry of the contact row: " << value;
  }
}

// Total FETI: a Dirichlet row for each constrained copy, and no gluing row there.
TEST(Constraints, dirichlet_rows_take_the_place_of_gluing_rows) {
  const int s = 3, n = 2;
  TestModel model = testModel(s, n);
  for (Subdomain& subdomain : model.subdomains)
    for (FixedDof& fixed : subdomain.fixed)
      fixed.value = 0.75;
  const SubdomainSystem primal(testComm(), model.subdomains, DirichletForm::Primal);
  const SubdomainSystem dual(testComm(), model.subdomains, DirichletForm::Dual);
  const Constraints inPrimal(primal, model.rows), inDual(dual, model.rows);
  // On x = 0: s (n + 1) copies of sn + 1 nodes; s − 1 gluing rows vanish there, s (n + 1) Dirichlet rows
  // come.
  EXPECT_EQ(inDual.dualDimension(), inPrimal.dualDimension() - (s - 1) + s * (n + 1));
  long long dirichlet = 0;
  for (int row = 0; row < static_cast<int>(localSize(*inDual.rowMap())); ++row)
    if (inDual.rowType(row) == RowType::Dirichlet) {
      ++dirichlet;
      EXPECT_EQ(inDual.bound(row), 0.75);
      EXPECT_EQ(inDual.rowScale(row), 1.0);
    }
  EXPECT_EQ(globalSum(*testComm(), dirichlet), s * (n + 1));
}

// Bu of a continuous u with u¹ − u² = 1 on the interface: zero at gluing rows, 1 (physical) at contact rows.
TEST(Constraints, physical_values_of_the_rows) {
  const TestModel model = testModel(2, 3);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  TornVector u = system.zeroVector();
  for (int i = 0; i < system.size(); ++i)
    for (std::size_t j = 0; j < system.subdomain(i).numbers.size(); ++j) {
      const long long dof = system.subdomain(i).numbers[j];
      const auto local = static_cast<std::size_t>((*system.subdomain(i).interface)[j]);
      const bool first = dof < 49;
      u[static_cast<std::size_t>(i)][local] = first ? 1.0 + std::sin(static_cast<double>(dof)) : 0.0;
    }
  MultiVector y(constraints.rowMap(), 1);
  constraints.applyB(u, y);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (int row = 0; row < static_cast<int>(view.extent(0)); ++row) {
    const double physical = view(row, 0) / constraints.rowScale(row);
    const GlobalOrdinal number = constraints.rowMap()->getGlobalElement(row);
    if (constraints.rowType(row) == RowType::Inequality) // node k of the side x = 1 has the number 6 + 7k
      EXPECT_NEAR(physical, 1.0 + std::sin(static_cast<double>(6 + 7 * number)), 1e-14);
    else
      EXPECT_NEAR(physical, 0.0, 1e-14);
  }
}

// (Bu)ᵀλ = uᵀ(Bᵀλ): the two products belong to one matrix, across ranks.
TEST(Constraints, transpose_is_the_transpose) {
  const TestModel model = testModel(3, 2);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Dual);
  const Constraints constraints(system, model.rows);
  MultiVector lambda(constraints.rowMap(), 1), y(constraints.rowMap(), 1);
  qp::BoundOps<Scalar, MultiVector>::setRandom(lambda);
  TornVector u = system.zeroVector();
  double right = 0.0;
  const std::vector<double> overlap = constraints.toOverlap(lambda);
  TornVector t = system.zeroVector();
  for (int i = 0; i < system.size(); ++i)
    constraints.addBt(i, overlap.data(), t[static_cast<std::size_t>(i)].data());
  for (int i = 0; i < system.size(); ++i)
    for (std::size_t j = 0; j < u[static_cast<std::size_t>(i)].size(); ++j) {
      u[static_cast<std::size_t>(i)][j] =
          std::cos(static_cast<double>(7 * system.subdomain(i).number) + static_cast<double>(j));
      right += u[static_cast<std::size_t>(i)][j] * t[static_cast<std::size_t>(i)][j];
    }
  constraints.applyB(u, y);
  std::vector<double> left(1);
  y.dot(lambda, Teuchos::arrayViewFromVector(left));
  EXPECT_NEAR(left[0], globalSum(*testComm(), right), 1e-12);
}

// Rows, their numbers and their entries do not depend on the number of ranks: a check sum that weighs each
// entry by its place, computed once on one rank.
TEST(Constraints, rows_do_not_depend_on_the_number_of_ranks) {
  const TestModel model = testModel(3, 2);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  const auto b = gatherB(system, constraints);
  // Gluing row 0 follows the inequalities: the first shared dof, at the bottom of the first cut, dof 2 of the
  // subdomains 0 and 1.
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(b.at({7, 0, 2}), half, 1e-15);
  EXPECT_NEAR(b.at({7, 1, 0}), -half, 1e-15);
  // The cross point of subdomains 0, 1, 3, 4 of the first body: dof 16 of the body.
  std::vector<double> coefficients;
  for (const auto& [place, value] : b)
    if (std::get<1>(place) == 4 && std::get<2>(place) == 0)
      coefficients.push_back(value);
  ASSERT_EQ(coefficients.size(), 1u); // the last copy is in the last of the three rows alone
  EXPECT_NEAR(coefficients[0], -3.0 / std::sqrt(12.0), 1e-15);
}

TEST(Constraints, wrong_rows_are_refused_on_all_ranks) {
  TestModel model = testModel(2, 2);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const auto attempt = [&](std::vector<ConstraintRow> rows) {
    try {
      const Constraints constraints(system, rows);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  auto rows = model.rows;
  for (ConstraintRow& row : rows)
    if (row.number == 0)
      row.terms[0].dof = 6; // inside subdomain 0
  EXPECT_NE(attempt(rows).find("names dof 6, which is not an interface dof"), std::string::npos);
  for (ConstraintRow& row : rows)
    if (row.number == 0)
      row.terms[0].dof = 123456;
  EXPECT_NE(attempt(rows).find("names dof 123456, which no subdomain has"), std::string::npos);
  rows = model.rows;
  for (ConstraintRow& row : rows)
    if (row.number == 0)
      row.number = 77;
  EXPECT_NE(attempt(rows).find("without gaps"), std::string::npos);
  rows = model.rows;
  for (ConstraintRow& row : rows)
    for (ConstraintRow::Term& term : row.terms)
      term.coefficient = 0.0;
  EXPECT_NE(attempt(rows).find("is zero or not finite"), std::string::npos);
}

TEST(Constraints, a_dof_fixed_to_two_values_is_refused) {
  TestModel model = testModel(2, 2);
  for (Subdomain& subdomain : model.subdomains)
    for (FixedDof& fixed : subdomain.fixed)
      fixed.value = subdomain.number == 0 ? 1.0 : 2.0;
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Dual);
  EXPECT_THROW(Constraints(system, model.rows), InputError);
}

// Global numbers with large gaps, as an embedding application may have them.
TEST(Constraints, gaps_in_the_numbering_do_not_matter) {
  TestModel model = testModel(2, 2);
  const auto far = [](long long dof) { return 1000000007LL * dof + 5; };
  for (Subdomain& subdomain : model.subdomains)
    for (long long& dof : subdomain.numbers)
      dof = far(dof);
  for (ConstraintRow& row : model.rows)
    for (ConstraintRow::Term& term : row.terms)
      term.dof = far(term.dof);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  const TestModel plain = testModel(2, 2);
  const SubdomainSystem plainSystem(testComm(), plain.subdomains, DirichletForm::Primal);
  const Constraints plainConstraints(plainSystem, plain.rows);
  EXPECT_EQ(gatherB(system, constraints), gatherB(plainSystem, plainConstraints));
}

// A contact row of prescribed values alone can exert no force. In Total FETI its dofs have rows of their own,
// on which it would depend: it has no entries, and its bound is what is left of the gap.
TEST(Constraints, a_contact_row_of_prescribed_values_alone_depends_on_no_other_row) {
  TestModel model = testModel(2, 2);
  ConstraintRow first{};
  for (const ConstraintRow& row : model.rows)
    if (row.number == 0)
      first = row;
  const long long number = globalMax(*testComm(), first.terms.empty() ? -1LL : first.terms.front().dof),
                  other = globalMax(*testComm(), first.terms.empty() ? -1LL : first.terms.back().dof);
  constexpr double gap = 0.25;
  for (ConstraintRow& row : model.rows)
    if (row.number == 0)
      row.bound = gap;
  for (Subdomain& s : model.subdomains)
    for (std::size_t k = 0; k < s.numbers.size(); ++k)
      if ((s.numbers[k] == number || s.numbers[k] == other) &&
          std::none_of(s.fixed.begin(), s.fixed.end(),
                       [&](const FixedDof& fixed) { return fixed.dof == (*s.interface)[k]; }))
        s.fixed.push_back({(*s.interface)[k], 0.0});
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const SubdomainSystem system(testComm(), model.subdomains, form);
    const Constraints constraints(system, model.rows);
    const auto b = gatherB(system, constraints);
    long long entries = 0;
    for (const auto& item : b)
      entries += std::get<0>(item.first) == 0 ? 1 : 0;
    EXPECT_EQ(entries == 0, form == DirichletForm::Dual);
    const LocalOrdinal owned = constraints.rowMap()->getLocalElement(0);
    if (owned != Teuchos::OrdinalTraits<LocalOrdinal>::invalid())
      EXPECT_NEAR(constraints.bound(owned) / constraints.rowScale(owned), gap, 1e-15);
    // An open one counts, also after other bounds, where it is none of the rows that are set alone.
    std::vector<ConstraintRow> open = model.rows;
    for (ConstraintRow& row : open)
      if (row.number == 0)
        row.status = ConstraintRow::Status::Open;
    Constraints changed(system, open);
    EXPECT_TRUE(changed.hasIntervals());
    for (ConstraintRow& row : open)
      row.bound += row.number == 0 ? 0.0 : 0.125;
    changed.setBounds(open);
    const Constraints fresh(system, open);
    EXPECT_TRUE(fresh.hasIntervals() && changed.hasIntervals());
    for (int r = 0; r < static_cast<int>(localSize(*fresh.rowMap())); ++r)
      EXPECT_TRUE(changed.bound(r) == fresh.bound(r) && changed.rowType(r) == fresh.rowType(r) &&
                  changed.isInterval(r) == fresh.isInterval(r));
    // Rows with entries are orthonormal, as ever.
    const int rows = static_cast<int>(constraints.dualDimension());
    const Dense product = gram(b, rows);
    for (int i = form == DirichletForm::Dual ? 1 : 0; i < rows; ++i)
      EXPECT_NEAR(product(i, i), 1.0, 1e-14) << i;
  }
}

} // namespace test_constraints
