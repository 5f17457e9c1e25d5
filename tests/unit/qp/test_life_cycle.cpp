// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace Harmos;
using namespace Harmos::qp;

namespace {

SmallQp smallQp(int equalities, bool bounds) {
  std::mt19937 random(3);
  return randomQp(random, 4, equalities, bounds);
}

template<class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST(LifeCycle, a_setter_takes_the_mark_away) {
  const DistributedQp qp(smallQp(0, true));
  EXPECT_TRUE(qp.problem->isProblemSet());
  qp.problem->setLowerBound(Teuchos::null);
  EXPECT_FALSE(qp.problem->isProblemSet());
  const auto solver = TpetraSolverFactory().create("MPRGP", Teuchos::null);
  EXPECT_TRUE(contains(message([&] { solver->setProblem(qp.problem); }), "after setLowerBound()"));
  EXPECT_TRUE(qp.problem->setProblem());
  EXPECT_NO_THROW(solver->setProblem(qp.problem));
  qp.problem->setRhs(qp.problem->rhs());
  EXPECT_TRUE(contains(message([&] { solver->solve(); }), "was changed after setProblem()"));
}

TEST(LifeCycle, solve_without_a_problem) {
  const auto solver = TpetraSolverFactory().create("SMALBE", Teuchos::null);
  EXPECT_TRUE(contains(message([&] { solver->solve(); }), "without a problem"));
}

TEST(LifeCycle, problems_that_cannot_be_set_say_why) {
  const DistributedQp qp(smallQp(1, true));
  qp.problem->setLowerBound(toVector({0, 0, 0, 0}, qp.map));
  qp.problem->setUpperBound(toVector({1, 1, -1, 1}, qp.map));
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "lies above"));
  qp.problem->setUpperBound(Teuchos::rcp(new MultiVector(Teuchos::rcp(new Map(5, 0, testComm())), 1)));
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "differ in length"));
  qp.problem->setUpperBound(Teuchos::null);
  qp.problem->setRhs(Teuchos::null);
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "missing"));
}

TEST(LifeCycle, solvers_refuse_structures_they_are_not_for) {
  const auto solve = [](const std::string& name, const SmallQp& qp) {
    return message([&] {
      const DistributedQp distributed(qp);
      const auto solver = TpetraSolverFactory().create(name, Teuchos::null);
      solver->setProblem(distributed.problem);
      solver->solve();
    });
  };
  EXPECT_TRUE(contains(solve("MPRGP", smallQp(1, true)), "use SMALBE"));
  EXPECT_TRUE(contains(solve("SMALBE", smallQp(0, true)), "use MPRGP"));
  EXPECT_TRUE(contains(solve("Dual Penalty", smallQp(0, true)), "use MPRGP"));
  EXPECT_TRUE(contains(solve("PCPG", smallQp(0, true)), "use SMALBE or MPRGP"));
  EXPECT_TRUE(contains(solve("PCPG", smallQp(1, false)), "orthonormal"));
}

TEST(LifeCycle, factory_ignores_case_and_offers_the_nearest_name) {
  const TpetraSolverFactory factory;
  EXPECT_EQ(factory.create("smalbe", Teuchos::null)->name(), "SMALBE");
  EXPECT_EQ(factory.create("DUAL PENALTY", Teuchos::null)->name(), "Dual Penalty");
  EXPECT_TRUE(factory.isSupported("pcpg"));
  EXPECT_FALSE(factory.isSupported("GMRES"));
  EXPECT_TRUE(contains(message([&] { factory.create("MPRG", Teuchos::null); }), "did you mean \"MPRGP\"?"));
}

TEST(LifeCycle, automatic_choice_follows_the_structure) {
  const auto choice = [](const SmallQp& qp) {
    return TpetraSolverFactory::automaticChoice(*DistributedQp(qp).problem);
  };
  EXPECT_EQ(choice(smallQp(0, true)), "MPRGP");
  EXPECT_EQ(choice(smallQp(1, true)), "SMALBE");
  EXPECT_EQ(choice(smallQp(1, false)), "PCPG");
  EXPECT_EQ(choice(smallQp(0, false)), "PCPG");
}

TEST(LifeCycle, parameters_are_checked_at_the_first_call) {
  const auto list = Teuchos::parameterList();
  list->sublist("MPRGP").set("Gama", 1.0);
  EXPECT_TRUE(
      contains(message([&] { TpetraSolverFactory().create("MPRGP", list); }), "did you mean \"Gamma\"?"));
  const auto solver = TpetraSolverFactory().create("SMALBE", Teuchos::null);
  EXPECT_EQ(solver->getCurrentParameters()->sublist("MPRGP").get<double>("Gamma"), 1.0);
  EXPECT_TRUE(solver->getValidParameters()->isSublist("SMALBE"));
}

TEST(LifeCycle, clone_has_the_parameters_but_no_problem) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", 1e-3);
  const auto copy = TpetraSolverFactory().create("SMALBE", list)->clone();
  EXPECT_EQ(copy->name(), "SMALBE");
  EXPECT_EQ(copy->getCurrentParameters()->get<double>("Convergence Tolerance"), 1e-3);
  EXPECT_THROW(copy->solve(), InputError);
}

// Why it stopped is told, never only that it stopped.
TEST(LifeCycle, iteration_limit_is_a_reason_with_a_sentence) {
  const DistributedQp qp(smallQp(1, true));
  const auto list = Teuchos::parameterList();
  list->set("Maximum Iterations", 1);
  list->set("Convergence Tolerance", 1e-14);
  const auto solver = TpetraSolverFactory().create("SMALBE", list);
  solver->setProblem(qp.problem);
  const Result result = solver->solve();
  EXPECT_EQ(result.reason, Reason::IterationLimit);
  EXPECT_FALSE(result.converged());
  EXPECT_TRUE(contains(result.explanation, "limit of 1 inner iterations"));
}

// A tolerance below the rounding errors ends in "stagnation", neither in "converged" nor in an endless loop.
TEST(LifeCycle, unreachable_tolerance_is_stagnation) {
  for (const char* name : {"MPRGP", "PCPG"}) {
    const DistributedQp qp(smallQp(0, std::string(name) == "MPRGP"));
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-30);
    const auto solver = TpetraSolverFactory().create(name, list);
    solver->setProblem(qp.problem);
    const Result result = solver->solve();
    EXPECT_TRUE(result.reason == Reason::Stagnation || result.projectedGradientNorm == 0.0)
        << name << ": " << toString(result.reason);
  }
}

// min −x over x ≥ 0 with A = 0 has no solution.
TEST(LifeCycle, unbounded_problem_is_named) {
  for (const char* name : {"MPRGP", "PCPG"}) {
    SmallQp qp = smallQp(0, std::string(name) == "MPRGP");
    qp.a = Dense(4, 4);
    qp.b = {1, 1, 1, 1};
    if (!qp.lower.empty()) {
      qp.lower = {0, 0, 0, 0};
      qp.upper.clear();
    }
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create(name, Teuchos::null);
    solver->setProblem(distributed.problem);
    EXPECT_EQ(solver->solve().reason, Reason::Unbounded) << name;
  }
}

TEST(LifeCycle, indefinite_and_non_finite_hessians_break_down) {
  SmallQp indefinite = smallQp(0, false);
  indefinite.a = Dense(4, 4);
  for (int i = 0; i < 4; ++i)
    indefinite.a(i, i) = -1.0;
  SmallQp broken = smallQp(0, true);
  broken.a(1, 1) = std::nan("");
  for (const SmallQp& qp : {indefinite, broken}) {
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create(qp.lower.empty() ? "PCPG" : "MPRGP", Teuchos::null);
    solver->setProblem(distributed.problem);
    EXPECT_EQ(solver->solve().reason, Reason::Breakdown);
  }
}
