// SPDX-License-Identifier: BSD-3-Clause

/// A solver that goes on from a state it described makes the very steps of the solver that was left.

#include "Harmos_MemoryArchive.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

namespace test_resume {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

struct Case {
  std::string name;
  const char* method;
  int equalities;
  bool bounds;
  bool preconditioned;
  std::vector<std::pair<const char*, const char*>> choices; ///< "SMALBE/Update rule", value
  EqualityStructure structure = EqualityStructure::General;
};

const std::vector<Case> cases = {
    {"MPRGP", "MPRGP", 0, true, false, {}},
    {"MPRGP with fixed steps", "MPRGP", 0, true, false, {{"MPRGP/Expansion", "fixed step"}}},
    {"MPRGP preconditioned", "MPRGP", 0, true, true, {}},
    {"SMALBE", "SMALBE", 3, true, false, {}},
    {"SMALBE, orthonormal rows", "SMALBE", 3, true, false, {}, EqualityStructure::Orthonormal},
    {"SMALBE by penalty", "SMALBE", 3, true, false, {{"SMALBE/Update rule", "penalty"}}},
    {"SMALBE by both, preconditioned", "SMALBE", 3, true, true, {{"SMALBE/Update rule", "both"}}},
    {"Dual Penalty", "Dual Penalty", 3, true, false, {}},
    {"PCPG", "PCPG", 3, false, false, {}},
    {"PCPG preconditioned, conjugated", "PCPG", 3, false, true, {{"PCPG/Reorthogonalisation", "full"}}},
    {"PDAS", "PDAS", 3, true, false, {}},
    {"PDAS without equalities", "PDAS", 0, true, true, {}},
    {"Auto", "Auto", 3, true, true, {}},
    {"PCPG through PDAS", "PDAS", 3, false, false, {}},
};

struct Outcome {
  Result result;
  std::vector<double> x, mu;
};

Outcome solve(const SmallQp& qp, const Case& item, const Teuchos::RCP<MemoryMonitor<MultiVector>>& monitor,
              const Teuchos::RCP<Teuchos::ParameterList>& list = Teuchos::parameterList()) {
  const DistributedQp distributed(qp, item.structure);
  if (item.preconditioned) {
    distributed.precondition(jacobi(qp.a));
  }
  list->set("Convergence Tolerance", 1e-7);
  for (const auto& [path, value] : item.choices) {
    const std::string text = path;
    const std::size_t slash = text.find('/');
    list->sublist("Expert").sublist(text.substr(0, slash)).set(text.substr(slash + 1), std::string(value));
  }
  const auto solver = TpetraSolverFactory().create(item.method, list);
  solver->setProblem(distributed.problem);
  solver->setMonitor(monitor);
  Outcome run;
  run.result = solver->solve();
  run.x = fromVector(*distributed.solution);
  if (qp.c.rows > 0)
    run.mu = fromVector(*distributed.multiplier);
  return run;
}

// Bit for bit, apart from the time and from what is set up anew.
void expectSame(const Outcome& run, const Outcome& plain, const std::string& name) {
  EXPECT_EQ(run.result.reason, plain.result.reason) << name << ": " << run.result.explanation;
  ASSERT_EQ(run.result.history.size(), plain.result.history.size()) << name;
  for (std::size_t k = 0; k < plain.result.history.size(); ++k) {
    std::vector<double> mine = toNumbers({run.result.history[k]}),
                        theirs = toNumbers({plain.result.history[k]});
    mine[9] = theirs[9] = 0.0; // seconds
    for (std::size_t j = 0; j < mine.size(); ++j)
      EXPECT_TRUE(mine[j] == theirs[j] || (std::isnan(mine[j]) && std::isnan(theirs[j])))
          << name << ", row " << k << ", column " << j << ": " << mine[j] << " against " << theirs[j];
  }
  EXPECT_EQ(run.x, plain.x) << name;
  EXPECT_EQ(run.mu, plain.mu) << name;
  Counters mine = run.result.counters, theirs = plain.result.counters;
  mine.preconditionerSetups = theirs.preconditionerSetups = 0;
  EXPECT_EQ(toNumbers(mine), toNumbers(theirs)) << name;
}

// Goes on from every state that the solver described, or from so many of them.
void resumeEverywhere(const SmallQp& qp, const Case& item, const Teuchos::ParameterList& list = {},
                      std::size_t most = 100000) {
  const auto copy = [&] { return Teuchos::rcp(new Teuchos::ParameterList(list)); };
  const Outcome plain = solve(qp, item, Teuchos::null, copy());
  ASSERT_TRUE(plain.result.converged()) << item.name << ": " << plain.result.explanation;
  const auto watched = Teuchos::rcp(new MemoryMonitor<MultiVector>);
  expectSame(solve(qp, item, watched, copy()), plain, item.name + ", watched");
  // Every step was announced, and every row.
  EXPECT_EQ(watched->rows.size(), plain.result.history.size()) << item.name;
  EXPECT_GT(watched->saved.size(), 2u) << item.name;
  // On one rank from each, or from so many; more of them take longer and share the code.
  const std::size_t stride = 1 + watched->saved.size() / (testComm()->getSize() == 1 ? most : 4);
  for (std::size_t k = 0; k < watched->saved.size(); k += stride) {
    const auto monitor = Teuchos::rcp(new MemoryMonitor<MultiVector>);
    monitor->resumed = &watched->saved[k];
    expectSame(solve(qp, item, monitor, copy()), plain, item.name + ", from " + std::to_string(k));
    if (::testing::Test::HasFailure())
      return;
  }
}

} // namespace

TEST(Resume, every_step_can_be_gone_on_from) {
  std::mt19937 random(21);
  const int trials = testComm()->getSize() == 1 ? 3 : 1;
  for (int trial = 0; trial < trials; ++trial)
    for (const Case& item : cases) {
      SmallQp qp = randomQp(random, 24, item.equalities, item.bounds, 1e3);
      if (item.structure != EqualityStructure::General)
        orthonormalizeRows(qp);
      resumeEverywhere(qp, item);
    }
}

// Points on rims stay where they are, to the last bit.
TEST(Resume, with_discs_too) {
  std::mt19937 random(24);
  for (const Case& item : cases)
    if (item.bounds && std::string(item.method) != "Dual Penalty") { // which takes thousands of steps
      SmallQp qp = randomFrictionQp(random, 12, item.equalities, 10.0);
      if (item.structure != EqualityStructure::General)
        orthonormalizeRows(qp);
      resumeEverywhere(qp, item);
    }
}

// The state of a solver that took over holds what the one before it had done.
TEST(Resume, a_solver_that_took_over_goes_on) {
  std::mt19937 random(22);
  for (const Case& item : {cases[10], cases[11]}) {
    const SmallQp qp = randomQp(random, 24, item.equalities, true, 1e3);
    Teuchos::ParameterList list;
    list.sublist("Expert").sublist("PDAS").set("Maximum active sets", 2);
    resumeEverywhere(qp, item, list);
  }
}

// Sets that descend know the point they must be below, and directions are kept from faces that are left.
TEST(Resume, sets_that_descend_go_on_descending) {
  std::mt19937 random(27);
  int begun = 0;
  for (int trial = 0; trial < 3; ++trial)
    for (const Case& item : {cases[11], cases[12]}) {
      const SmallQp qp = randomQp(random, 40, item.equalities, true, 1e5);
      Teuchos::ParameterList list;
      list.sublist("Expert").sublist("PDAS").set("Active sets without progress", 1);
      const Outcome plain = solve(qp, item, Teuchos::null, Teuchos::rcp(new Teuchos::ParameterList(list)));
      begun += plain.result.counters.descents;
      resumeEverywhere(qp, item, list);
    }
  EXPECT_GE(begun, 3);
}

// Limits that follow are as they were, whether they go along within faces or stand still between solutions.
TEST(Resume, with_limits_that_follow) {
  std::mt19937 random(28);
  for (int tangents : {1, 2})
    for (const Case& item : cases)
      if (item.bounds && std::string(item.method) != "Dual Penalty") {
        SmallQp qp = followingQp(random, 4, tangents, 2, item.equalities > 0 ? 2 : 0, 0.5);
        if (item.structure != EqualityStructure::General)
          orthonormalizeRows(qp);
        resumeEverywhere(qp, item, {}, 12); // programs with limits that stand still take hundreds of steps
      }
}

namespace {

// Of the states that a solver described, those in which all sets are balanced, and the stiffest springs.
struct Balanced {
  int states = 0;
  double stiffest = 0.0;
};

Balanced balancedOf(const MemoryMonitor<MultiVector>& monitor) {
  Balanced result;
  for (const MemoryState<MultiVector>& state : monitor.saved) {
    const auto balances = state.numbers.find("pdas balances");
    if (balances == state.numbers.end() || balances->second.front() == 0.0)
      continue;
    ++result.states;
    result.stiffest = std::max(result.stiffest, state.numbers.at("pdas stiffening").front());
  }
  return result;
}

} // namespace

// What sets are balanced from, the best iterate with its gradient and its set, and how stiff springs are.
TEST(Resume, while_sets_are_balanced) {
  std::mt19937 random(29);
  const Case item = {"PDAS, balanced", "PDAS", 3, true, true, {}};
  Teuchos::ParameterList list;
  list.sublist("Expert").sublist("PDAS").set("Active sets without progress", 1);
  const std::vector<std::pair<std::string, std::function<SmallQp()>>> kinds = {
      {"bodies that turn", [&] { return turningBodiesQp(random, 4, 6, 0.2); }},
      {"intervals that follow", [&] { return followingQp(random, 8, 1, 2, 3, 0.5); }},
      {"discs that follow", [&] { return followingQp(random, 6, 2, 2, 3, 0.5); }},
      {"discs", [&] { return randomFrictionQp(random, 24, 3, 1e3); }}};
  for (const auto& [kind, make] : kinds) {
    Balanced all;
    for (int trial = 0; trial < 4; ++trial) {
      const SmallQp qp = make();
      const auto watched = Teuchos::rcp(new MemoryMonitor<MultiVector>);
      solve(qp, item, watched, Teuchos::rcp(new Teuchos::ParameterList(list)));
      const Balanced found = balancedOf(*watched);
      all.states += found.states;
      all.stiffest = std::max(all.stiffest, found.stiffest);
      if (found.states > 0)
        resumeEverywhere(qp, item, list, 12);
    }
    if (testComm()->getRank() == 0)
      std::cout << kind << ": " << all.states << " states while sets are balanced, springs up to "
                << all.stiffest << " times as stiff\n";
    // Which states these are is left to the solver; that there are some is not.
    EXPECT_GT(all.states, 0) << kind;
  }
}

TEST(Resume, a_solver_stops_when_it_is_asked_to) {
  std::mt19937 random(23);
  for (const Case& item : cases) {
    SmallQp qp = randomQp(random, 24, item.equalities, item.bounds, 1e3);
    if (item.structure != EqualityStructure::General)
      orthonormalizeRows(qp);
    const auto monitor = Teuchos::rcp(new MemoryMonitor<MultiVector>);
    monitor->stopAfter = 2;
    const Outcome run = solve(qp, item, monitor);
    EXPECT_EQ(run.result.reason, Reason::Interrupted) << item.name;
    EXPECT_FALSE(run.result.converged()) << item.name;
    EXPECT_EQ(monitor->saved.size(), 3u) << item.name;
  }
}

// A limit is of this run; what was kept at it is gone on from with another one.
TEST(Resume, a_limit_leaves_a_state) {
  std::mt19937 random(24);
  for (const Case& item : cases) {
    SmallQp qp = randomQp(random, 24, item.equalities, item.bounds, 1e3);
    if (item.structure != EqualityStructure::General)
      orthonormalizeRows(qp);
    const Outcome plain = solve(qp, item, Teuchos::null);
    const auto limited = Teuchos::rcp(new MemoryMonitor<MultiVector>);
    const auto list = Teuchos::parameterList();
    list->set("Maximum Iterations", 3);
    const Outcome run = solve(qp, item, limited, list);
    EXPECT_EQ(run.result.reason, Reason::IterationLimit) << item.name;
    ASSERT_FALSE(limited->saved.empty()) << item.name;
    const auto monitor = Teuchos::rcp(new MemoryMonitor<MultiVector>);
    monitor->resumed = &limited->saved.back();
    expectSame(solve(qp, item, monitor), plain, item.name);
  }
}

} // namespace test_resume
