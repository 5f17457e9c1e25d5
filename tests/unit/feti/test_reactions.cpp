// SPDX-License-Identifier: BSD-3-Clause

/// Reactions of an application's own torn problem: in balance with its loads, and the rows' forces those of
/// its contact.

#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace test_reactions {

using namespace Harmos;

// Membranes: every row of K sums to zero, so that Σr = −Σf; contacts act on both sides alike.
TEST(Reactions, balance_the_loads) {
  constexpr double tolerance = 1e-10;
  const TestModel model = testModel(2, 4);
  for (const char* dirichlet : {"primal", "dual"}) {
    Teuchos::ParameterList list;
    list.sublist("Solver").set("Tolerance", tolerance);
    list.sublist("Decomposition").set("Dirichlet", dirichlet);
    feti::FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    ASSERT_TRUE(solver.solve().converged);
    const std::vector<std::vector<double>> reactions = solver.reactions();
    std::vector<double> sums(3, 0.0); // reactions, loads, sizes
    for (std::size_t i = 0; i < model.subdomains.size(); ++i) {
      ASSERT_EQ(reactions[i].size(), model.subdomains[i].fixed.size());
      for (double force : reactions[i])
        sums[0] += force;
      for (double force : *model.subdomains[i].load) {
        sums[1] += force;
        sums[2] += std::abs(force);
      }
    }
    globalSum(*testComm(), sums);
    EXPECT_GT(sums[2], 0.0);
    EXPECT_NEAR(sums[0], -sums[1], 1e3 * tolerance * sums[2]) << dirichlet;

    std::vector<double> byRow(static_cast<std::size_t>(solver.constraints()->inequalities()), 0.0);
    std::vector<double> byState = byRow;
    const std::vector<double> forces = solver.rowForces();
    ASSERT_EQ(forces.size(), model.rows.size());
    for (std::size_t k = 0; k < model.rows.size(); ++k)
      if (model.rows[k].kind == ConstraintRow::Kind::Inequality)
        byRow[static_cast<std::size_t>(model.rows[k].number)] = forces[k];
    const feti::ContactState state = solver.contact();
    for (std::size_t k = 0; k < state.row.size(); ++k)
      byState[static_cast<std::size_t>(state.row[k])] = state.force[k];
    globalSum(*testComm(), byRow);
    globalSum(*testComm(), byState);
    EXPECT_EQ(byRow, byState) << dirichlet;
  }
}

} // namespace test_reactions
