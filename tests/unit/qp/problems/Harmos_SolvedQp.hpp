// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestQp.hpp"

#include <string>
#include <vector>

namespace Harmos {

struct SolvedQp {
  qp::Result result;
  std::vector<double> x, mu;
};

/// A small problem by one of the solvers of the factory. @note Collective.
inline SolvedQp solvedBy(const std::string& name, const SmallQp& problem, double tolerance,
                         const std::vector<double>& start = {}) {
  const DistributedQp distributed(problem);
  if (!start.empty())
    distributed.solution->assign(*toVector(start, distributed.map));
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", 100000);
  const auto solver = qp::TpetraSolverFactory().create(name, list);
  solver->setProblem(distributed.problem);
  SolvedQp solved{solver->solve(), {}, {}};
  solved.x = fromVector(*distributed.solution);
  if (problem.c.rows > 0)
    solved.mu = fromVector(*distributed.multiplier);
  return solved;
}

/// Every solver that admits a structure.
inline std::vector<std::string> solversFor(const SmallQp& problem) {
  if (problem.lower.empty() && problem.upper.empty())
    return {"Auto", "PCPG", "PDAS", "SMALBE"};
  return problem.c.rows > 0 ? std::vector<std::string>{"Auto", "PDAS", "SMALBE"}
                            : std::vector<std::string>{"Auto", "PDAS", "MPRGP"};
}

} // namespace Harmos
