// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace test_life_cycle {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

SmallQp smallQp(int equalities, bool bounds) {
  std::mt19937 random(3);
  return randomQp(random, 4, equalities, bounds);
}

} // namespace

TEST(LifeCycle, a_setter_takes_the_mark_away) {
  const DistributedQp qp(smallQp(0, true));
  EXPECT_TRUE(qp.problem->isProblemSet());
  qp.problem->setLowerBound(Teuchos::null);
  EXPECT_FALSE(qp.problem->isProblemSet());
  const auto solver = TpetraSolverFactory().create("MPRGP", Teuchos::null);
  EXPECT_TRUE(contains(inputErrorOf([&] { solver->setProblem(qp.problem); }), "after setLowerBound()"));
  EXPECT_TRUE(qp.problem->setProblem());
  EXPECT_NO_THROW(solver->setProblem(qp.problem));
  qp.problem->setRhs(qp.problem->rhs());
  EXPECT_TRUE(contains(inputErrorOf([&] { solver->solve(); }), "was changed after setProblem()"));
}

TEST(LifeCycle, solve_without_a_problem) {
  const auto solver = TpetraSolverFactory().create("SMALBE", Teuchos::null);
  EXPECT_TRUE(contains(inputErrorOf([&] { solver->solve(); }), "without a problem"));
}

TEST(LifeCycle, problems_that_cannot_be_set_say_why) {
  const DistributedQp qp(smallQp(1, true));
  qp.problem->setLowerBound(toVector({0, 0, 0, 0}, qp.map));
  qp.problem->setUpperBound(toVector({1, 1, std::nan(""), 1}, qp.map));
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "entry 2 are not numbers"));
  qp.problem->setUpperBound(Teuchos::rcp(new MultiVector(Teuchos::rcp(new Map(5, 0, testComm())), 1)));
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "differ in length"));
  qp.problem->setUpperBound(Teuchos::null);
  qp.problem->setUnprojectedHessian(qp.problem->hessian());
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "EqualityStructure::OrthonormalInvariant"));
  qp.problem->setUnprojectedHessian(Teuchos::null);
  qp.problem->setRhs(Teuchos::null);
  EXPECT_FALSE(qp.problem->setProblem());
  EXPECT_TRUE(contains(qp.problem->whyNotSet(), "missing"));
}

TEST(LifeCycle, solvers_refuse_structures_they_are_not_for) {
  const auto solve = [](const std::string& name, const SmallQp& qp) {
    return inputErrorOf([&] {
      const DistributedQp distributed(qp);
      const auto solver = TpetraSolverFactory().create(name, Teuchos::null);
      solver->setProblem(distributed.problem);
      solver->solve();
    });
  };
  EXPECT_TRUE(contains(solve("MPRGP", smallQp(1, true)), "use SMALBE"));
  EXPECT_TRUE(contains(solve("PCPG", smallQp(0, true)), "use SMALBE or MPRGP"));
}

// What a method has beyond a simpler one is of no use without equalities, or without bounds: the simpler one
// does the work, to the last bit, and a note says so.
TEST(LifeCycle, methods_become_simpler_with_the_problem) {
  const struct {
    std::string method, simpler;
    SmallQp qp;
  } cases[] = {{"SMALBE", "MPRGP", smallQp(0, true)},
               {"Dual Penalty", "MPRGP", smallQp(0, true)},
               {"PDAS", "PCPG", smallQp(1, false)},
               {"PDAS", "PCPG", smallQp(0, false)}};
  for (const auto& [method, simpler, qp] : cases) {
    std::ostringstream text;
    const DistributedQp first(qp), second(qp);
    const auto solve = [&](const std::string& name, const DistributedQp& distributed) {
      const auto list = Teuchos::parameterList();
      list->set("Convergence Tolerance", 1e-10);
      const auto solver = TpetraSolverFactory().create(name, list);
      solver->setLog(Log(text, text, Log::Verbosity::Normal, true));
      solver->setProblem(distributed.problem);
      return solver->solve();
    };
    const Result result = solve(method, first);
    EXPECT_TRUE(result.converged()) << method;
    EXPECT_EQ(result.method, simpler);
    EXPECT_TRUE(contains(text.str(), method + " is " + simpler)) << text.str();
    const Result expected = solve(simpler, second);
    EXPECT_EQ(result.counters.hessianApplications, expected.counters.hessianApplications) << method;
    EXPECT_EQ(result.counters.safeguards, 0) << method;
    EXPECT_EQ(fromVector(*first.solution), fromVector(*second.solution)) << method;
  }
}

// Rows that are too many to be made orthonormal are a structure PCPG and PDAS cannot use.
TEST(LifeCycle, too_many_general_rows_are_refused_by_name) {
  for (const char* name : {"PCPG", "PDAS"}) {
    const DistributedQp qp(smallQp(2, std::string(name) == "PDAS"));
    const auto list = Teuchos::parameterList();
    list->sublist("Expert").set("Orthonormalised Rows", 1);
    const auto solver = TpetraSolverFactory().create(name, list);
    solver->setProblem(qp.problem);
    EXPECT_TRUE(contains(inputErrorOf([&] { solver->solve(); }), "\"Orthonormalised Rows\"")) << name;
  }
}

TEST(LifeCycle, factory_ignores_case_and_offers_the_nearest_name) {
  const TpetraSolverFactory factory;
  EXPECT_EQ(factory.create("smalbe", Teuchos::null)->name(), "SMALBE");
  EXPECT_EQ(factory.create("DUAL PENALTY", Teuchos::null)->name(), "Dual Penalty");
  EXPECT_TRUE(factory.isSupported("pcpg"));
  EXPECT_FALSE(factory.isSupported("GMRES"));
  EXPECT_TRUE(
      contains(inputErrorOf([&] { factory.create("MPRG", Teuchos::null); }), "did you mean \"MPRGP\"?"));
}

TEST(LifeCycle, auto_follows_the_structure) {
  const auto method = [](const SmallQp& qp, bool preconditioned = false) {
    const DistributedQp distributed(qp);
    if (preconditioned) {
      distributed.precondition(jacobi(qp.a));
    }
    const auto solver = TpetraSolverFactory().create("auto", Teuchos::null);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    EXPECT_TRUE(result.converged());
    return result.method;
  };
  EXPECT_EQ(method(smallQp(0, true)), "MPRGP");
  EXPECT_EQ(method(smallQp(0, true), true), "PDAS");
  EXPECT_EQ(method(smallQp(1, true)), "SMALBE");
  EXPECT_EQ(method(smallQp(1, false)), "PCPG");
  EXPECT_EQ(method(smallQp(0, false)), "PCPG");
}

namespace {

// Sets x to a number; an application's own idea of a solver.
class Guess : public TpetraSolverManager {
 public:
  std::string name() const override { return "Guess"; }
  Teuchos::RCP<TpetraSolverManager> clone() const override { return Teuchos::rcp(new Guess); }
  const ParameterSpec& parameterSpec() const override {
    static const ParameterSpec spec = [] {
      ParameterSpec result("Guess", "A guess.");
      addCommonParameters(result);
      return result;
    }();
    return spec;
  }

 protected:
  void doSolve() override {
    problem_->solution()->putScalar(7.0);
    stop(Reason::Converged, "as good as any");
  }
};

} // namespace

TEST(LifeCycle, applications_add_solvers) {
  TpetraSolverFactory factory;
  factory.addSolver("Guess", [] { return Teuchos::rcp(new Guess); });
  const DistributedQp qp(smallQp(0, true));
  const auto solver = factory.create("GUESS", Teuchos::null);
  solver->setProblem(qp.problem);
  EXPECT_EQ(solver->solve().method, "Guess");
  EXPECT_EQ(fromVector(*qp.solution)[0], 7.0);
  EXPECT_TRUE(
      contains(inputErrorOf([&] { factory.addSolver("mprgp", [] { return Teuchos::rcp(new Guess); }); }),
               "exists already"));
  EXPECT_FALSE(TpetraSolverFactory().isSupported("Guess"));
}

TEST(LifeCycle, parameters_are_checked_at_the_first_call) {
  const auto list = Teuchos::parameterList();
  list->sublist("Expert").sublist("MPRGP").set("Gama", 1.0);
  EXPECT_TRUE(contains(inputErrorOf([&] { TpetraSolverFactory().create("MPRGP", list); }),
                       "did you mean \"Gamma\"?"));
  const auto solver = TpetraSolverFactory().create("SMALBE", Teuchos::null);
  EXPECT_EQ(solver->getCurrentParameters()->sublist("Expert").sublist("MPRGP").get<double>("Gamma"), 1.0);
  EXPECT_TRUE(solver->getValidParameters()->sublist("Expert").isSublist("SMALBE"));
}

TEST(LifeCycle, expert_parameters_at_their_old_place) {
  const auto list = Teuchos::parameterList();
  list->sublist("MPRGP").set("Gamma", 2.0);
  const auto solver = TpetraSolverFactory().create("SMALBE", list);
  EXPECT_EQ(solver->getCurrentParameters()->sublist("Expert").sublist("MPRGP").get<double>("Gamma"), 2.0);
  std::ostringstream text;
  solver->setLog(Log(text, text, Log::Verbosity::Normal, true));
  solver->setParameters(list);
  EXPECT_TRUE(contains(text.str(), "Note: \"MPRGP\" is now \"Expert/MPRGP\"")) << text.str();
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

TEST(LifeCycle, time_limit_is_a_reason) {
  const DistributedQp qp(smallQp(1, true));
  const auto list = Teuchos::parameterList();
  list->set("Maximum Seconds", 1e-9);
  const auto solver = TpetraSolverFactory().create("SMALBE", list);
  solver->setProblem(qp.problem);
  const Result result = solver->solve();
  EXPECT_EQ(result.reason, Reason::TimeLimit);
  EXPECT_TRUE(contains(result.explanation, "seconds was reached"));
}

// The reason is the test's; the debug test sees every iterate and decides nothing.
TEST(LifeCycle, users_tests_stop_the_solver_for_their_reason) {
  class Third : public StatusTest<MultiVector> {
   public:
    Status checkStatus(const IterationState<MultiVector>& state) override {
      most = std::max(most, state.inner);
      return state.inner >= 3 ? Status::Passed : Status::Failed;
    }
    Status getStatus() const override { return most >= 3 ? Status::Passed : Status::Failed; }
    void reset() override {}
    void print(std::ostream&, int) const override {}
    Reason reason() const override { return Reason::Breakdown; }
    int most = 0;
  };
  const DistributedQp qp(smallQp(1, true));
  const auto solver = TpetraSolverFactory().create("SMALBE", Teuchos::null);
  const auto test = Teuchos::rcp(new Third);
  solver->setDebugStatusTest(test);
  solver->setProblem(qp.problem);
  EXPECT_TRUE(solver->solve().converged());
  EXPECT_GT(test->most, 3);
  qp.solution->putScalar(0.0);
  qp.multiplier->putScalar(0.0);
  solver->setConvergenceTest(test);
  const Result result = solver->solve();
  EXPECT_EQ(result.reason, Reason::Breakdown);
  EXPECT_EQ(result.history.back().inner, 3);
  EXPECT_TRUE(contains(result.explanation, "status test"));
}

// A known kernel direction on which the load acts, and nothing that stops it.
TEST(LifeCycle, null_space_tells_an_unbounded_problem_before_the_first_step) {
  SmallQp qp = smallQp(0, true);
  qp.a = Dense(4, 4);
  for (int i = 0; i < 3; ++i)
    qp.a(i, i) = 2.0;
  qp.b = {1, 1, 1, 0.5};
  qp.lower = {0, 0, 0, -10};
  qp.upper.clear();
  const auto solve = [&](const std::vector<double>& kernel) {
    const DistributedQp distributed(qp);
    distributed.problem->setNullSpace(toVector(kernel, distributed.map));
    EXPECT_TRUE(distributed.problem->setProblem());
    const auto solver = TpetraSolverFactory().create("MPRGP", Teuchos::null);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    if (result.reason == Reason::Unbounded)
      EXPECT_EQ(fromVector(*solver->certificate()), (std::vector<double>{0, 0, 0, 1}));
    return result;
  };
  const Result unbounded = solve({0, 0, 0, 3});
  EXPECT_EQ(unbounded.reason, Reason::Unbounded);
  EXPECT_EQ(unbounded.counters.hessianApplications, 0);
  EXPECT_NEAR(unbounded.certificate.gap, 0.5, 1e-15);
  EXPECT_TRUE(contains(inputErrorOf([&] { solve({0, 1, 0, 0}); }), "the given null space is invalid"));
  // A bound in the way, or no load: the kernel is harmless.
  qp.b[3] = -0.5;
  EXPECT_TRUE(solve({0, 0, 0, 3}).converged());
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
    // A gradient that vanishes to the last bit is as good as asked for.
    EXPECT_EQ(result.reason, result.projectedGradientNorm == 0.0 ? Reason::Converged : Reason::Stagnation)
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

} // namespace test_life_cycle
