// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverManager.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// Makes solvers by name, letters' case ignored; mirrors Belos::SolverFactory.
///
/// Guarded by tests/unit/qp/test_life_cycle.cpp.
template<class Scalar, class MV, class OP>
class SolverFactory {
 public:
  using Solver = SolverManager<Scalar, MV, OP>;
  using Maker = std::function<Teuchos::RCP<Solver>()>;

  /// Knows Harmos' own solvers.
  SolverFactory();

  /// Adds an application's solver.
  /// @throws InputError if the name is taken, letters' case ignored.
  void addSolver(const std::string& name, Maker maker);

  /// @throws InputError for an unknown name (the nearest is offered) or bad parameters.
  Teuchos::RCP<Solver> create(const std::string& name,
                              const Teuchos::RCP<Teuchos::ParameterList>& parameters) const;

  std::vector<std::string> supportedSolverNames() const;
  bool isSupported(const std::string& name) const { return find(name) != nullptr; }

 private:
  const Maker* find(const std::string& name) const;

  std::vector<std::pair<std::string, Maker>> makers_;
};

} // namespace Harmos::qp
